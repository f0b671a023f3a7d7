#include "csrbf/implicit/candidate_cells.hpp"

#include "csrbf/core/error.hpp"

#include <array>

namespace csrbf {
namespace {

constexpr int block_side = 8;
constexpr int block_cells = block_side * block_side * block_side;
constexpr int margin = 4;           // cells around the bounds of the field, as many as polygonize has
constexpr int longest_stretch = 4;  // cells
constexpr double estimate_factor = 2;
constexpr double least_bend = 0.1;     // of an estimate, in units of the slope over a cell
constexpr double cell_overlap = 1e-6;  // a zero on a wall, within rounding, belongs to the cells on both sides
constexpr double step_over = 1e-9;     // of a cell, into the next one

// Distance along the ray to where it leaves a box, and whether it is ahead.
double exit_distance(const Ray& ray, const Box<3>& box) {
  double exit = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    if (ray.direction[k] == 0) continue;
    const double wall = ray.direction[k] > 0 ? box.hi[k] : box.lo[k];
    exit = std::min(exit, (wall - ray.origin[k]) / ray.direction[k]);
  }
  return exit;
}

// Where the ray enters a box; infinite when it misses it.
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

float rounded_up(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

}  // namespace

CandidateCells::CandidateCells(const Field<3>& field, int resolution, const Mesh& mesh, const Progress& progress) {
  const Box<3> bounds = field.bounds();
  const double longest = bounds.extent().maxCoeff();
  require(longest > 0 && std::isfinite(longest), "raycast", "longest side of the field's bounds", longest,
          "must be positive and finite");
  // Enclosures of larger cells are about as good: intervals of rays are divided anyway.
  constexpr int enough = 64;
  guaranteed_ = field.enclose(bounds).has_value();
  side_ = longest / (guaranteed_ ? std::min(resolution, enough) : resolution);
  origin_ = bounds.lo.array() - margin * side_;
  const Eigen::Array3i needed = (bounds.extent() / side_).array().ceil().cast<int>() + 2 * margin;
  cells_ = (needed + block_side - 1) / block_side * block_side;
  const Corner blocks = cells_ / block_side;
  block_.assign(static_cast<std::size_t>(blocks.cast<Index>().prod()), -1);
  report(progress, "cells", 0);
  if (guaranteed_)
    collect_enclosed(field, progress);
  else if (mesh.vertices.cols() > 0)
    collect_polygonized(field, mesh);
  report(progress, "cells", 1);
}

Index CandidateCells::size() const {
  return std::count_if(cell_.begin(), cell_.end(), [](const Cell& cell) { return cell.slope >= 0; });
}

Box<3> CandidateCells::box_of(const Corner& corner, int cells) const {
  const Point<3> lo = origin_ + side_ * corner.cast<double>().matrix();
  return {lo, lo.array() + side_ * cells};
}

CandidateCells::Cell* CandidateCells::find(const Corner& cell) {
  if ((cell < 0).any() || (cell >= cells_).any()) return nullptr;
  const Corner blocks = cells_ / block_side, b = cell / block_side, c = cell - block_side * b;
  std::int32_t& begin = block_[static_cast<std::size_t>(b[0] + blocks[0] * (b[1] + Index{blocks[1]} * b[2]))];
  if (begin < 0) {
    begin = static_cast<std::int32_t>(cell_.size() / block_cells);
    cell_.resize(cell_.size() + block_cells);
  }
  return &cell_[static_cast<std::size_t>(begin) * block_cells +
                static_cast<std::size_t>(c[0] + block_side * (c[1] + block_side * c[2]))];
}

const CandidateCells::Cell* CandidateCells::find(const Corner& cell, bool& block_is_empty) const {
  const Corner blocks = cells_ / block_side, b = cell / block_side, c = cell - block_side * b;
  const std::int32_t begin = block_[static_cast<std::size_t>(b[0] + blocks[0] * (b[1] + Index{blocks[1]} * b[2]))];
  block_is_empty = begin < 0;
  if (begin < 0) return nullptr;
  const Cell& found = cell_[static_cast<std::size_t>(begin) * block_cells +
                            static_cast<std::size_t>(c[0] + block_side * (c[1] + block_side * c[2]))];
  return found.slope < 0 ? nullptr : &found;
}

void CandidateCells::mark(const Corner& corner, double slope, double bend) {
  Cell* cell = find(corner);
  if (cell == nullptr) return;
  cell->slope = std::max(cell->slope, rounded_up(slope));
  cell->bend = std::max(cell->bend, rounded_up(bend));
}

// Divides the blocks that may hold a zero into octants down to the cells.
void CandidateCells::collect_enclosed(const Field<3>& field, const Progress& progress) {
  const double overlap = cell_overlap * side_;
  std::vector<Corner> front;
  const Corner blocks = cells_ / block_side;
  for (int z = 0; z < blocks[2]; ++z)
    for (int y = 0; y < blocks[1]; ++y)
      for (int x = 0; x < blocks[0]; ++x) front.push_back(block_side * Corner(x, y, z));
  for (int size = block_side; size >= 1; size /= 2) {
    report(progress, "cells", 1 - static_cast<double>(size) / block_side);
    const auto count = static_cast<Index>(front.size());
    std::vector<Enclosure> found(front.size());
    constexpr Index grain = 64;
    parallel_for(count, grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) found[i] = field.enclose(box_of(front[i], size).inflated(overlap)).value();
    });
    std::vector<Corner> next;
    for (std::size_t i = 0; i < front.size(); ++i) {
      if (found[i].lo > 0 || found[i].hi < 0) continue;
      if (size == 1) {
        mark(front[i], found[i].slope, found[i].bend);
        continue;
      }
      for (int k = 0; k < 8; ++k) next.push_back(front[i] + size / 2 * Corner(k & 1, k >> 1 & 1, k >> 2));
    }
    front = std::move(next);
  }
}

