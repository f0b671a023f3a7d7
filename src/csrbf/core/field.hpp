#pragma once

#include "csrbf/core/types.hpp"

#include <optional>
#include <vector>

namespace csrbf {

/// How many derivatives an evaluation returns besides the value.
enum class Derivatives { none = 0, gradient = 1, hessian = 2 };

/// Values and derivatives of a scalar field at n points. Parts that were not requested have no columns (and no data()).
template <int Dim>
struct Jet {
  Eigen::VectorXd value;                                               ///< n
  Points<Dim> gradient;                                                ///< Dim x n
  Eigen::Matrix<double, symmetric_size<Dim>, Eigen::Dynamic> hessian;  ///< upper triangle by rows: xx xy xz yy yz zz

  Jet() = default;
  Jet(Index n, Derivatives derivatives)
      : value(n),
        gradient(Dim, derivatives >= Derivatives::gradient ? n : 0),
        hessian(symmetric_size<Dim>, derivatives >= Derivatives::hessian ? n : 0) {}

  /// Full symmetric Hessian at point i.
  [[nodiscard]] Eigen::Matrix<double, Dim, Dim> hessian_matrix(Index i) const {
    Eigen::Matrix<double, Dim, Dim> H;
    for (int a = 0, entry = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++entry) H(a, b) = H(b, a) = hessian(entry, i);
    return H;
  }
};

/// Where a field writes the jet of a block of n points: column i of each array belongs to point i. `gradient` and
/// `hessian` are null if they are not wanted.
struct JetBlock {
  double* value = nullptr;     ///< n
  double* gradient = nullptr;  ///< Dim x n, column major
  double* hessian = nullptr;   ///< symmetric_size<Dim> x n, column major

  [[nodiscard]] Derivatives derivatives() const {
    if (hessian != nullptr) return Derivatives::hessian;
    return gradient != nullptr ? Derivatives::gradient : Derivatives::none;
  }

  /// The same arrays from point `begin` on.
  template <int Dim>
  [[nodiscard]] JetBlock from(Index begin) const {
    return {value + begin, gradient != nullptr ? gradient + Dim * begin : nullptr,
            hessian != nullptr ? hessian + symmetric_size<Dim> * begin : nullptr};
  }
};

/// Bounds that hold at every point of a box.
struct Enclosure {
  double lo = 0, hi = 0;     ///< lo <= f <= hi
  double lipschitz = 0;      ///< |f(p) - f(q)| <= lipschitz |p - q|: a bound of the gradient
  double hessian_bound = 0;  ///< |t.H t| <= hessian_bound for unit vectors t; infinite where the gradient may jump
};

/// Coordinates along each axis of a rectilinear grid. Its nodes are all combinations of them; the first axis is the
/// fastest.
template <int Dim>
using GridAxes = std::array<Eigen::VectorXd, Dim>;

/// A smooth scalar function on R^Dim, the common interface of all parts of the library.
///
/// Signs, everywhere in the library: **f > 0 inside, f = 0 on the surface, f < 0 outside**. So the outward unit normal
/// is n = -grad f / |grad f|, and convex solids have positive curvature.
template <int Dim>
class Field {
 public:
  Field() = default;
  Field(const Field&) = default;
  Field& operator=(const Field&) = default;
  virtual ~Field() = default;

  /// Evaluates a block of points on the calling thread: writes all arrays of `out` that are not null. Thread safe.
  /// Fastest if the points of a block are close to each other.
  virtual void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const = 0;

  /// A box that contains everything of interest: the data, or the zero set.
  [[nodiscard]] virtual Box<Dim> bounds() const = 0;

  /// Points close to every part of the zero set, from which it can be traced; empty if none are known.
  [[nodiscard]] virtual Points<Dim> seeds() const { return Points<Dim>(Dim, 0); }

  /// Length of the smallest detail that the field can hold, for choosing a cell size; 0 if unknown.
  [[nodiscard]] virtual double feature_size() const { return 0; }

  /// Bridges and holes of the zero set that vanish when the level moves by less than this may be errors, and meshes are
  /// made without them: the default of PolygonizeOptions::persistence. 0: all are kept.
  [[nodiscard]] virtual double least_persistence() const { return 0; }

  /// An order in which points are fast to evaluate; empty if the given order is fine.
  [[nodiscard]] virtual std::vector<Index> evaluation_order(const PointsRef<Dim>& /*x*/) const { return {}; }

  /// Guaranteed bounds on a box, so that ray casting misses nothing; nullopt if the field has none.
  [[nodiscard]] virtual std::optional<Enclosure> enclose(const Box<Dim>& /*box*/) const { return std::nullopt; }

  /// Evaluates any number of points on all threads.
  [[nodiscard]] Jet<Dim> evaluate(const PointsRef<Dim>& x, Derivatives derivatives = Derivatives::none) const;

  /// Values at points held as one std::array each.
  [[nodiscard]] std::vector<double> evaluate(
      std::span<const std::array<double, static_cast<std::size_t>(Dim)>> points) const {
    const Eigen::VectorXd value = evaluate(PointsRef<Dim>(as_points<Dim>(points))).value;
    return {value.begin(), value.end()};
  }

  /// Values at the nodes of a rectilinear grid, on all threads; equal to those of evaluate() up to rounding. Fastest if
  /// the coordinates ascend.
  [[nodiscard]] virtual Eigen::VectorXd evaluate_grid(const GridAxes<Dim>& axes) const;

  /// Value at one point.
  [[nodiscard]] double operator()(const Point<Dim>& p) const {
    double value = 0;
    evaluate_block(p, {&value, nullptr, nullptr});
    return value;
  }

  /// Points per call of evaluate_block() if they are in no particular order. Chosen by hand: larger blocks amortise the
  /// cost of a call, smaller ones stay in the cache and balance the load.
  static constexpr Index block_size = 512;

  /// The same for n points in their evaluation_order(). Larger, because what lies at the edge of a block is visited for
  /// several blocks, but small enough to keep all threads and processes busy: blocks of n / 256 points gain as much as
  /// those of n / 64.
  static constexpr Index ordered_block_size(Index n) { return std::clamp<Index>(n / 256, block_size, 16 * block_size); }

 private:
  [[nodiscard]] Jet<Dim> evaluate_in(const std::vector<Index>& order, const PointsRef<Dim>& x,
                                     Derivatives derivatives) const;
};

}  // namespace csrbf
