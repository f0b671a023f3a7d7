#include "csrbf/implicit/polygonize/start_cells.hpp"

namespace csrbf::polygonization {
namespace {

// Chosen by hand.
constexpr int seed_steps = 3;                  // for each seed: seeds are expected near the surface
constexpr double largest_newton_step = 2;      // cells: keeps seeds on their component
constexpr double converged_newton_step = 0.1;  // cells: the cell of the surface is then found
constexpr int scan_steps = 266;                // 256 cells and the default margin around them
constexpr int tile = 8;                        // scanned corners are sampled in tiles of this side

// First seed of every cell along the Morton curve.
Points<3> one_per_cell(const CellLattice& lattice, const PointsRef<3>& seeds) {
  const Box<3> box{lattice.origin, lattice.position(lattice.cells)};
  std::vector<std::pair<std::uint64_t, Index>> keyed;
  for (Index i = 0; i < seeds.cols(); ++i)
    if (box.contains(seeds.col(i))) keyed.emplace_back(morton_key(lattice.cell_at(seeds.col(i))), i);
  std::sort(keyed.begin(), keyed.end());
  const auto same_cell = [](const auto& a, const auto& b) { return a.first == b.first; };
  keyed.erase(std::unique(keyed.begin(), keyed.end(), same_cell), keyed.end());
  Points<3> points(3, std::ssize(keyed));
  for (Index i = 0; i < points.cols(); ++i) points.col(i) = seeds.col(keyed[i].second);
  return points;
}

// One Newton step of every point along its gradient; moves those that have not converged to the front of `points`.
Index project_once(const CellLattice& lattice, LevelSampler& sampler, Points<3>& points, Index moving) {
  const double cell = lattice.spacing.minCoeff();
  const Jet<3> jet = sampler.jet(points.leftCols(moving));
  Index kept = 0;
  for (Index i = 0; i < moving; ++i) {
    const Point<3> gradient = jet.gradient.col(i);
    const double slope = gradient.norm();
    const double step = -jet.value[i] / slope / cell;
    const bool usable = slope > 0 && std::isfinite(step);
    if (usable)
      points.col(i) += cell * std::clamp(step, -largest_newton_step, largest_newton_step) * (gradient / slope);
    if (usable && std::abs(step) > converged_newton_step) points.col(i).swap(points.col(kept++));
  }
  return kept;
}

struct Crossing {
  Cell corner;  // lower end of a stretch of lattice edges with a sign change
  int axis;
  int length;
  bool inside;  // at the lower end
};

// Corners of every step-th plane of the lattice, sampled in slabs of `tile` layers.
class Scan {
 public:
  Scan(const CellLattice& lattice, LevelSampler& sampler)
      : lattice_(lattice),
        sampler_(sampler),
        step_((lattice.cells.maxCoeff() + scan_steps - 1) / scan_steps),
        size_((lattice.cells + step_ - 1) / step_ + 1),
        layer_(static_cast<std::size_t>(size_[0]) * size_[1]),
        below_(layer_, 0) {}

  std::vector<Crossing> crossings(const Progress& progress) {
    for (int z = 0; z < size_[2]; z += tile) {
      const int layers = std::min(tile, size_[2] - z);
      sample(z, layers);
      for (int layer = 0; layer < layers; ++layer) compare(z + layer, layer);
      report(progress, "polygonize", 0.0);
    }
    return std::move(found_);
  }

 private:
  [[nodiscard]] Cell corner(int x, int y, int z) const { return (step_ * Cell(x, y, z)).min(lattice_.cells); }

