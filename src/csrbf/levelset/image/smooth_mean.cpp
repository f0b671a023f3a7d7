#include "csrbf/levelset/image/smooth_mean.hpp"

#include "csrbf/core/dense_decompositions.hpp"
#include "csrbf/levelset/image/block_means.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/image/common_background.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace csrbf {
namespace {

constexpr double reach = 0.1;         // standard deviation of the local mean, of the longest side; by hand
constexpr int rounds = 12;            // by hand: one leaves a third of cubic light, more change little
constexpr float prior = 0.02F;        // weight of 0, of that of a full neighbourhood; by hand
constexpr Index blocks_per_half = 4;  // that a half width spans; by hand

// Shares that a local mean of three boxes keeps of its own waves, along an axis of so many blocks.
Eigen::VectorXd shares_of_waves(Index blocks, Index half_width) {
  Eigen::MatrixXd box(blocks, blocks);
  for (Index i = 0; i < blocks; ++i)
    for (Index j = 0; j < blocks; ++j) box(i, j) = std::abs(i - j) <= half_width ? 1 : 0;
  const Eigen::VectorXd root = box.rowwise().sum().cwiseSqrt().cwiseInverse();
  box = root.asDiagonal() * box * root.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(box, Eigen::EigenvaluesOnly).eigenvalues().array().cube();
}

// The trace of what takes values to their smooth mean: of a wave of which one round keeps the share g, all but
// (1 - g)^rounds.
double independent_numbers(const Grid& blocks, const std::array<Index, 3>& half_width) {
  std::array<Eigen::VectorXd, 3> shares;
  for (std::size_t a = 0; a < 3; ++a) shares[a] = shares_of_waves(blocks.size[a], half_width[a]);
  double sum = 0;
  for (const double z : shares[2])
    for (const double y : shares[1])
      for (const double x : shares[0]) sum += 1 - std::pow(1 - x * y * z, rounds);
  return sum;
}

std::vector<float> means_of_blocks(std::span<const float> values, const Grid& grid, const std::array<Index, 3>& block) {
  return block_means(grid, block, [&](Index row, std::span<float> to) {
    std::copy_n(values.begin() + row * grid.size[0], grid.size[0], to.begin());
  });
}

// A box of the size of a block makes steps between blocks linear.
void fill_between(std::span<const float> means, const Grid& blocks, const std::array<Index, 3>& block, const Grid& grid,
                  std::span<float> to) {
  std::size_t i = 0;
  for (Index z = 0; z < grid.size[2]; ++z)
    for (Index y = 0; y < grid.size[1]; ++y) {
      const Index row = blocks.size[0] * (y / block[1] + blocks.size[1] * (z / block[2]));
      for (Index x = 0; x < grid.size[0]; ++x) to[i++] = means[static_cast<std::size_t>(row + x / block[0])];
    }
  box_mean(to, grid.size, {block[0] / 2, block[1] / 2, block[2] / 2});
}

}  // namespace

double smooth_mean(std::span<const float> weights, std::span<float> values, const Grid& grid) {
  const LocalMean of_voxels(grid, reach);
  LocalMean of_blocks = of_voxels;
  std::array<Index, 3> block{1, 1, 1};
  for (std::size_t a = 0; a < 3; ++a) {
    if (grid.size[a] == 1) continue;
    block[a] = 2 * (of_voxels.half_width[a] / (2 * blocks_per_half)) + 1;  // odd: its box has a centre
    const double width = static_cast<double>(of_voxels.half_width[a]) + 0.5;
    of_blocks.half_width[a] = std::lround(width / static_cast<double>(block[a]) - 0.5);
  }
  const Grid blocks = block_grid(grid, block);
  const std::vector<float> weight = means_of_blocks(weights, grid, block), sum = means_of_blocks(values, grid, block);
  std::vector<float> close_by = weight, mean(weight.size(), 0.0F);
  of_blocks.average(close_by, blocks);
  for (int round = 0; round < rounds; ++round) {
    std::vector<float> rest = sum;
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= weight[i] * mean[i];
    of_blocks.average(rest, blocks);
    for (std::size_t i = 0; i < rest.size(); ++i) mean[i] += rest[i] / (close_by[i] + prior);
  }
  fill_between(mean, blocks, block, grid, values);
  return independent_numbers(blocks, of_blocks.half_width);
}

}  // namespace csrbf
