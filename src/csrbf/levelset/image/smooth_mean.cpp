#include "csrbf/levelset/image/smooth_mean.hpp"

#include "csrbf/core/dense_decompositions.hpp"
#include "csrbf/levelset/image/block_means.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/image/common_background.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace csrbf {
namespace {

constexpr std::size_t most_rounds = 12;  // by hand: one leaves a third of cubic light, more change little
constexpr float prior = 0.02F;           // weight of 0, of that of a full neighbourhood; by hand
constexpr Index blocks_per_half = 4;     // that a half width spans; by hand

// Shares that a local mean of three boxes keeps of its own waves, along an axis of so many blocks.
Eigen::VectorXd shares_of_waves(Index blocks, Index half_width) {
  Eigen::MatrixXd box(blocks, blocks);
  for (Index i = 0; i < blocks; ++i)
    for (Index j = 0; j < blocks; ++j) box(i, j) = std::abs(i - j) <= half_width ? 1 : 0;
  const Eigen::VectorXd root = box.rowwise().sum().cwiseSqrt().cwiseInverse();
  box = root.asDiagonal() * box * root.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(box, Eigen::EigenvaluesOnly).eigenvalues().array().cube();
}

// What smooth means of one round, two, ... cost, in numbers of so many nats each. As in the likelihood of a random
// field, a wave of which the share s is kept costs -log(1 - s) / 2, but no more than a number. Of a wave of which one
// round keeps the share g, all but (1 - g)^rounds is kept.
std::array<double, most_rounds> numbers_of_rounds(const Grid& blocks, const std::array<Index, 3>& half_width,
                                                  double nats) {
  std::array<Eigen::VectorXd, 3> shares;
  for (std::size_t a = 0; a < 3; ++a) shares[a] = shares_of_waves(blocks.size[a], half_width[a]);
  std::array<double, most_rounds> sums{};
  for (const double z : shares[2])
    for (const double y : shares[1])
      for (const double x : shares[0]) {
        const double of_round = -0.5 * std::log(std::clamp(1 - x * y * z, std::numeric_limits<double>::min(), 1.0));
        for (std::size_t r = 0; r < most_rounds; ++r)
          sums[r] += std::min(1.0, static_cast<double>(r + 1) * of_round / nats);
      }
  return sums;
}

// Voxels of each block: fewer at the ends.
std::vector<double> volumes_of_blocks(const Grid& grid, const Grid& blocks, const std::array<Index, 3>& block) {
  const auto length = [&](std::size_t a, Index b) {
    return static_cast<double>(std::min(block[a], grid.size[a] - b * block[a]));
  };
  std::vector<double> volumes;
  for (Index z = 0; z < blocks.size[2]; ++z)
    for (Index y = 0; y < blocks.size[1]; ++y)
      for (Index x = 0; x < blocks.size[0]; ++x) volumes.push_back(length(0, x) * length(1, y) * length(2, z));
  return volumes;
}

// A box of the size of a block makes steps between blocks linear.
void fill_between(std::span<const float> means, const std::array<Index, 3>& block, const Grid& grid,
                  std::span<float> to) {
  fill_blocks(grid, block, means, to);
  box_mean(to, grid.size, {block[0] / 2, block[1] / 2, block[2] / 2});
}

}  // namespace

double smooth_mean(std::span<const float> weights, std::span<float> values, const Grid& grid, double grain,
                   double reach) {
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
  const std::vector<float> weight = block_means(grid, block, weights), sum = block_means(grid, block, values);
  std::vector<float> close_by = weight, mean(weight.size(), 0.0F), best;
  of_blocks.average(close_by, blocks);
  double all = 0, count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    all += static_cast<double>(values[i]) * static_cast<double>(values[i]);
    count += static_cast<double>(weights[i]);
  }
  const double independent = std::max(count / grain, 3.0), nats = 0.5 * std::log(independent);
  const std::vector<double> volumes = volumes_of_blocks(grid, blocks, block);
  const std::array<double, most_rounds> numbers = numbers_of_rounds(blocks, of_blocks.half_width, nats);
  double least = std::numeric_limits<double>::infinity(), result = numbers[0];
  for (std::size_t round = 0; round < most_rounds; ++round) {
    std::vector<float> rest = sum;
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= weight[i] * mean[i];
    of_blocks.average(rest, blocks);
    double explained = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      mean[i] += rest[i] / (close_by[i] + prior);
      explained += volumes[i] * static_cast<double>(mean[i] * (2 * sum[i] - weight[i] * mean[i]));
    }
    const double price = 0.5 * independent * std::log(std::max(all - explained, 1e-12 * all)) + nats * numbers[round];
    if (!(price < least) && round > 0) continue;
    least = price;
    best = mean;
    result = numbers[round];
  }
  fill_between(best, block, grid, values);
  return result;
}

}  // namespace csrbf
