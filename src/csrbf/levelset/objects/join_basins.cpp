#include "csrbf/levelset/objects/join_basins.hpp"

#include "csrbf/levelset/objects/bent_shapes.hpp"
#include "csrbf/levelset/objects/voxel_neighbours.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <queue>
#include <tuple>
#include <vector>

namespace csrbf {
namespace {

constexpr double misplaced = 3;       // nats per voxel; 2 to 6 find the same objects, within .01 of F1
constexpr std::size_t enough = 4096;  // voxels of a shape that are looked at
constexpr double kind = 1.4;          // nats: one of four kinds of shapes

struct Basin {
  std::vector<Index> voxels;
  double count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  double price = 0;
  std::map<std::int32_t, double> neighbours = {};  // and how much of a seam lies between them
  int version = 0;
};

struct Pair {
  double gain;
  std::int32_t a, b;
  int version_a, version_b;
  // The largest gain is the top of a queue; equal ones in the order of their labels.
  bool operator<(const Pair& other) const { return std::tie(gain, other.a, other.b) < std::tie(other.gain, a, b); }
};

class Joiner {
 public:
  Joiner(std::span<std::int32_t> labels, const Grid& grid, std::span<const std::uint8_t> seams)
      : labels_(labels),
        seams_(seams),
        grid_(grid),
        dim_(grid.dimension()),
        volume_(dim_ == 3   ? 4 * std::numbers::pi / 3
                : dim_ == 2 ? std::numbers::pi
                            : 2) {
    const double parameters = dim_ + 0.5 * dim_ * (dim_ + 1);
    const double place = std::log(static_cast<double>(labels.size()));
    shape_price_ = (1 + 0.5 * parameters) * place;
    bend_price_ = 0.5 * (dim_ - 1) * place + kind;
    for (int axis = 0; axis < dim_; ++axis) voxel_ *= grid.spacing[axis];
    gather();
  }

  void run() {
    for (std::int32_t a = 1; a < std::ssize(basins_); ++a)
      for (const auto& [b, seam] : basins_[a].neighbours)
        if (a < b) offer(a, b);
    while (!queue_.empty()) {
      const Pair pair = queue_.top();
      queue_.pop();
      if (basins_[pair.a].version == pair.version_a && basins_[pair.b].version == pair.version_b) join(pair);
    }
  }

  [[nodiscard]] std::vector<double> prices() const {
    std::vector<double> result;
    for (const Basin& basin : basins_) result.push_back(basin.price);
    return result;
  }

 private:
  [[nodiscard]] Eigen::Vector3d place(Index voxel) const {
    const Index nx = grid_.size[0], ny = grid_.size[1];
    return {static_cast<double>(voxel % nx), static_cast<double>(voxel / nx % ny),
            static_cast<double>(voxel / (nx * ny))};
  }

  void gather() {
    const std::int32_t most = *std::max_element(labels_.begin(), labels_.end());
    basins_.resize(static_cast<std::size_t>(most) + 1);
    for (Index i = 0; i < std::ssize(labels_); ++i) {
      const std::int32_t label = labels_[i];
      if (label == 0) continue;
      Basin& basin = basins_[label];
      const Eigen::Vector3d p = place(i);
      basin.voxels.push_back(i);
      basin.count += 1;
      basin.sum += p;
      basin.products += p * p.transpose();
      for_neighbours(i, grid_, [&](Index other) {
        const std::int32_t next = labels_[other];
        if (other < i || next == 0 || next == label) return;
        const double seam = !seams_.empty() && (seams_[i] != 0 || seams_[other] != 0) ? misplaced : 0;
        basin.neighbours[next] += seam;
        basins_[next].neighbours[label] += seam;
      });
    }
    const Basin none;
    for (Basin& basin : basins_)
      if (basin.count > 0) basin.price = price(basin, none);
  }