void CandidateCells::collect_polygonized(const Field<3>& field, const Mesh& mesh) {
  const Index n = mesh.vertices.cols();
  const Jet<3> jet = field.evaluate(mesh.vertices, Derivatives::hessian);
  Eigen::VectorXd bend(n);
  for (Index v = 0; v < n; ++v) bend[v] = jet.hessian_matrix(v).norm();
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (Index c = 0; c < 3; ++c) {
      const std::int32_t a = mesh.triangles(c, t), b = mesh.triangles((c + 1) % 3, t);
      // Differences over much less than a cell are rounding.
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
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) mark(corner + Corner(x, y, z), steepest, curved);
  }
}

bool CandidateCells::next(const Ray& ray, double t, double t_max, Stretch& stretch) const {
  const Box<3> lattice{origin_, origin_ + side_ * cells_.cast<double>().matrix()};
  t = std::max(t, entry_distance(ray, lattice));
  if (!(t < t_max)) return false;
  // Into the next cell, also where positions on the ray are rounded to more than that.
  const double nudge = step_over * side_ + 1e-15 * (t + lattice.diagonal() + ray.origin.lpNorm<Eigen::Infinity>());
  int length = 0;
  while (t < t_max) {
    const Point<3> inside = ray.origin + (t + nudge) * ray.direction;
    const Corner corner = ((inside - origin_) / side_).array().floor().cast<int>();
    if ((corner < 0).any() || (corner >= cells_).any()) break;
    bool skip_block = false;
    const Cell* cell = find(corner, skip_block);
    if (cell == nullptr && length > 0) break;
    const Box<3> box = skip_block ? box_of(corner / block_side * block_side, block_side) : box_of(corner, 1);
    const double exit = std::max(exit_distance(ray, box), t + nudge);
    if (cell != nullptr) {
      if (length == 0) stretch = {t, t, 0, 0};
      stretch.end = exit;
      stretch.slope = std::max(stretch.slope, double{cell->slope});
      stretch.bend = std::max(stretch.bend, double{cell->bend});
      if (++length == longest_stretch) break;
    }
    t = exit;
  }
  stretch.end = std::min(stretch.end, t_max);
  return length > 0;
}

}  // namespace csrbf
