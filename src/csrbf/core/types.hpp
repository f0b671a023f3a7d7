#pragma once

#if !defined(_MSVC_LANG) && __cplusplus < 202002L
#error "csrbf needs C++20: compile with -std=c++20 or later"
#endif

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

/// X(Dim) for every dimension in which the templates on `int Dim` of the library are instantiated. Their definitions
/// are in source files; a further dimension needs an entry here. CSRBF_FEW_DIMENSIONS leaves out more than three
/// dimensions (CMake: CSRBF_LARGEST_DIMENSION).
///
/// CSRBF_FOR_MANY_DIMS has one more, 20, for what one system of radial functions needs. Functions of more variables
/// than largest_dimension are fitted there, with zeros for the variables that they do not have (see Function).
#ifdef CSRBF_FEW_DIMENSIONS
#define CSRBF_FOR_EACH_DIM(X) X(1) X(2) X(3)
#define CSRBF_FOR_MANY_DIMS(X) CSRBF_FOR_EACH_DIM(X)
#else
#define CSRBF_FOR_EACH_DIM(X) X(1) X(2) X(3) X(4) X(5) X(6)
#define CSRBF_FOR_MANY_DIMS(X) CSRBF_FOR_EACH_DIM(X) X(20)
#endif

/// csrbf: smooth functions and surfaces from scattered data by compactly supported radial basis functions.
namespace csrbf {

using Index = Eigen::Index;

/// The largest dimension of CSRBF_FOR_EACH_DIM, and of CSRBF_FOR_MANY_DIMS: the most variables that a function may
/// have.
#ifdef CSRBF_FEW_DIMENSIONS
inline constexpr int largest_dimension = 3, most_variables = 3;
#else
inline constexpr int largest_dimension = 6, most_variables = 20;
#endif

/// A point of R^Dim.
template <int Dim>
using Point = Eigen::Matrix<double, Dim, 1>;

/// n points as the columns of a Dim x n matrix: the memory layout of a C-ordered (n, Dim) array.
template <int Dim>
using Points = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

/// Read-only view of points; binds to Points, maps and column blocks without a copy.
template <int Dim>
using PointsRef = Eigen::Ref<const Points<Dim>>;

/// Views points held as one std::array each as a Dim x n matrix, without a copy: as_points<3>(v) for a
/// std::vector<std::array<double, 3>> v.
template <int Dim>
Eigen::Map<const Points<Dim>> as_points(std::span<const std::array<double, static_cast<std::size_t>(Dim)>> points) {
  return {points.empty() ? nullptr : points.front().data(), Dim, std::ssize(points)};
}

/// Number of independent entries of a symmetric Dim x Dim matrix.
template <int Dim>
inline constexpr int symmetric_size = Dim*(Dim + 1) / 2;

/// An axis-aligned box [lo, hi]; empty until a point is added.
template <int Dim>
struct Box {
  Point<Dim> lo = Point<Dim>::Constant(std::numeric_limits<double>::infinity());
  Point<Dim> hi = Point<Dim>::Constant(-std::numeric_limits<double>::infinity());

  // Loops instead of Eigen expressions: these functions are in every file, and the compiler takes long for each
  // expression in each dimension.
  void add(const Point<Dim>& p) {
    for (int a = 0; a < Dim; ++a) {
      lo[a] = p[a] < lo[a] ? p[a] : lo[a];
      hi[a] = hi[a] < p[a] ? p[a] : hi[a];
    }
  }
  void add(const Box& other) {
    for (int a = 0; a < Dim; ++a) {
      lo[a] = other.lo[a] < lo[a] ? other.lo[a] : lo[a];
      hi[a] = hi[a] < other.hi[a] ? other.hi[a] : hi[a];
    }
  }
  [[nodiscard]] bool empty() const {
    for (int a = 0; a < Dim; ++a)
      if (!(lo[a] <= hi[a])) return true;
    return false;
  }
  [[nodiscard]] Point<Dim> extent() const {
    Point<Dim> result = Point<Dim>::Zero();
    if (empty()) return result;
    for (int a = 0; a < Dim; ++a) result[a] = hi[a] - lo[a];
    return result;
  }
  [[nodiscard]] Point<Dim> center() const {
    Point<Dim> result;
    for (int a = 0; a < Dim; ++a) result[a] = 0.5 * (lo[a] + hi[a]);
    return result;
  }
  [[nodiscard]] double diagonal() const { return extent().norm(); }
  [[nodiscard]] bool contains(const Point<Dim>& p) const {
    for (int a = 0; a < Dim; ++a)
      if (!(p[a] >= lo[a] && p[a] <= hi[a])) return false;
    return true;
  }
  [[nodiscard]] bool intersects(const Box& other) const {
    for (int a = 0; a < Dim; ++a)
      if (!(lo[a] <= other.hi[a] && hi[a] >= other.lo[a])) return false;
    return true;
  }
  /// The box grown by `margin` on every side.
  [[nodiscard]] Box inflated(double margin) const {
    Box grown = *this;
    for (int a = 0; a < Dim; ++a) {
      grown.lo[a] -= margin;
      grown.hi[a] += margin;
    }
    return grown;
  }
};

/// The smallest box that contains all points; NaN coordinates are ignored. O(n).
template <int Dim>
Box<Dim> bounding_box(const PointsRef<Dim>& points);

/// What the physical axes of an image or mesh mean: unknown, or patient coordinates in mm with x to the left or right,
/// y to the back or front, and z to the head.
enum class Space { unknown, left_posterior_superior, right_anterior_superior };

/// "LPS", "RAS" or "unknown", as 3D Slicer calls them.
constexpr const char* space_name(Space space) {
  switch (space) {
    case Space::left_posterior_superior:
      return "LPS";
    case Space::right_anterior_superior:
      return "RAS";
    default:
      return "unknown";
  }
}

}  // namespace csrbf
