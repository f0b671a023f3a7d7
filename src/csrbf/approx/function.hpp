#pragma once

#include "csrbf/approx/fit.hpp"

#include <memory>
#include <string>
#include <vector>

namespace csrbf {

struct FunctionFit;

/// What a standard deviation is of: the difference of the function fitted to the true one, or to a sample of mean
/// weight, whose noise comes on top.
enum class DeviationOf { sample, function };

/// Where values are wanted: in the convex hull of the samples, or up to a distance from them.
struct Mask {
  bool hull = false;
  double distance = 0;  ///< largest one, on a sphere in degrees; 0: none
};

/// "hull" or "distance:D". Throws InvalidInput for other texts.
Mask mask_of(const std::string& text);

/// A fitted function whose dimension is known only at run time, as held by the program, model files and Python.
class Function {
 public:
  template <int Dim>
  explicit Function(Fit<Dim> fit);
  /// Of more variables than largest_dimension: a fit in most_variables dimensions, of samples with zeros for those that
  /// there are not. Throws InvalidInput unless they are fitted in `Dim` dimensions.
  template <int Dim>
  Function(Fit<Dim> fit, int variables);

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] Index components() const;
  [[nodiscard]] const FitReport& report() const;
  /// The fit. Throws InvalidInput when its dimension is another one.
  template <int Dim>
  [[nodiscard]] const Fit<Dim>& fit() const;
  /// The fit of any dimension.
  [[nodiscard]] const FunctionFit& any_fit() const { return *fit_; }

  /// Values and derivatives at m points: one row per point, component-major columns.
  struct Values {
    Eigen::MatrixXd value;     ///< m x k
    Eigen::MatrixXd gradient;  ///< m x (k d), or no columns
    Eigen::MatrixXd hessian;   ///< m x (k d (d + 1) / 2), upper triangles, or no columns
  };
  /// `x`: d x m. Throws InvalidInput when it has another number of rows. On all threads.
  [[nodiscard]] Values evaluate(const Eigen::Ref<const Eigen::MatrixXd>& x,
                                Derivatives derivatives = Derivatives::none) const;

  /// Values at the nodes of a rectilinear grid with these coordinates along the d axes, the first one fastest: nodes x
  /// k. Several times faster than evaluate() at the same nodes. Throws InvalidInput for another number of axes.
  [[nodiscard]] Eigen::MatrixXd evaluate_grid(const std::vector<Eigen::VectorXd>& axes) const;

  /// The same into `values`, k x nodes, some 1e6 nodes (a layer of the last axis at least) at a time. Floats are the
  /// doubles rounded. Throws InvalidInput for another number of axes or another size of `values`.
  void evaluate_grid(const std::vector<Eigen::VectorXd>& axes, Eigen::Ref<Eigen::MatrixXd> values,
                     const Progress& progress = {}) const;
  void evaluate_grid(const std::vector<Eigen::VectorXd>& axes, Eigen::Ref<Eigen::MatrixXf> values,
                     const Progress& progress = {}) const;

  /// Standard deviations at m points, m x k: from Fit::variances, without the noise those of the function. `x`: d x m.
  /// Throws InvalidInput when it has another number of rows and when the fit has none.
  [[nodiscard]] Eigen::MatrixXd standard_deviation(const Eigen::Ref<const Eigen::MatrixXd>& x,
                                                   DeviationOf of = DeviationOf::sample) const;

  /// Whether each of m points is where the mask wants values. `x`: d x m. The hull is for up to three coordinates, and
  /// neither for a sphere. Throws InvalidInput for other functions, for those with a drift, and for models that do not
  /// know their samples' places.
  [[nodiscard]] std::vector<bool> covered(const Eigen::Ref<const Eigen::MatrixXd>& x, const Mask& mask) const;

  /// The same function with other values outside the box of the samples. Throws InvalidInput where these belong to the
  /// fit: with a drift, or faults.
  [[nodiscard]] Function extrapolated(Extrapolation extrapolation) const;

  /// The box of the samples: d x 2, lower and upper corner.
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
  std::string crs =
      {};  ///< reference system of the coordinates on a map, such as "EPSG:32633"; empty: none, or unknown
};

/// fit() for points (d x n), values (n x k) and weights (n, or empty) of d <= most_variables variables. More than
/// largest_dimension of them are fitted by one system, of more than 4000 samples at up to 2000 of them, which takes
/// some seconds; what needs another method is refused. Throws InvalidInput.
Function fit_function(const Eigen::Ref<const Eigen::MatrixXd>& points, const Eigen::Ref<const Eigen::MatrixXd>& values,
                      const Eigen::Ref<const Eigen::VectorXd>& weights, const FitOptions& options = {});

}  // namespace csrbf
