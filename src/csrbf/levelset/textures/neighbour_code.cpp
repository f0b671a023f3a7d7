#include "csrbf/levelset/textures/neighbour_code.hpp"

#include "csrbf/core/parallel.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr Index rows_per_task = 64;

// Of the products of a region's voxels with their neighbours, before and behind.
struct Sums {
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Eigen::Vector3d with_value = Eigen::Vector3d::Zero();
  double squares = 0;

  void add(const Sums& other, double weight) {
    products += weight * other.products;
    with_value += weight * other.with_value;
    squares += weight * other.squares;
  }
  [[nodiscard]] Eigen::Vector3d coefficients() const {
    constexpr double ridge = 1e-9;  // axes of one voxel have no neighbours
    const double shift = ridge * products.trace() + std::numeric_limits<double>::min();
    return (products + shift * Eigen::Matrix3d::Identity()).ldlt().solve(with_value);
  }
  [[nodiscard]] double left_by(const Eigen::Vector3d& c) const {
    return std::max(0.0, squares - 2 * c.dot(with_value) + c.dot(products * c));
  }
};

}  // namespace

template <class Body>
void NeighbourCode::for_voxels(Index begin_row, Index end_row, const Body& body) const {
  const auto [nx, ny, nz] = grid_.size;
  for (Index row = begin_row; row < end_row; ++row)
    for (Index x = 0; x < nx; ++x)
      if (inside(row * nx + x)) body(std::array<Index, 3>{x, row % ny, row / ny}, row * nx + x);
}

NeighbourCode::Place NeighbourCode::place(const std::array<Index, 3>& at, Index voxel, double mean) const {
  Place result;
  result.value = static_cast<double>(values_[voxel]) - mean;
  Index stride = 1;
  for (int a = 0; a < grid_.dimension(); ++a) {
    if (at[a] > 0 && inside(voxel - stride)) result.before[a] = static_cast<double>(values_[voxel - stride]) - mean;
    if (at[a] + 1 < grid_.size[a] && inside(voxel + stride))
      result.behind[a] = static_cast<double>(values_[voxel + stride]) - mean;
    stride *= grid_.size[a];
  }
  return result;
}

// Of what the prediction leaves, the mean of both codes.
double NeighbourCode::square(const Region& region, const std::array<Index, 3>& at, Index voxel) const {
  const Place here = place(at, voxel, region.mean);
  const double before = here.value - region.coefficients.dot(here.before);
  const double behind = here.value - region.coefficients.dot(here.behind);
  return 0.5 * (before * before + behind * behind);
}

double NeighbourCode::fit(std::span<const std::uint8_t> labels, bool own_predictions) {
  regions_.assign(labels.empty() ? 1 : 2, {});
  const auto region_of = [&](Index i) { return labels.empty() || labels[i] == 0 ? 0U : 1U; };
  const Index rows = grid_.size[1] * grid_.size[2];
  for_voxels(0, rows, [&](const auto&, Index i) {
    Region& region = regions_[region_of(i)];
    region.count += 1;
    region.mean += static_cast<double>(values_[i]);
  });
  for (Region& region : regions_) {
    if (region.count < 3) return std::numeric_limits<double>::infinity();
    region.mean /= region.count;
  }
  std::vector<std::array<Sums, 2>> parts((rows + rows_per_task - 1) / rows_per_task);
  parallel_for(rows, rows_per_task, [&](Index begin, Index end) {
    std::array<Sums, 2>& part = parts[begin / rows_per_task];
    for_voxels(begin, end, [&](const std::array<Index, 3>& at, Index i) {
      const unsigned k = region_of(i);
      const Place here = place(at, i, regions_[k].mean);
      part[k].products += here.before * here.before.transpose() + here.behind * here.behind.transpose();
      part[k].with_value += here.value * (here.before + here.behind);
      part[k].squares += 2 * here.value * here.value;
    });
  });
  std::array<Sums, 2> sums;
  Sums both;
  for (std::size_t k = 0; k < regions_.size(); ++k) {
    for (const std::array<Sums, 2>& part : parts) sums[k].add(part[k], 1);
    both.add(sums[k], regions_[k].count / std::max(sums[k].squares, std::numeric_limits<double>::min()));
  }
  double price = 0, count = 0;
  for (std::size_t k = 0; k < regions_.size(); ++k) {
    Region& region = regions_[k];
    region.coefficients = (own_predictions ? sums[k] : both).coefficients();
    const double left = sums[k].left_by(region.coefficients);
    region.predicted = sums[k].squares > 0 ? 1 - left / sums[k].squares : 0;
    region.variance = left / (2 * region.count) + least_ * least_;
    price += 0.5 * region.count * std::log(region.variance);
    count += region.count;
  }
  const auto n = static_cast<double>(regions_.size()), axes = static_cast<double>(grid_.dimension());
  return price + 0.5 * (2 * n + (own_predictions ? n : 1) * axes) * std::log(count);
}

void NeighbourCode::force(std::span<float> to) const {
  const Region &outer = regions_[0], &inner = regions_[1];
  const double level = 0.5 * std::log(inner.variance / outer.variance);
  std::fill(to.begin(), to.end(), 0.0F);
  parallel_for(grid_.size[1] * grid_.size[2], rows_per_task, [&](Index begin, Index end) {
    for_voxels(begin, end, [&](const std::array<Index, 3>& at, Index i) {
      to[i] = static_cast<float>(0.5 * square(inner, at, i) / inner.variance -
                                 0.5 * square(outer, at, i) / outer.variance + level);
    });
  });
}

void NeighbourCode::fill_products(std::span<float> to) const {
  double sum = 0, count = 0;
  const Index rows = grid_.size[1] * grid_.size[2];
  for_voxels(0, rows, [&](const auto&, Index i) {
    sum += static_cast<double>(values_[i]);
    count += 1;
  });
  std::fill(to.begin(), to.end(), 0.0F);
  parallel_for(rows, rows_per_task, [&](Index begin, Index end) {
    for_voxels(begin, end, [&](const std::array<Index, 3>& at, Index i) {
      const Place here = place(at, i, sum / count);
      to[i] = static_cast<float>(here.value * (here.before + here.behind).sum());
    });
  });
}

}  // namespace csrbf
