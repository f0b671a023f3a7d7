#include "csrbf/surface/winding/winding_cubes.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/LU>

#include <numbers>

namespace csrbf::winding {
namespace {

// Chosen by hand; for the error of u see winding_number.hpp. Larger values of the first two: more accurate, slower.
constexpr double separation = 3;  // half sides from the centre of a cube (maximum norm) to sources in its polynomial
constexpr double opening = 4;     // radii from its centre beyond which a node replaces its samples
constexpr Index near_capacity = 1000;  // near samples of an undivided cube; larger: slower values, less memory
constexpr int max_depth = 30;  // for coincident samples: half sides of 4 / 2^30, about the resolution of coordinates

using Matrix = Eigen::Matrix<float, order, order>;

// Applies one matrix per direction to coefficients or values with index 16 i + 4 j + k. Sums in one order everywhere:
// that of Eigen's products is the processor's.
Coefficients apply(const Matrix& tx, const Matrix& ty, const Matrix& tz, const Coefficients& in) {
  static_assert(order == 4);
  Coefficients a = in, b;
  // Each round transforms the fastest direction and makes it the slowest.
  for (const Matrix* matrix : {&tz, &ty, &tx}) {
    const Matrix& m = *matrix;
    for (int i = 0; i < order; ++i)
      for (int l = 0; l < layer; ++l) {
        const float* from = a.data() + order * l;
        b[layer * i + l] = m(i, 0) * from[0] + m(i, 1) * from[1] + m(i, 2) * from[2] + m(i, 3) * from[3];
      }
    std::swap(a, b);
  }
  return a;
}

const std::array<double, order>& chebyshev_points() {
  static const std::array<double, order> points = [] {
    std::array<double, order> p{};
    for (std::size_t k = 0; k < order; ++k)
      p[k] = -std::cos((2.0 * static_cast<double>(k) + 1) * std::numbers::pi / (2 * order));
    return p;
  }();
  return points;
}

// From values at the Chebyshev points to coefficients.
const Matrix& interpolation() {
  static const Matrix matrix = [] {
    Eigen::Matrix<double, order, order> vandermonde;
    for (int k = 0; k < order; ++k)
      for (int p = 0; p < order; ++p) vandermonde(k, p) = std::pow(chebyshev_points()[k], p);
    return Matrix(vandermonde.inverse().cast<float>());
  }();
  return matrix;
}

// From coefficients in t to coefficients in s, t = s / 2 - 1/2 (lower half) or s / 2 + 1/2.
const Matrix& restriction(bool upper) {
  static const std::array<Matrix, 2> matrices = [] {
    constexpr int binomial[order][order] = {{1, 1, 1, 1}, {0, 1, 2, 3}, {0, 0, 1, 3}, {0, 0, 0, 1}};
    std::array<Matrix, 2> m{Matrix::Zero(), Matrix::Zero()};
    for (int i = 0; i < order; ++i)
      for (int j = i; j < order; ++j)
        for (std::size_t half = 0; half < 2; ++half)
          m[half](i, j) =
              static_cast<float>(binomial[i][j] * std::pow(0.5, i) * std::pow(half == 1 ? 0.5 : -0.5, j - i));
    return m;
  }();
  return matrices[upper ? 1 : 0];
}

bool is_upper(std::size_t octant, int axis) {
  return (octant >> axis & 1) != 0;
}

}  // namespace

// Takes cubes from the lists of MadeCubes, in their order.
class Cubes::Reader {
 public:
  Reader(const Tree& tree, const MadeCubes& made) : tree_(tree), made_(made) {}

  void take(Cube& cube) {
    check(cubes_ < made_.children.size() && made_.far.size() / cube.cell.far.size() > cubes_ &&
          cube.depth <= max_depth);
    const unsigned children = made_.children[cubes_];
    std::copy_n(made_.far.begin() + static_cast<std::ptrdiff_t>(cube.cell.far.size() * cubes_), cube.cell.far.size(),
                cube.cell.far.begin());
    ++cubes_;
    take_near(cube);
    check(cube.divided || children == 0);
    for (std::size_t octant = 0; octant < cube.children.size(); ++octant) {
      if ((children >> octant & 1) == 0) continue;
      std::unique_ptr<Cube> child = place_child(cube, octant);
      take(*child);
      cube.children[octant] = child.release();
    }
  }
  void expect_end() const { check(cubes_ == made_.children.size() && near_ == made_.near.size()); }

 private:
  static void check(bool holds) { require(holds, "winding::Cubes", "made", "(given)", "must be of this tree"); }

  std::int32_t next() {
    check(near_ < made_.near.size());
    return made_.near[near_++];
  }
  // Divided cubes have nodes, others, told by a negative number, ranges of samples.
  void take_near(Cube& cube) {
    const std::int32_t told = next();
    cube.divided = told >= 0;
    for (std::int32_t i = 0; i < (cube.divided ? told : -1 - told); ++i) {
      const std::int32_t first = next();
      if (cube.divided) {
        check(first >= 0 && static_cast<std::size_t>(first) < tree_.nodes.size());
        cube.near.push_back(first);
      } else {
        const std::int32_t end = next();
        check(0 <= first && first <= end && end <= tree_.points.cols());
        cube.cell.near.push_back({first, end});
      }
    }
  }

