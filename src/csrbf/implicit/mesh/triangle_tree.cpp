#include "csrbf/implicit/mesh/triangle_tree.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/mesh/triangle_geometry.hpp"

namespace csrbf {
namespace {

using PerChild = TreeNode::PerChild;

// Local boxes are padded by this length, 8 units of rounding in single precision, which covers that of ray arithmetic.
constexpr double box_padding = 0x1p-20;
constexpr std::size_t stack_size = 3 * max_tree_depth + 4;  // three of four children wait at every depth

float round_down(double x) {
  return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}
float round_up(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

// Child still to be visited; `near` is a lower bound of its distance. Children are pushed without a branch: which of
// them are needed is unpredictable.
template <class Scalar>
struct Entry {
  std::int32_t child;
  Scalar near;
};

template <class Scalar>
void nearest_last(std::array<Entry<Scalar>, stack_size>& stack, std::size_t first, std::size_t last) {
  for (std::size_t i = first + 1; i < last; ++i) {
    const Entry<Scalar> entry = stack[i];
    std::size_t place = i;
    for (; place > first && stack[place - 1].near < entry.near; --place) stack[place] = stack[place - 1];
    stack[place] = entry;
  }
}

Box<3> surface_bounds(const Mesh& mesh) {
  constexpr const char* function = "TriangleTree";
  require(mesh.triangles.cols() > 0, function, "triangles", mesh.triangles.cols(),
          "must be positive; the mesh has no surface");
  Box<3> box;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Index v = mesh.triangles(k, t);
      require(v >= 0 && v < mesh.vertices.cols(), function, "vertex index", v,
              "must be in [0, number of vertices); the mesh is corrupt");
      require(mesh.vertices.col(v).allFinite(), function, "vertex", v,
              "must have finite coordinates; remove vertices with NaN or infinite coordinates");
      box.add(mesh.vertices.col(v));
    }
  }
  require(std::isfinite(box.extent().maxCoeff()), function, "extent", box.extent().maxCoeff(),
          "must be finite; scale the mesh down");
  return box;
}

}  // namespace

// A ray in local coordinates, starting where it enters the root box, with what the box and the triangle test need.
struct TriangleTree::LocalRay {
  Point<3> origin;
  double t_start = 0;    // local distance from the caller's origin to `origin`
  double t_max = 0;      // from `origin`
  double to_caller = 1;  // local distance to the caller's t

  std::array<PerChild, 3> origins;
  std::array<PerChild, 3> inverse;
  std::array<bool, 3> negative{};

  // Shear that maps the ray to the axis z (Woop, Benthin, Wald 2013).
  std::array<Index, 3> axis{};
  Point<3> shear;

  Hit hit;
};

TriangleTree::TriangleTree(const Mesh& mesh) : bounds_(surface_bounds(mesh)) {
  const double extent = bounds_.extent().maxCoeff();
  center_ = bounds_.lo + 0.5 * bounds_.extent();
  scale_ = extent > 0 ? std::ldexp(1.0, -std::ilogb(extent)) : 1.0;
  local_half_extent_ = 0.5 * scale_ * bounds_.extent();
  vertices_.resize(3, mesh.vertices.cols());
  constexpr Index grain = 8192;
  parallel_for(vertices_.cols(), grain, [&](Index begin, Index end) {
    for (Index v = begin; v < end; ++v) vertices_.col(v) = to_local(mesh.vertices.col(v));
  });

  const Index n = mesh.triangles.cols();
  std::vector<TriangleBox> boxes(n);
  parallel_for(n, grain, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      Box<3> box;
      for (int k = 0; k < 3; ++k) box.add(vertices_.col(mesh.triangles(k, t)));
      for (Index k = 0; k < 3; ++k) {
        boxes[t].lo[k] = round_down(box.lo[k] - box_padding);
        boxes[t].hi[k] = round_up(box.hi[k] + box_padding);
      }
      boxes[t].triangle = static_cast<std::int32_t>(t);
    }
  });
  nodes_ = build_triangle_tree(boxes);
  leaves_.resize(boxes.size());
  for (Index i = 0; i < n; ++i) {
    const std::int32_t marked = boxes[i].triangle;
    const Index t = marked < 0 ? ~marked : marked;
    leaves_[i] = {{mesh.triangles(0, t), mesh.triangles(1, t), mesh.triangles(2, t)}, marked};
  }
}

