#include "csrbf/implicit/rays/candidate_cells.hpp"

#include "csrbf/core/parallel.hpp"

namespace csrbf {
namespace {

constexpr int block_side = 8;  // cells; empty blocks take no memory and are skipped
constexpr int block_cells = block_side * block_side * block_side;
constexpr int margin = 4;  // cells around the bounds of the field, the default of polygonize
// Chosen by hand.
constexpr int longest_stretch = 4;     // cells that share bounds; longer: fewer steps, looser bounds
constexpr double estimate_factor = 2;  // of estimated second derivatives over those found; larger: slower, safer
constexpr double least_bend = 0.1;     // floor of an estimate, in units of the slope over a cell
constexpr double safety_factor = 1.5;  // of the change of f in half a cell over the estimate from its gradient
constexpr double cell_overlap = 1e-6;  // cells: a zero on a wall, within rounding, belongs to the cells on both sides

// Distance along the ray to where it leaves a box.
double exit_distance(const Ray& ray, const Box<3>& box) {
  double exit = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (ray.direction[k] == 0) continue;
    const double wall = ray.direction[k] > 0 ? box.hi[k] : box.lo[k];
    exit = std::min(exit, (wall - ray.origin[k]) / ray.direction[k]);
  }
  return exit;
}

// Distance along the ray to where it enters a box; infinite if it misses it.
double entry_distance(const Ray& ray, const Box<3>& box) {
  double entry = 0;
  for (int k = 0; k < 3; ++k) {
    if (ray.direction[k] == 0) {
      if (!(ray.origin[k] >= box.lo[k] && ray.origin[k] <= box.hi[k])) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double wall = ray.direction[k] > 0 ? box.lo[k] : box.hi[k];
    entry = std::max(entry, (wall - ray.origin[k]) / ray.direction[k]);
  }
  return entry <= exit_distance(ray, box) ? entry : std::numeric_limits<double>::infinity();
}

// Calls visit(lo), ..., visit(hi) for the corners of a box, x fastest.
template <class Visit>
void for_each_corner(const Eigen::Array3i& lo, const Eigen::Array3i& hi, const Visit& visit) {
  for (int z = lo[2]; z <= hi[2]; ++z)
    for (int y = lo[1]; y <= hi[1]; ++y)
      for (int x = lo[0]; x <= hi[0]; ++x) visit(Eigen::Array3i(x, y, z));
}

float rounded_up(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

}  // namespace

CandidateCells::CandidateCells(const Field<3>& field, int resolution, const Mesh& mesh, const Progress& progress) {
  const Box<3> bounds = field.bounds();
  const double longest = bounds.extent().maxCoeff();
  require(longest > 0 && std::isfinite(longest), "raycast", "longest side of the field's bounds", longest,
          "must be positive and finite");
  // Cells along the longest side: smaller ones would hardly help, since intervals of rays are subdivided anyway.
  constexpr int largest_enclosed = 64;
  guaranteed_ = field.enclose(bounds).has_value();
  side_ = longest / (guaranteed_ ? std::min(resolution, largest_enclosed) : resolution);
  origin_ = bounds.lo.array() - margin * side_;
  const Eigen::Array3i needed = (bounds.extent() / side_).array().ceil().cast<int>() + 2 * margin;
  cells_ = (needed + block_side - 1) / block_side * block_side;
  const Corner blocks = cells_ / block_side;
  block_.assign(blocks.cast<Index>().prod(), -1);
  report(progress, "cells", 0);
  if (guaranteed_) {
    collect_enclosed(field, progress);
  } else if (mesh.vertices.cols() > 0) {
    spread(field, collect_polygonized(field, mesh), progress);
  }
  report(progress, "cells", 1);
}

Index CandidateCells::size() const {
  return std::count_if(cell_.begin(), cell_.end(), [](const Cell& cell) { return cell.lipschitz >= 0; });
}

Box<3> CandidateCells::box_of(const Corner& corner, int cells) const {
  const Point<3> lo = origin_ + side_ * corner.cast<double>().matrix();
  return {lo, lo.array() + side_ * cells};
}

CandidateCells::Cell* CandidateCells::find(const Corner& cell) {
  if ((cell < 0).any() || (cell >= cells_).any()) return nullptr;
  const Corner blocks = cells_ / block_side, b = cell / block_side, c = cell - block_side * b;
  std::int32_t& begin = block_[b[0] + blocks[0] * (b[1] + Index{blocks[1]} * b[2])];
  if (begin < 0) {
    begin = static_cast<std::int32_t>(cell_.size() / block_cells);
    cell_.resize(cell_.size() + block_cells);
  }
  return &cell_[Index{begin} * block_cells + c[0] + block_side * (c[1] + block_side * c[2])];
}

const CandidateCells::Cell* CandidateCells::find(const Corner& cell, bool& block_is_empty) const {
  const Corner blocks = cells_ / block_side, b = cell / block_side, c = cell - block_side * b;
  const std::int32_t begin = block_[b[0] + blocks[0] * (b[1] + Index{blocks[1]} * b[2])];
  block_is_empty = begin < 0;
  if (begin < 0) return nullptr;
  const Cell& found = cell_[Index{begin} * block_cells + c[0] + block_side * (c[1] + block_side * c[2])];
  return found.lipschitz < 0 ? nullptr : &found;
}

void CandidateCells::mark(const Corner& corner, double slope, double bend) {
  Cell* cell = find(corner);
  if (cell == nullptr) return;
  cell->lipschitz = std::max(cell->lipschitz, rounded_up(slope));
  cell->hessian_bound = std::max(cell->hessian_bound, rounded_up(bend));
}

// Subdivides the blocks that may contain a zero into octants down to the cells.
void CandidateCells::collect_enclosed(const Field<3>& field, const Progress& progress) {
  const double overlap = cell_overlap * side_;
  std::vector<Corner> front;
  const Corner blocks = cells_ / block_side;
  for_each_corner(Corner::Zero(), blocks - 1, [&](const Corner& block) { front.push_back(block_side * block); });
  for (int size = block_side; size >= 1; size /= 2) {
    report(progress, "cells", 1 - static_cast<double>(size) / block_side);
    const auto count = std::ssize(front);
    std::vector<Enclosure> found(front.size());
    constexpr Index grain = 64;
    parallel_for(count, grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) found[i] = field.enclose(box_of(front[i], size).inflated(overlap)).value();
    });
    std::vector<Corner> next;
    for (std::size_t i = 0; i < front.size(); ++i) {
      if (found[i].lo > 0 || found[i].hi < 0) continue;
      if (size == 1) {
        mark(front[i], found[i].lipschitz, found[i].hessian_bound);
        continue;
      }
      for (int k = 0; k < 8; ++k) next.push_back(front[i] + size / 2 * Corner(k & 1, k >> 1 & 1, k >> 2));
    }
    front = std::move(next);
  }
}