  // Of the two basins as one shape.
  [[nodiscard]] double price(const Basin& a, const Basin& b) const {
    const double count = a.count + b.count;
    const Eigen::Vector3d mean = (a.sum + b.sum) / count;
    Eigen::Matrix3d spread = (a.products + b.products) / count - mean * mean.transpose();
    spread.diagonal().array() += 1.0 / 12;  // of a voxel
    for (int axis = dim_; axis < 3; ++axis) spread(axis, axis) = 1;
    // x^T inverse x <= 1 within the ellipsoid of these moments that has as many voxels.
    const double ellipsoid = volume_ * std::pow(dim_ + 2, 0.5 * dim_) * std::sqrt(spread.determinant());
    const Eigen::Matrix3d inverse = spread.inverse() / ((dim_ + 2) * std::pow(count / ellipsoid, 2.0 / dim_));
    double seen = 0, inside = 0;
    const std::size_t step = 1 + (a.voxels.size() + b.voxels.size()) / enough;
    for (const Basin* basin : {&a, &b})
      for (std::size_t i = 0; i < basin->voxels.size(); i += step) {
        const Eigen::Vector3d off = place(basin->voxels[i]) - mean;
        seen += 1;
        inside += off.dot(inverse * off) <= 1 ? 1 : 0;
      }
    // As many voxels are missing inside the ellipsoid as there are outside of it.
    const double ellipsoid_price = misplaced * 2 * count * (1 - inside / seen);
    if (dim_ < 2 || ellipsoid_price <= bend_price_) return shape_price_ + ellipsoid_price;
    std::vector<Point<3>> points;
    points.reserve(static_cast<std::size_t>(seen));
    for (const Basin* basin : {&a, &b})
      for (std::size_t i = 0; i < basin->voxels.size(); i += step)
        points.push_back(place(basin->voxels[i]).cwiseProduct(grid_.spacing));
    const BentShapes bent = fit_bent_shapes(points, count * voxel_, voxel_, dim_);
    const double voxel_price = misplaced * 2 * count;
    const double bent_price = bend_price_ + std::min(voxel_price * bent.ellipsoid, voxel_price * bent.rod + kind);
    return shape_price_ + std::min(ellipsoid_price, bent_price);
  }

  void offer(std::int32_t a, std::int32_t b) {
    const double seam = basins_[a].neighbours.at(b);
    const double gain = basins_[a].price + basins_[b].price - price(basins_[a], basins_[b]) - seam;
    if (gain > 0) queue_.push({gain, a, b, basins_[a].version, basins_[b].version});
  }

  void join(const Pair& pair) {
    const bool first = basins_[pair.a].count >= basins_[pair.b].count;
    const std::int32_t to = first ? pair.a : pair.b, from = first ? pair.b : pair.a;
    Basin &kept = basins_[to], &gone = basins_[from];
    kept.price += gone.price - pair.gain - kept.neighbours.at(from);
    kept.count += gone.count;
    kept.sum += gone.sum;
    kept.products += gone.products;
    for (const Index voxel : gone.voxels) labels_[voxel] = to;
    kept.voxels.insert(kept.voxels.end(), gone.voxels.begin(), gone.voxels.end());
    for (const auto& [other, seam] : gone.neighbours) {
      basins_[other].neighbours.erase(from);
      if (other == to) continue;
      basins_[other].neighbours[to] += seam;
      kept.neighbours[other] += seam;
    }
    ++kept.version;
    gone = {};
    gone.version = -1;
    for (const auto& [other, seam] : kept.neighbours) offer(std::min(to, other), std::max(to, other));
  }

  std::span<std::int32_t> labels_;
  std::span<const std::uint8_t> seams_;
  const Grid& grid_;
  int dim_;
  double volume_;  // of the unit ball
  double shape_price_, bend_price_;
  double voxel_ = 1;
  std::vector<Basin> basins_;
  std::priority_queue<Pair> queue_;
};

}  // namespace

std::vector<double> join_basins(std::span<std::int32_t> labels, const Grid& grid, std::span<const std::uint8_t> seams) {
  Joiner joiner(labels, grid, seams);
  joiner.run();
  return joiner.prices();
}

}  // namespace csrbf