  const Tree& tree_;
  const MadeCubes& made_;
  std::size_t cubes_ = 0, near_ = 0;
};

Cubes::Cubes(const Tree& tree, const MadeCubes& made) : Cubes(tree) {
  if (made.children.empty()) return;
  root_.near.clear();
  root_.cell.near.clear();
  Reader reader(tree, made);
  reader.take(root_);
  reader.expect_end();
}

MadeCubes Cubes::made() const {
  MadeCubes made;
  tell(root_, made);
  return made;
}

void Cubes::tell(const Cube& cube, MadeCubes& made) {
  unsigned children = 0;
  for (std::size_t octant = 0; octant < cube.children.size(); ++octant)
    if (cube.children[octant].load() != nullptr) children |= 1U << octant;
  made.children.push_back(static_cast<std::uint8_t>(children));
  made.far.insert(made.far.end(), cube.cell.far.begin(), cube.cell.far.end());
  if (cube.divided) {
    made.near.push_back(static_cast<std::int32_t>(cube.near.size()));
    made.near.insert(made.near.end(), cube.near.begin(), cube.near.end());
  } else {
    made.near.push_back(-1 - static_cast<std::int32_t>(cube.cell.near.size()));
    for (const Range& range : cube.cell.near) made.near.insert(made.near.end(), {range.begin, range.end});
  }
  for (const auto& slot : cube.children)
    if (const Cube* child = slot.load()) tell(*child, made);
}

Cubes::Cube::~Cube() {
  for (const auto& child : children) delete child.load();
}

Cubes::Cubes(const Tree& tree) : tree_(tree) {
  root_.cell.half = extent;
  set_near(root_, tree.nodes.empty() ? std::vector<std::int32_t>{} : std::vector<std::int32_t>{0});
}

void Cubes::set_near(Cube& cube, std::vector<std::int32_t> near) const {
  Index samples = 0;
  for (const std::int32_t id : near) samples += tree_.nodes[id].count;
  cube.divided = samples > near_capacity && cube.depth < max_depth;
  if (cube.divided) {
    cube.near = std::move(near);
    return;
  }
  for (const std::int32_t id : near) {
    const Node& node = tree_.nodes[id];
    if (!cube.cell.near.empty() && cube.cell.near.back().end == node.begin)
      cube.cell.near.back().end += node.count;
    else
      cube.cell.near.push_back({node.begin, node.begin + node.count});
  }
}

Cubes::Sources Cubes::classify(const Cell& cell, const std::vector<std::int32_t>& candidates) const {
  Sources sources;
  std::vector<std::int32_t> stack(candidates.rbegin(), candidates.rend());
  while (!stack.empty()) {
    const std::int32_t id = stack.back();
    stack.pop_back();
    const Node& node = tree_.nodes[id];
    const double radius = node.radius();
    const Eigen::Array3d offset = (Point<3>(node.center) - cell.center).array().abs();
    const bool is_far = offset.maxCoeff() - radius > separation * cell.half;
    const double gap2 = (offset - cell.half).max(0.0).matrix().squaredNorm();
    if (is_far && gap2 + node.eps2 * radius * radius > opening * opening * radius * radius) {
      sources.expansions.push_back(id);
    } else if (node.is_leaf()) {
      (is_far ? sources.leaves : sources.near).push_back(id);
    } else if (!is_far && radius < 0.5 * cell.half) {  // small nodes are not split further
      sources.near.push_back(id);
    } else {
      stack.push_back(node.right);
      stack.push_back(id + 1);
    }
  }
  return sources;
}

std::unique_ptr<Cubes::Cube> Cubes::place_child(const Cube& parent, std::size_t octant) {
  auto cube = std::make_unique<Cube>();
  Cell& cell = cube->cell;
  cell.half = 0.5 * parent.cell.half;
  for (int axis = 0; axis < 3; ++axis)
    cell.center[axis] = parent.cell.center[axis] + (is_upper(octant, axis) ? cell.half : -cell.half);
  cube->depth = parent.depth + 1;
  return cube;
}

std::unique_ptr<Cubes::Cube> Cubes::make_child(const Cube& parent, std::size_t octant) const {
  std::unique_ptr<Cube> cube = place_child(parent, octant);
  Cell& cell = cube->cell;
  Sources sources = classify(cell, parent.near);
  set_near(*cube, std::move(sources.near));

  Coefficients values;
  const auto& points = chebyshev_points();
  for (std::size_t i = 0; i < order; ++i) {
    Layer at;
    for (std::size_t l = 0; l < layer; ++l) {
      at.x[0][l] = cell.center[0] + cell.half * points[i];
      at.x[1][l] = cell.center[1] + cell.half * points[l / order];
      at.x[2][l] = cell.center[2] + cell.half * points[l % order];
      at.sum[l] = 0;
    }
    add_sources(tree_, sources.expansions, sources.leaves, at);
    std::copy_n(at.sum, layer, values.data() + layer * i);
  }
  const Coefficients added = apply(interpolation(), interpolation(), interpolation(), values);
  cell.far = apply(restriction(is_upper(octant, 0)), restriction(is_upper(octant, 1)), restriction(is_upper(octant, 2)),
                   parent.cell.far);
  for (std::size_t k = 0; k < added.size(); ++k) cell.far[k] += added[k];
  return cube;
}

const Cell* Cubes::find(const Point<3>& x) const {
  if (!(x.array().abs() <= extent).all()) return nullptr;  // NaN is outside too
  const Cube* cube = &root_;
  while (cube->divided) {
    std::size_t octant = 0;
    for (int axis = 0; axis < 3; ++axis) octant |= (x[axis] > cube->cell.center[axis] ? std::size_t{1} : 0) << axis;
    auto& slot = cube->children[octant];
    const Cube* child = slot.load(std::memory_order_acquire);
    if (child == nullptr) {
      std::unique_ptr<Cube> made = make_child(*cube, octant);
      // Threads may create the same cube at the same time; the first one is kept.
      if (slot.compare_exchange_strong(child, made.get(), std::memory_order_acq_rel, std::memory_order_acquire))
        child = made.release();
    }
    cube = child;
  }
  return &cube->cell;
}

}  // namespace csrbf::winding