// Returns the mean slope at the vertices.
double CandidateCells::collect_polygonized(const Field<3>& field, const Mesh& mesh) {
  const Index n = mesh.vertices.cols();
  const Jet<3> jet = field.evaluate(mesh.vertices, Derivatives::hessian);
  Eigen::VectorXd bend(n);
  for (Index v = 0; v < n; ++v) bend[v] = jet.hessian_matrix(v).norm();
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (Index c = 0; c < 3; ++c) {
      const std::int32_t a = mesh.triangles(c, t), b = mesh.triangles((c + 1) % 3, t);
      // Differences over much less than a cell are dominated by rounding.
      const double length = std::max((mesh.vertices.col(a) - mesh.vertices.col(b)).norm(), 0.1 * side_);
      const double jump = (jet.gradient.col(a) - jet.gradient.col(b)).norm() / length;
      bend[a] = std::max(bend[a], jump);
      bend[b] = std::max(bend[b], jump);
    }
  for (Index v = 0; v < n; ++v) {
    const Corner corner = ((mesh.vertices.col(v) - origin_) / side_).array().floor().cast<int>();
    const double slope = jet.gradient.col(v).norm();
    const double curved = estimate_factor * bend[v] + least_bend * slope / side_;
    const double steepest = slope + curved * 2 * side_;
    for_each_corner(corner - 1, corner + 1, [&](const Corner& cell) { mark(cell, steepest, curved); });
  }
  return jet.gradient.colwise().norm().mean();
}

std::vector<CandidateCells::Corner> CandidateCells::candidates() const {
  std::vector<Corner> found;
  const Corner blocks = cells_ / block_side;
  for_each_corner(Corner::Zero(), blocks - 1, [&](const Corner& b) {
    if (block_[b[0] + blocks[0] * (b[1] + Index{blocks[1]} * b[2])] < 0) return;
    for_each_corner(block_side * b, block_side * (b + 1) - 1, [&](const Corner& cell) {
      bool block_is_empty = false;
      if (find(cell, block_is_empty) != nullptr) found.push_back(cell);
    });
  });
  return found;
}

Points<3> CandidateCells::centers_of(const std::vector<Corner>& cells) const {
  Points<3> centers(3, std::ssize(cells));
  for (Index i = 0; i < centers.cols(); ++i) centers.col(i) = box_of(cells[i], 1).center();
  return centers;
}