TriangleTree::Closest TriangleTree::closest(const Point<3>& x, double max_distance) const {
  using PerChild64 = Eigen::Array<double, 4, 1>;
  if (!(max_distance > 0)) return {};
  const Point<3> p = to_local(x);
  ClosestPoint best;
  best.squared_distance = max_distance * scale_ * (max_distance * scale_);
  std::int32_t best_triangle = -1;

  std::array<Entry<double>, stack_size> stack;
  std::size_t top = 0;
  stack[top++] = {0, 0.0};
  while (top > 0) {
    const std::int32_t child = stack[--top].child;
    if (!(stack[top].near < best.squared_distance)) continue;
    if (child < 0) {
      const LeafTriangle* leaf = leaves_.data() + ~child;
      for (bool last = false; !last; last = leaf++->is_last()) {
        const auto& v = leaf->vertex;
        const ClosestPoint candidate =
            closest_on_triangle(p, vertices_.col(v[0]), vertices_.col(v[1]), vertices_.col(v[2]));
        if (candidate.squared_distance < best.squared_distance) {
          best = candidate;
          best_triangle = leaf->triangle();
        }
      }
      continue;
    }
    const TreeNode& node = nodes_[child];
    PerChild64 squared = PerChild64::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const PerChild64 pk = PerChild64::Constant(p[k]);
      const PerChild64 below = node.lo[k].cast<double>(), above = node.hi[k].cast<double>();
      squared += (below - pk).max(pk - above).max(PerChild64::Zero()).square();
    }
    const std::size_t first = top;
    for (std::size_t k = 0; k < 4; ++k) {
      stack[top] = {node.child[k], squared[k]};
      top += stack[top].near < best.squared_distance;
    }
    nearest_last(stack, first, top);
  }
  if (best_triangle < 0) return {};
  return {best_triangle, center_ + best.point / scale_, std::sqrt(best.squared_distance) / scale_};
}

bool TriangleTree::enter(const Point<3>& origin, const Point<3>& direction, double t_max, LocalRay& ray) const {
  const double plain_norm = direction.norm();
  const bool in_range = plain_norm > 1e-100 && plain_norm < 1e100;
  const double length = in_range ? plain_norm : direction.stableNorm();
  if (!(length > 0) || !std::isfinite(length) || !origin.allFinite()) return false;
  constexpr double smallest = 1e-20;  // keeps the reciprocals finite in single precision
  const Point<3> d = direction / length;
  const Point<3> o = to_local(origin);
  Point<3> inverse;
  for (int k = 0; k < 3; ++k) inverse[k] = 1 / std::copysign(std::max(std::abs(d[k]), smallest), d[k]);

  const Point<3> margin = local_half_extent_ + Point<3>::Constant(2 * box_padding);
  double t_in = 0, t_out = t_max * length * scale_;
  for (int k = 0; k < 3; ++k) {
    const double a = (-margin[k] - o[k]) * inverse[k], b = (margin[k] - o[k]) * inverse[k];
    t_in = std::max(t_in, std::min(a, b));
    t_out = std::min(t_out, std::max(a, b));
  }
  if (!(t_in <= t_out)) return false;

  ray.to_caller = 1 / (scale_ * length);
  ray.t_start = t_in;
  ray.t_max = t_max * length * scale_ - t_in;
  ray.origin = o + t_in * d;
  for (Index k = 0; k < 3; ++k) {
    ray.negative[k] = std::signbit(d[k]);
    ray.origins[k] = PerChild::Constant(static_cast<float>(ray.origin[k]));
    ray.inverse[k] = PerChild::Constant(static_cast<float>(inverse[k]));
  }
  Index z = 0;
  d.cwiseAbs().maxCoeff(&z);
  ray.axis = {(z + 1) % 3, (z + 2) % 3, z};
  ray.shear = inverse[z] * Point<3>(d[ray.axis[0]], d[ray.axis[1]], 1);
  return true;
}

