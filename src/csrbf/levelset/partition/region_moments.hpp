#pragma once

#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// Sums over the voxels of a region, each times its weight: all that a polynomial of degree 2 in space has to know of
/// them. Coordinates run from -1 to 1 along each axis.
struct RegionMoments {
  double powers[5][5][5] = {};  ///< of x^a y^b z^c, a + b + c <= 4
  double values[3][3][3] = {};  ///< of the value times x^a y^b z^c, a + b + c <= 2
  double squares = 0;           ///< of the values
  double voxels = 0;

  [[nodiscard]] double count() const { return voxels; }
  [[nodiscard]] double mean() const { return powers[0][0][0] > 0 ? values[0][0][0] / powers[0][0][0] : 0; }
  /// Adds `times` the sums of other voxels.
  void add(const RegionMoments& other, double times = 1);
};

/// The moments of the voxels with that label. `weights` may be empty: all 1. O(voxels), the same bits for any number of
/// threads.
RegionMoments region_moments(std::span<const float> values, std::span<const std::uint8_t> labels, std::uint8_t label,
                             const Grid& grid, std::span<const float> weights = {});

/// A polynomial in space fitted to the values of a region by least squares.
class MeanPolynomial {
 public:
  MeanPolynomial(const RegionMoments& region, int degree, const Grid& grid);

  [[nodiscard]] Index parameters() const { return std::ssize(c_); }
  /// The sum of the squares that it leaves of the values of a region.
  [[nodiscard]] double residual(const RegionMoments& region) const;
  /// Its values at the voxels of a row along x, counted over y, then z.
  void fill_row(Index row, std::span<float> to) const;

 private:
  Grid grid_;
  std::vector<std::array<int, 3>> exponents_;
  std::vector<double> c_;
};

}  // namespace csrbf
