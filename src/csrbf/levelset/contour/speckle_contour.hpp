#pragma once

#include "csrbf/levelset/lattice/lattice.hpp"
#include "csrbf/levelset/regions/speckle_model.hpp"

#include <vector>

namespace csrbf {

/// Center spacing in voxels of the shortest edge: the contour averages the grains between two centres.
template <int Dim>
double spacing_in_speckle(const SpeckleModel& model, const Grid& grid);

/// Coefficients of a smooth level set that is positive where the label is not 0.
template <int Dim>
std::vector<float> coefficients_of_labels(const Lattice<Dim>& lattice, std::span<const std::uint8_t> labels);

/// Energy of a contour in speckle that is seen through the point spread of the device:
///
///     E(alpha) = sum (log P + p / P) / grain + 1/2 sum ((alpha - start) / (slope drift))^2
///     P = P_0 + (P_1 - P_0) G * H_eps(f)
///
/// p: the power that each voxel shows, P: its mean there, G: the square of the point spread. At the contour P is half
/// way between the regions, where the greys, of logarithms say, are close to those of the brighter one: with laws of
/// whole regions the contour moves into the darker one. grain: voxels that share an independent amplitude. The second
/// sum lets the contour drift from where it starts by about two grains, and holds it where there is no evidence.
template <int Dim>
class SpeckleContour {
 public:
  /// `start`: coefficients of a level set whose contour is near, f > 0 in region 1, lattice.array_size() of them;
  /// `mask` and `prior` as in SegmentOptions. They, the lattice and the start must outlive this.
  SpeckleContour(const Lattice<Dim>& lattice, const SpeckleModel& model, std::span<const float> values,
                 std::span<const std::uint8_t> mask, std::span<const float> prior, const std::vector<float>& start);

  /// E and, unless null, its derivatives; arrays of lattice.array_size().
  double energy(const float* coefficients, float* derivatives);

  /// Lowers E; appends it at the start and after each step to `energies`. Returns the coefficients.
  std::vector<float> descend(std::vector<double>& energies);

 private:
  [[nodiscard]] double prior_energy() const;
  double power_energy();

  const Lattice<Dim>& lattice_;
  SpeckleModel model_;
  std::span<const std::uint8_t> mask_;
  std::span<const float> prior_;
  const std::vector<float>& start_;
  std::vector<float> powers_, share_;
  std::array<double, 3> blur_{0, 0, 0};
  double grain_ = 1, eps_ = 1, stiffness_ = 1, prior_scale_ = 1;
};

}  // namespace csrbf