// The cells adjacent to these that have not been examined.
std::vector<CandidateCells::Corner> CandidateCells::unseen_neighbors(const std::vector<Corner>& cells) {
  std::vector<Corner> neighbors;
  for (const Corner& cell : cells)
    for_each_corner(cell - 1, cell + 1, [&](const Corner& next) {
      Cell* const found = find(next);
      if (found == nullptr || found->lipschitz != unseen) return;
      found->lipschitz = excluded;
      neighbors.push_back(next);
    });
  return neighbors;
}

void CandidateCells::spread(const Field<3>& field, double typical_slope, const Progress& progress) {
  const double reach = 0.5 * std::sqrt(3.0) * side_;  // from the centre of a cell to its corners
  std::vector<Corner> front = candidates();
  while (!front.empty()) {
    report(progress, "cells", 0.5);
    std::vector<Corner> cells = unseen_neighbors(front);
    // In the middle of a thin part f is small, whatever its gradient there.
    const Jet<3> first = field.evaluate(centers_of(cells), Derivatives::gradient);
    std::vector<Corner> near;
    for (Index i = 0; i < first.value.size(); ++i) {
      const double slope = std::max(typical_slope, first.gradient.col(i).norm());
      if (std::abs(first.value[i]) <= safety_factor * slope * reach) near.push_back(cells[i]);
    }
    const Jet<3> jet = field.evaluate(centers_of(near), Derivatives::hessian);
    front.clear();
    for (Index i = 0; i < jet.value.size(); ++i) {
      const double slope = jet.gradient.col(i).norm(), bend = jet.hessian_matrix(i).norm();
      if (std::abs(jet.value[i]) > safety_factor * (slope + 0.5 * bend * reach) * reach) continue;
      const double curved = estimate_factor * bend + least_bend * slope / side_;
      mark(near[i], slope + curved * reach, curved);
      front.push_back(near[i]);
    }
  }
}

// The cell in which the ray enters the lattice.
bool CandidateCells::enter(const Ray& ray, Walk& walk) const {
  walk.started = true;
  walk.t = entry_distance(ray, {origin_, origin_ + side_ * cells_.cast<double>().matrix()});
  if (!std::isfinite(walk.t)) return false;
  const Point<3> place = (ray.origin + walk.t * ray.direction - origin_) / side_;
  walk.cell = place.array().floor().max(0).min(cells_.cast<double>() - 1).cast<int>();
  return true;
}

// Leaves the box of `cells` cells along each axis that contains the cell. Always advances by whole cells, so that a ray
// along a wall makes progress.
void CandidateCells::step(const Ray& ray, int cells, Walk& walk) const {
  const Corner corner = walk.cell / cells * cells;
  const Box<3> box = box_of(corner, cells);
  double exit = std::numeric_limits<double>::infinity();
  Index axis = 0;
  for (Index k = 0; k < 3; ++k) {
    if (ray.direction[k] == 0) continue;
    const double t = ((ray.direction[k] > 0 ? box.hi[k] : box.lo[k]) - ray.origin[k]) / ray.direction[k];
    if (!(t < exit)) continue;
    exit = t;
    axis = k;
  }
  walk.t = std::max(walk.t, exit);
  if (cells > 1) {
    const Point<3> place = (ray.origin + walk.t * ray.direction - origin_) / side_;
    const Eigen::Array3d last = (corner + cells - 1).cast<double>();
    walk.cell = place.array().floor().max(corner.cast<double>()).min(last).cast<int>();
  }
  walk.cell[axis] = ray.direction[axis] > 0 ? corner[axis] + cells : corner[axis] - 1;
}

bool CandidateCells::next(const Ray& ray, double t_max, Walk& walk, Stretch& stretch) const {
  if (!walk.started && !enter(ray, walk)) return false;
  int length = 0;
  while (walk.t < t_max && (walk.cell >= 0).all() && (walk.cell < cells_).all() && length < longest_stretch) {
    bool block_is_empty = false;
    const Cell* cell = find(walk.cell, block_is_empty);
    if (cell == nullptr && length > 0) break;
    const double begin = walk.t;
    step(ray, block_is_empty ? block_side : 1, walk);
    if (cell == nullptr) continue;
    if (length++ == 0) stretch = {begin, begin, 0, 0};
    stretch.end = std::min(walk.t, t_max);
    stretch.lipschitz = std::max(stretch.lipschitz, double{cell->lipschitz});
    stretch.hessian_bound = std::max(stretch.hessian_bound, double{cell->hessian_bound});
  }
  return length > 0;
}

}  // namespace csrbf
