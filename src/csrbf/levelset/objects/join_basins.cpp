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
    hollow_price_ = 0.5 * place + kind;
    for (int axis = 0; axis < dim_; ++axis) voxel_ *= grid.spacing[axis];
    gather();
  }

  void run() {
    for (std::int32_t a = 1; a < std::ssize(basins_); ++a)
      for (const auto& [b, seam] : basins_[a].neighbours)
        if (a < b) offer(a, b);
    join_all();
    if (!seams_.empty()) return;
    std::vector<std::int32_t> left;
    for (std::int32_t a = 1; a < std::ssize(basins_); ++a)
      if (basins_[a].neighbours.size() > 1) left.push_back(a);
    std::stable_sort(left.begin(), left.end(),
                     [&](std::int32_t a, std::int32_t b) { return basins_[a].count < basins_[b].count; });
    for (const std::int32_t a : left) divide(a);
    join_all();
  }

  [[nodiscard]] std::vector<double> prices() const {
    std::vector<double> result;
    for (const Basin& basin : basins_) result.push_back(basin.price);
    return result;
  }

 private:
  void join_all() {
    while (!queue_.empty()) {
      const Pair pair = queue_.top();
      queue_.pop();
      if (basins_[pair.a].version == pair.version_a && basins_[pair.b].version == pair.version_b) join(pair);
    }
  }

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
      add(i, basins_[label]);
      for_neighbours(i, grid_, [&](Index other) {
        const std::int32_t next = labels_[other];
        if (other < i || next == 0 || next == label) return;
        touch(i, other);
      });
    }
    const Basin none;
    for (Basin& basin : basins_)
      if (basin.count > 0) basin.price = price(basin, none);
  }

  void add(Index voxel, Basin& basin) const {
    const Eigen::Vector3d p = place(voxel);
    basin.voxels.push_back(voxel);
    basin.count += 1;
    basin.sum += p;
    basin.products += p * p.transpose();
  }

  // Two voxels of different basins face each other.
  void touch(Index i, Index j) {
    const double seam = !seams_.empty() && (seams_[i] != 0 || seams_[j] != 0) ? misplaced : 0;
    basins_[labels_[i]].neighbours[labels_[j]] += seam;
    basins_[labels_[j]].neighbours[labels_[i]] += seam;
  }

  // Of the two basins as one shape.
  [[nodiscard]] double price(const Basin& a, const Basin& b) const {
    const double count = a.count + b.count;
    const Eigen::Vector3d mean = (a.sum + b.sum) / count;
    Eigen::Matrix3d spread = (a.products + b.products) / count - mean * mean.transpose();
    spread.diagonal().array() += 1.0 / 12;  // of a voxel
    for (int axis = dim_; axis < 3; ++axis) spread(axis, axis) = 1;
    // x^T inverse x <= bound within the ellipsoid of these moments that has as many voxels.
    const double ellipsoid = volume_ * std::pow(dim_ + 2, 0.5 * dim_) * std::sqrt(spread.determinant());
    const Eigen::Matrix3d inverse = spread.inverse();
    const double bound = (dim_ + 2) * std::pow(count / ellipsoid, 2.0 / dim_);
    // The same of an ellipse with a hollow, of which the share is that of the ellipse without.
    const bool hollow = dim_ == 2 && count < ellipsoid;
    const double share = count / ellipsoid, inner = 2 * (1 - share), outer = 2 * (1 + share);
    double seen = 0, inside = 0, around = 0;
    const std::size_t step = 1 + (a.voxels.size() + b.voxels.size()) / enough;
    for (const Basin* basin : {&a, &b})
      for (std::size_t i = 0; i < basin->voxels.size(); i += step) {
        const Eigen::Vector3d off = place(basin->voxels[i]) - mean;
        seen += 1;
        const double square = off.dot(inverse * off);
        inside += square <= bound ? 1 : 0;
        around += hollow && square >= inner && square <= outer ? 1 : 0;
      }
    // As many voxels are missing inside the ellipsoid as there are outside of it.
    const double voxel_price = misplaced * 2 * count;
    const double hollow_price = hollow_price_ + voxel_price * (1 - around / seen);
    const double ellipsoid_price = std::min(voxel_price * (1 - inside / seen), hollow_price);
    if (dim_ < 2 || ellipsoid_price <= bend_price_) return shape_price_ + ellipsoid_price;
    std::vector<Point<3>> points;
    points.reserve(static_cast<std::size_t>(seen));
    for (const Basin* basin : {&a, &b})
      for (std::size_t i = 0; i < basin->voxels.size(); i += step)
        points.push_back(place(basin->voxels[i]).cwiseProduct(grid_.spacing));
    const BentShapes bent = fit_bent_shapes(points, count * voxel_, voxel_, dim_);
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

  // Where objects touch there may be a basin that has parts of several: each voxel goes to the nearest neighbour if
  // that is the shorter description.
  void divide(std::int32_t label) {
    Basin& gone = basins_[label];
    if (gone.neighbours.size() < 2) return;
    std::map<std::int32_t, Basin> parts;
    if (give_away(gone.voxels, label, parts) && parts.size() > 1) {
      double gain = gone.price;
      for (const auto& [to, part] : parts) gain += basins_[to].price - price(basins_[to], part);
      if (gain > 0) {
        take_over(label, parts);
        return;
      }
    }
    for (const Index voxel : gone.voxels) labels_[voxel] = label;
  }

  // Whether all voxels have a path to a neighbour.
  bool give_away(std::span<const Index> voxels, std::int32_t label, std::map<std::int32_t, Basin>& parts) {
    std::vector<std::pair<Index, std::int32_t>> front;
    std::size_t given = 0;
    for (const Index voxel : voxels)
      for_neighbours(voxel, grid_, [&](Index j) {
        if (labels_[j] != 0 && labels_[j] != label) front.emplace_back(voxel, labels_[j]);
      });
    while (!front.empty()) {
      std::vector<Index> reached;
      for (const auto& [voxel, to] : front) {
        if (labels_[voxel] != label) continue;
        labels_[voxel] = to;
        add(voxel, parts[to]);
        reached.push_back(voxel);
      }
      given += reached.size();
      front.clear();
      for (const Index voxel : reached)
        for_neighbours(voxel, grid_, [&](Index j) {
          if (labels_[j] == label) front.emplace_back(j, labels_[voxel]);
        });
    }
    return given == voxels.size();
  }

  void take_over(std::int32_t label, const std::map<std::int32_t, Basin>& parts) {
    Basin gone;
    std::swap(gone, basins_[label]);
    basins_[label].version = -1;
    for (const auto& [other, seam] : gone.neighbours) basins_[other].neighbours.erase(label);
    std::sort(gone.voxels.begin(), gone.voxels.end());
    for (const Index voxel : gone.voxels)
      for_neighbours(voxel, grid_, [&](Index j) {
        if (labels_[j] == 0 || labels_[j] == labels_[voxel]) return;
        if (j > voxel || !std::binary_search(gone.voxels.begin(), gone.voxels.end(), j)) touch(voxel, j);
      });
    for (const auto& [to, part] : parts) {
      Basin& basin = basins_[to];
      basin.price = price(basin, part);
      basin.count += part.count;
      basin.sum += part.sum;
      basin.products += part.products;
      basin.voxels.insert(basin.voxels.end(), part.voxels.begin(), part.voxels.end());
      ++basin.version;
    }
    for (const auto& [to, part] : parts)
      for (const auto& [other, seam] : basins_[to].neighbours) offer(std::min(to, other), std::max(to, other));
  }

  std::span<std::int32_t> labels_;
  std::span<const std::uint8_t> seams_;
  const Grid& grid_;
  int dim_;
  double volume_;  // of the unit ball
  double shape_price_, bend_price_, hollow_price_;
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
