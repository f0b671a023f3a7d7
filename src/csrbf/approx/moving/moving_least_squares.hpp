#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"

#include <memory>
#include <string>
#include <vector>

namespace csrbf {

struct MovingLeastSquaresOptions {
  std::string kernel = "wendland-c4";  ///< the weight function, compactly supported
  int degree = 1;                      ///< of the local polynomials; 0 is Shepard's method
  double support = 1.5;                ///< radius of a sample's weight, in distances to its `neighbors`-th neighbour
  Index neighbors = 0;                 ///< 0: twice the number of monomials, at least 2 Dim; with tracks 24
  bool tracks = false;                 ///< whether the weights follow the tracks of the samples; of degree 1
};

/// Moving least squares (Lancaster and Salkauskas 1981; thesis eqs. 1.6-1.9): f(p) is the value at p of the polynomial
/// that minimises sum_i w_i phi(|p - p_i| / h_i) (g(p_i) - s_i)^2. Every sample has its own radius h_i, so that f is
/// smooth where the sampling density varies. Reproduces polynomials of the degree. Gradients and Hessians are those of
/// f, not of the local polynomials.
///
/// With tracks the weights are w_i phi(|d| / h_i) (|d|_i^2 / h_i^2 + eps^2)^(-5/2), d = p - p_i, where the metric |.|_i
/// stretches distances across the track of the sample (track_directions()) by five. f then nearly interpolates, as the
/// weights are nearly infinite at the samples, and between two neighbours on a track it is nearly linear, whatever the
/// other tracks. Slopes v are penalised by 1e-4 h_i^2 |v|^2 per weight: the samples next to a point are often on a
/// line.
///
/// Where the samples around p do not determine a polynomial of the degree a lower one is used; where there is no sample
/// at all, the value of the nearest one, with derivatives 0: f is not continuous there, but defined everywhere. Costs a
/// dense solve per point: O(k Q^2), k samples around the point, Q monomials.
///
/// One field per component; they share the samples. Duplicates are merged; samples of weight 0 are ignored.
/// Throws InvalidInput for samples that are not valid, degree < 0 or > 5 (with tracks other than 1), support <= 0,
/// negative neighbors and kernels without compact support, or without the two derivatives that a Hessian needs.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> moving_least_squares(const Samples<Dim>& samples,
                                                                    const MovingLeastSquaresOptions& options = {});

}  // namespace csrbf
