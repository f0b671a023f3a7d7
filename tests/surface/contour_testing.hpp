#pragma once

#include "csrbf/core/mesh.hpp"

#include <Eigen/Geometry>

#include <array>
#include <functional>
#include <map>
#include <vector>

namespace csrbf {

/// Positive inside.
using Solid3 = std::function<double(const Point<3>&)>;

/// A plane to cut a solid with.
struct Cut {
  Point<3> origin, normal;
};

/// Planes z = height, evenly spaced with half a spacing left at either end.
inline std::vector<Cut> horizontal_cuts(double lo, double hi, int count) {
  std::vector<Cut> cuts;
  for (int k = 0; k < count; ++k) cuts.push_back({{0, 0, lo + (hi - lo) * (k + 0.5) / count}, Point<3>::UnitZ()});
  return cuts;
}

/// The contours of a solid within |u|, |v| < reach of the origin of each plane, exact at their vertices: where the sign
/// changes along the lines of a grid of `cells` cells.
class ContourCutter {
 public:
  ContourCutter(Solid3 solid, double reach, int cells) : solid_(std::move(solid)), reach_(reach), cells_(cells) {}

  [[nodiscard]] Polylines operator()(const std::vector<Cut>& cuts) {
    for (const Cut& cut : cuts) add(cut);
    Polylines lines;
    const auto n = static_cast<Index>(vertices_.size()), e = static_cast<Index>(edges_.size());
    lines.vertices = Eigen::Map<const Points<3>>(vertices_.front().data(), 3, n);
    lines.edges = Eigen::Map<const Eigen::Matrix<std::int32_t, 2, Eigen::Dynamic>>(edges_.front().data(), 2, e);
    return lines;
  }

 private:
  using Node = std::array<int, 2>;

  [[nodiscard]] Point<3> place(const Node& node) const {
    constexpr double aside = 1e-4;  // contours do not pass through nodes
    return origin_ + (reach_ * (2.0 * node[0] / cells_ - 1) + aside) * u_ +
           (reach_ * (2.0 * node[1] / cells_ - 1) + aside / 3) * v_;
  }

  // The vertex between two nodes, found by bisection.
  std::int32_t vertex(const Node& a, const Node& b) {
    const auto [found, is_new] = known_.try_emplace({std::min(a, b), std::max(a, b)}, 0);
    if (!is_new) return found->second;
    Point<3> inside = place(a), outside = place(b);
    if (solid_(inside) <= 0) std::swap(inside, outside);
    for (int i = 0; i < 60; ++i) {
      const Point<3> middle = 0.5 * (inside + outside);
      (solid_(middle) > 0 ? inside : outside) = middle;
    }
    vertices_.push_back(0.5 * (inside + outside));
    return found->second = static_cast<std::int32_t>(vertices_.size()) - 1;
  }

  void add(const Cut& cut) {
    origin_ = cut.origin;
    u_ = cut.normal.unitOrthogonal();
    v_ = cut.normal.cross(u_);
    known_.clear();
    for (int j = 0; j < cells_; ++j)
      for (int i = 0; i < cells_; ++i) {
        const std::array<Node, 4> corner{{{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
        std::vector<std::int32_t> crossed;
        for (std::size_t k = 0; k < 4; ++k) {
          const Node &a = corner[k], &b = corner[(k + 1) % 4];
          if ((solid_(place(a)) > 0) != (solid_(place(b)) > 0)) crossed.push_back(vertex(a, b));
        }
        for (std::size_t k = 0; k + 1 < crossed.size(); k += 2) edges_.push_back({crossed[k], crossed[k + 1]});
      }
  }

  Solid3 solid_;
  double reach_;
  int cells_;
  Point<3> origin_, u_, v_;
  std::map<std::array<Node, 2>, std::int32_t> known_;
  std::vector<Point<3>> vertices_;
  std::vector<std::array<std::int32_t, 2>> edges_;
};

}  // namespace csrbf