  void sample(int z, int layers) {
    std::vector<std::size_t> at;
    std::vector<double> points;
    for (int y0 = 0; y0 < size_[1]; y0 += tile)
      for (int x0 = 0; x0 < size_[0]; x0 += tile)
        for (int layer = 0; layer < layers; ++layer)
          for (int y = y0; y < std::min(y0 + tile, size_[1]); ++y)
            for (int x = x0; x < std::min(x0 + tile, size_[0]); ++x) {
              if (lattice_.on_boundary(corner(x, y, z + layer))) continue;
              const Point<3> p = lattice_.position(corner(x, y, z + layer));
              points.insert(points.end(), p.data(), p.data() + 3);
              at.push_back(layer * layer_ + static_cast<std::size_t>(y) * size_[0] + x);
            }
    const Eigen::VectorXd values = sampler_.values(Eigen::Map<const Points<3>>(points.data(), 3, std::ssize(at)));
    inside_.assign(layer_ * layers, 0);
    for (Index i = 0; i < values.size(); ++i) inside_[at[i]] = values[i] >= 0;
  }

  // Edges from every corner of one layer to its lower neighbours.
  void compare(int z, int layer) {
    const char* here = inside_.data() + layer * layer_;
    for (int y = 0; y < size_[1]; ++y) {
      for (int x = 0; x < size_[0]; ++x, ++here) {
        char& below = below_[static_cast<std::size_t>(y) * size_[0] + x];
        if (x > 0 && here[-1] != *here) add(corner(x - 1, y, z), 0, here[-1]);
        if (y > 0 && here[-size_[0]] != *here) add(corner(x, y - 1, z), 1, here[-size_[0]]);
        if (z > 0 && below != *here) add(corner(x, y, z - 1), 2, below);
        below = *here;
      }
    }
  }

  void add(const Cell& lower, int axis, char inside) {
    found_.push_back({lower, axis, std::min(step_, lattice_.cells[axis] - lower[axis]), inside != 0});
  }

  const CellLattice& lattice_;
  LevelSampler& sampler_;
  int step_;
  Cell size_;
  std::size_t layer_;
  std::vector<char> inside_;  // of the corners of a slab
  std::vector<char> below_;   // of the layer below
  std::vector<Crossing> found_;
};

// Bisects the stretches that are longer than one edge. Returns whether there were any.
bool bisect(const CellLattice& lattice, LevelSampler& sampler, std::vector<Crossing>& crossings) {
  std::vector<Crossing*> open;
  for (Crossing& crossing : crossings)
    if (crossing.length > 1) open.push_back(&crossing);
  Points<3> points(3, std::ssize(open));
  const auto middle = [](const Crossing& crossing) {
    Cell corner = crossing.corner;
    corner[crossing.axis] += crossing.length / 2;
    return corner;
  };
  for (Index i = 0; i < points.cols(); ++i) points.col(i) = lattice.position(middle(*open[i]));
  const Eigen::VectorXd values = sampler.values(points);
  for (Index i = 0; i < points.cols(); ++i) {
    Crossing& crossing = *open[i];
    const int half = crossing.length / 2;
    if ((values[i] >= 0) == crossing.inside) {
      crossing.corner = middle(crossing);
      crossing.length -= half;
    } else {
      crossing.length = half;
    }
  }
  return !open.empty();
}

}  // namespace

std::vector<Cell> cells_near_seeds(const CellLattice& lattice, LevelSampler& sampler, const PointsRef<3>& seeds) {
  Points<3> points = one_per_cell(lattice, seeds);
  Index moving = points.cols();
  for (int step = 0; step < seed_steps && moving > 0; ++step) moving = project_once(lattice, sampler, points, moving);
  points = one_per_cell(lattice, points);
  std::vector<Cell> cells;
  for (Index i = 0; i < points.cols(); ++i) cells.push_back(lattice.cell_at(points.col(i)));
  return cells;
}

std::vector<Cell> cells_by_scan(const CellLattice& lattice, LevelSampler& sampler, const Progress& progress) {
  std::vector<Crossing> crossings = Scan(lattice, sampler).crossings(progress);
  while (bisect(lattice, sampler, crossings)) {
  }
  std::vector<Cell> cells;
  for (const Crossing& crossing : crossings) cells.push_back(crossing.corner);
  return cells;
}

}  // namespace csrbf::polygonization
