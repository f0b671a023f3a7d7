#pragma once

#include "csrbf/approx/fit.hpp"

#include <memory>
#include <string>
#include <vector>

namespace csrbf {

struct FunctionFit;

/// What the standard deviation is of: the error of the fitted function, or the difference between it and a new sample
/// of mean weight, which includes the noise of the sample.
enum class DeviationOf { sample, function };

/// Where values are wanted: in the convex hull of the samples, or up to a distance from them.
struct Mask {
  bool hull = false;
  double distance = 0;  ///< in the unit of the coordinates, on a sphere in degrees; 0: no limit
};

/// "hull" or "distance:D". Throws InvalidInput for other texts.
Mask mask_of(const std::string& text);

/// A fitted function whose dimension is known only at run time. The program, model files and Python use it.
class Function {
 public:
  template <int Dim>
  explicit Function(Fit<Dim> fit);
  /// For more variables than largest_dimension: a fit in most_variables dimensions, with zeros for the missing ones.
  /// Throws InvalidInput unless functions of so many `variables` are fitted in `Dim` dimensions.
  template <int Dim>
  Function(Fit<Dim> fit, int variables);

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] Index components() const;
  [[nodiscard]] const FitReport& report() const;
  /// The fit. Throws InvalidInput if its dimension is not Dim.
  template <int Dim>
  [[nodiscard]] const Fit<Dim>& fit() const;
  /// The fit, whatever its dimension.
  [[nodiscard]] const FunctionFit& any_fit() const { return *fit_; }

  /// Values and derivatives at m points: one row per point, component-major columns.
  struct Values {
    Eigen::MatrixXd value;     ///< m x k
    Eigen::MatrixXd gradient;  ///< m x (k d), or no columns
    Eigen::MatrixXd hessian;   ///< m x (k d (d + 1) / 2), upper triangles, or no columns
  };
  /// `x`: d x m. Throws InvalidInput if the number of rows is not d. Uses all threads.
  [[nodiscard]] Values evaluate(const Eigen::Ref<const Eigen::MatrixXd>& x,
                                Derivatives derivatives = Derivatives::none) const;

  /// Values (nodes x k) at the nodes of a rectilinear grid with these coordinates along the d axes, the first axis
  /// fastest. Several times faster than evaluate() at the same nodes. Throws InvalidInput if the number of axes is not
  /// d.
  [[nodiscard]] Eigen::MatrixXd evaluate_grid(const std::vector<Eigen::VectorXd>& axes) const;

  /// The same, written to `values` (k x nodes) some 1e6 nodes at a time, but at least one layer of the last axis.
  /// Floats are the rounded doubles. Throws InvalidInput for a wrong number of axes or a wrong size of `values`.
  void evaluate_grid(const std::vector<Eigen::VectorXd>& axes, Eigen::Ref<Eigen::MatrixXd> values,
                     const Progress& progress = {}) const;
  void evaluate_grid(const std::vector<Eigen::VectorXd>& axes, Eigen::Ref<Eigen::MatrixXf> values,
                     const Progress& progress = {}) const;

  /// Standard deviations at m points, m x k, see Fit::variances. `x`: d x m. Throws InvalidInput if the number of rows
  /// is not d, and if the fit has none, for DeviationOf::function also if the noise is unknown.
  [[nodiscard]] Eigen::MatrixXd standard_deviation(const Eigen::Ref<const Eigen::MatrixXd>& x,
                                                   DeviationOf of = DeviationOf::sample) const;

  /// Whether each of m points is where the mask wants values. `x`: d x m. The hull is for up to three coordinates, not
  /// on a sphere. Throws InvalidInput for other functions, for those with a drift, and for older models, which do not
  /// hold the points of their samples.
  [[nodiscard]] std::vector<bool> covered(const Eigen::Ref<const Eigen::MatrixXd>& x, const Mask& mask) const;

  /// The same function with other values outside the box of the samples. Throws InvalidInput for
  /// Extrapolation::automatic, and for functions with a drift or faults.
  [[nodiscard]] Function extrapolated(Extrapolation extrapolation) const;

  /// The bounding box of the samples: d x 2, lower and upper corner.
  [[nodiscard]] Eigen::MatrixXd bounds() const;

 private:
  int dimension_;
  std::shared_ptr<const FunctionFit> fit_;
};

/// A fitted function and the column names of its samples.
struct NamedFunction {
  Function function;
  std::vector<std::string> coordinate_names = {};  ///< empty: x y z, or x1 x2 ... from four on
  std::vector<std::string> value_names = {};       ///< empty: value, or value1 value2 ...
  /// Coordinate reference system, such as "EPSG:32633"; empty: none, or unknown.
  std::string crs = {};
};

/// fit() for points (d x n), values (n x k) and weights (n, or empty) of up to most_variables variables. More than
/// largest_dimension variables are fitted by one system; for more than 4000 samples it has up to 2000 of them and takes
/// some seconds. Options that need another method are refused then. Throws InvalidInput, and as fit().
Function fit_function(const Eigen::Ref<const Eigen::MatrixXd>& points, const Eigen::Ref<const Eigen::MatrixXd>& values,
                      const Eigen::Ref<const Eigen::VectorXd>& weights, const FitOptions& options = {});

}  // namespace csrbf
