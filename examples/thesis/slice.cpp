#include "slice.hpp"

#include "csrbf/io/volume.hpp"
#include "k_space.hpp"
#include "signals.hpp"

#include <algorithm>
#include <filesystem>
#include <numeric>

namespace csrbf::thesis {

const std::string brain_file = "/usr/share/mricron/templates/ch2.nii.gz";

Points<2> Slice::pixels() const {
  Points<2> points(2, width * height);
  for (Index i = 0; i < points.cols(); ++i)
    points.col(i) << static_cast<double>(i % width), static_cast<double>(i / width);
  return points;
}

std::optional<Slice> brain_slice() {
  if (!std::filesystem::exists(brain_file)) return std::nullopt;
  const Volume<float> volume = read_volume<float>(brain_file);
  const Grid& grid = volume.grid;
  Slice slice{.width = grid.size[1], .height = grid.size[2] - 1};
  slice.values.resize(slice.width * slice.height);
  // Rows from the top of the head down.
  for (Index row = 0; row < slice.height; ++row)
    for (Index column = 0; column < slice.width; ++column)
      slice.values[column + slice.width * row] =
          static_cast<double>(volume.frame()(0, grid.index(grid.size[0] / 2, column, grid.size[2] - 1 - row)));
  return slice;
}

Slice drawn_slice(Index width, Index height) {
  Slice slice{.width = width, .height = height};
  slice.values.resize(width * height);
  const double edge = 3 / static_cast<double>(std::min(width, height));
  for (Index i = 0; i < slice.values.size(); ++i) {
    const double x = 2 * static_cast<double>(i % width) / static_cast<double>(width - 1) - 1;
    const double y = 1 - 2 * static_cast<double>(i / width) / static_cast<double>(height - 1);
    slice.values[i] = 0;
    for (const Ellipse& e : head_phantom(1))
      slice.values[i] += 100 * e.value / (1 + std::exp((e.level({x, y}) - 1) * std::min(e.a, e.b) / edge));
  }
  return slice;
}

SampledSlice sample_slice(const Slice& slice, double share, unsigned seed) {
  std::vector<Index> order(slice.values.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::shuffle(order.begin(), order.end(), std::mt19937_64(seed));
  order.resize(std::llround(share * static_cast<double>(order.size())));
  std::sort(order.begin(), order.end());
  return {slice, order, {slice.pixels()(Eigen::all, order), slice.values(order), {}}};
}

SliceErrors slice_errors(const SampledSlice& sampled, const Eigen::VectorXd& reconstructed) {
  return {relative_error(reconstructed, sampled.slice.values),
          relative_error(reconstructed(sampled.ids), sampled.samples.values.col(0))};
}

Figure without_brain(Figure figure) {
  figure.missing = brain_file + " is not there: install the package mricron-data.";
  return figure;
}

}  // namespace csrbf::thesis