inline bool TriangleTree::intersect(const LeafTriangle& leaf, LocalRay& ray) const {
  const auto [x, y, z] = ray.axis;
  const double* a = vertices_.data() + 3 * Index{leaf.vertex[0]};
  const double* b = vertices_.data() + 3 * Index{leaf.vertex[1]};
  const double* c = vertices_.data() + 3 * Index{leaf.vertex[2]};
  const double ox = ray.origin[x], oy = ray.origin[y], oz = ray.origin[z];
  const double sx = ray.shear[0], sy = ray.shear[1];
  const double az = a[z] - oz, bz = b[z] - oz, cz = c[z] - oz;
  const double ax = a[x] - ox - sx * az, ay = a[y] - oy - sy * az;
  const double bx = b[x] - ox - sx * bz, by = b[y] - oy - sy * bz;
  const double cx = c[x] - ox - sx * cz, cy = c[y] - oy - sy * cz;
  // Scaled barycentric weights: the same two products for both triangles at an edge, so their signs are opposite.
  const double u = cx * by - cy * bx;
  const double v = ax * cy - ay * cx;
  const double w = bx * ay - by * ax;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double sum = u + v + w;
  if (sum == 0) return false;
  const double t = ray.shear[2] * (u * az + v * bz + w * cz) / sum;
  if (!(t + ray.t_start >= 0 && t <= ray.t_max)) return false;
  ray.t_max = t;
  ray.hit.triangle = leaf.triangle();
  ray.hit.weights = Point<3>(u, v, w) / sum;
  return true;
}

template <bool AnyHit>
bool TriangleTree::traverse(LocalRay& ray) const {
  std::array<Entry<float>, stack_size> stack;
  std::size_t top = 0;
  stack[top++] = {0, 0.0F};
  while (top > 0) {
    const std::int32_t child = stack[--top].child;
    const auto t_max = static_cast<float>(ray.t_max);
    if (!AnyHit && stack[top].near > t_max) continue;
    if (child < 0) {
      const LeafTriangle* leaf = leaves_.data() + ~child;
      for (bool last = false; !last; last = leaf++->is_last())
        if (intersect(*leaf, ray) && AnyHit) return true;
      continue;
    }
    const TreeNode& node = nodes_[child];
    PerChild t_in = PerChild::Constant(-static_cast<float>(box_padding)), t_out = PerChild::Constant(t_max);
    for (std::size_t k = 0; k < 3; ++k) {
      const PerChild& near_plane = ray.negative[k] ? node.hi[k] : node.lo[k];
      const PerChild& far_plane = ray.negative[k] ? node.lo[k] : node.hi[k];
      t_in = t_in.max((near_plane - ray.origins[k]) * ray.inverse[k]);
      t_out = t_out.min((far_plane - ray.origins[k]) * ray.inverse[k]);
    }
    const std::size_t first = top;
    for (std::size_t k = 0; k < 4; ++k) {
      stack[top] = {node.child[k], t_in[k]};
      top += t_in[k] <= t_out[k];
    }
    if constexpr (!AnyHit) nearest_last(stack, first, top);
  }
  return ray.hit.triangle >= 0;
}

TriangleTree::Hit TriangleTree::first_hit(const Point<3>& origin, const Point<3>& direction, double t_max) const {
  LocalRay ray;
  if (!enter(origin, direction, t_max, ray) || !traverse<false>(ray)) return {};
  ray.hit.t = (ray.t_max + ray.t_start) * ray.to_caller;
  return ray.hit;
}

bool TriangleTree::occluded(const Point<3>& origin, const Point<3>& direction, double t_max) const {
  LocalRay ray;
  return enter(origin, direction, t_max, ray) && traverse<true>(ray);
}

}  // namespace csrbf
