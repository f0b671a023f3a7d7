#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "figure.hpp"

#include <complex>
#include <string>
#include <vector>

namespace csrbf::thesis {

/// An ellipse of constant value.
struct Ellipse {
  double value;
  double a, b;   ///< semi-axes
  double x, y;   ///< centre
  double angle;  ///< of the axis a, rad

  /// |p| in the frame of the ellipse: 1 on its border.
  [[nodiscard]] double level(const Point<2>& p) const;

  /// Its Fourier transform, integral of f(p) exp(-2 pi i k.p).
  [[nodiscard]] std::complex<double> transform(const Point<2>& k) const;
};

/// A drawing of a head (after Shepp and Logan 1974, with more contrast) in the ellipse with semi-axes .69 and .92,
/// times `scale`.
std::vector<Ellipse> head_phantom(double scale);

enum class Trajectory { radial, spiral };

/// Places (2 x n) where k-space is sampled, in units of the grid, within the disk of radius side / 2: 1.6 side spokes,
/// or side / 2 interleaved Archimedean spirals.
Points<2> trajectory(Trajectory kind, Index side);

/// The image of side x side pixels of [-1, 1)^2 from its transform on the grid of multiples of 1/2: the inverse
/// discrete Fourier transform (as two matrix products; the origin of both grids is at index side / 2).
Eigen::MatrixXcd image_of(const Eigen::MatrixXcd& k_space);

/// The phantom from samples of its transform along a trajectory.
struct KSpaceResult {
  Index samples = 0;
  double fit_seconds = 0;
  double fit_error = 0;      ///< |image - reference| / |reference|; reference: exact transform on the grid, in the disk
  double nearest_error = 0;  ///< each place of the grid takes the nearest sample
  double gridding_error = 0;  ///< each sample goes to the nearest place of the grid, means; empty places are 0
  Eigen::MatrixXd reference = {}, fit = {}, nearest = {};  ///< images
};

KSpaceResult reconstruct_k_space(Trajectory kind, Index side);

/// Irregular k-space, an open perspective of the thesis.
Figure k_space();

}  // namespace csrbf::thesis
