#include "csrbf/approx/hermite/fit_with_derivatives.hpp"

#include "csrbf/approx/hermite/hermite_field.hpp"
#include "csrbf/approx/kriging/confirm_errors.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/samples/robust_weights.hpp"
#include "csrbf/approx/samples/usable_samples.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/seconds_since.hpp"
#include "csrbf/linalg/simplex_search.hpp"
#include "csrbf/spatial/chosen_points.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index one_system_rows = 3000;              // unknowns of one system
constexpr Index patch_rows = 100, block_rows = 240;  // ... of a patch, and of a block that the likelihood is of
constexpr Index most_blocks = 3;
constexpr double least_nugget = 1e-13, largest_nugget = 10;
constexpr double longest_axis = 20;  // lengths over extents of the samples
constexpr double longest = 50;       // of the kernel, in extents

template <int Dim>
class DerivativeFit {
  static constexpr Index rows_each = 1 + Dim;

 public:
  DerivativeFit(const Samples<Dim>& given, const FitOptions& options) : options_(options) { select(given); }

  Fit<Dim> fit() {
    const auto start = std::chrono::steady_clock::now();
    scale();
    choose();
    report_.choose_seconds = seconds_since(start);
    const auto solved = std::chrono::steady_clock::now();
    frame_.scales *= length_;
    x_ /= length_;
    auto data = std::make_shared<typename HermiteField<Dim>::Data>();
    data->kernel = HermiteKernel(kernel_);
    data->box = bounding_box<Dim>(x_);
    if (rows_each * n() <= one_system_rows)
      solve_at_once(*data);
    else
      solve_patches(*data);
    Fit<Dim> result;
    finish_report(*data);
    frame_.extrapolation = options_.extrapolation;
    if (data->cover && frame_.extrapolation == Extrapolation::trend) frame_.extrapolation = Extrapolation::linear;
    // One system knows the slopes at the outermost samples, and far from them all it is a constant.
    if (!data->cover && frame_.extrapolation == Extrapolation::automatic) frame_.extrapolation = Extrapolation::trend;
    auto frame = frame_;
    frame.rim.setZero();
    frame.extrapolation = data->cover ? Extrapolation::constant : Extrapolation::trend;
    for (Index c = 0; c < y_.cols(); ++c) {
      const std::shared_ptr<const typename HermiteField<Dim>::Data> shared = data;
      frame_.unit = 1;
      result.components.push_back(
          std::make_shared<FittedField<Dim>>(std::make_shared<HermiteField<Dim>>(shared, c, false), frame_));
      result.variances.push_back(
          std::make_shared<FittedField<Dim>>(std::make_shared<HermiteField<Dim>>(shared, c, true), frame));
    }
    report_.fit_seconds = seconds_since(solved);
    result.report = report_;
    return result;
  }

 private:
  [[nodiscard]] Index n() const { return x_.cols(); }
  [[nodiscard]] Index k() const { return y_.cols(); }

  // Samples that have values, without gross errors.
  void select(const Samples<Dim>& given) {
    auto [some, rows] = usable_samples<Dim>(given, options_.missing);
    report_.missing = options_.missing ? given.size() - std::ssize(rows) : 0;
    const bool interpolates = options_.smoothing && *options_.smoothing == 0;
    RobustWeights robust;
    if (!(options_.loss == "auto" && interpolates)) robust = robust_weights(some, options_.loss);
    confirm_errors(some, robust);
    std::vector<Index> kept;
    for (Index i = 0; i < some.size(); ++i)
      if (robust.factors.size() == 0 || robust.factors[i] > 0) kept.push_back(i);
    for (const Index row : robust.gross_errors) report_.gross_errors.push_back(rows[static_cast<std::size_t>(row)]);
    for (const Index row : robust.suspects) report_.suspects.push_back(rows[static_cast<std::size_t>(row)]);
    x_ = chosen_points<Dim>(some.points, kept);
    y_ = some.values(kept, Eigen::all);
    weights_ = some.all_weights()(kept);
    if (robust.factors.size() > 0) weights_.array() *= robust.factors(kept).array();
    weights_ /= weights_.mean();
    std::vector<Index> source;
    for (const Index i : kept) source.push_back(rows[static_cast<std::size_t>(i)]);
    slopes_ = options_.gradients(source, Eigen::all);
    frame_.box = bounding_box<Dim>(x_);
    if (options_.extrapolation == Extrapolation::automatic) frame_.rim = FittedField<Dim>::rim_of(x_);
    report_.samples = report_.samples_fitted = n();
  }

  [[nodiscard]] double slope(Index i, Index c, Index a) const { return slopes_(i, Dim * c + a); }

  // Axes in units over which values change by their deviation, values of deviation 1.
  void scale() {
    unit_ = Eigen::RowVectorXd::Ones(k());
    mean_ = y_.colwise().mean();
    for (Index c = 0; c < k(); ++c) {
      const double deviation =
          (y_.col(c).array() - mean_[c]).matrix().stableNorm() / std::sqrt(static_cast<double>(n()));
      if (deviation > 0) unit_[c] = deviation;
    }
    const Point<Dim> extent = frame_.box.extent();
    const double largest = std::max(extent.maxCoeff(), 1e-300);
    for (Index a = 0; a < Dim; ++a) {
      double squares = 0, count = 0;
      for (Index c = 0; c < k(); ++c)
        for (Index i = 0; i < n(); ++i)
          if (std::isfinite(slope(i, c, a))) {
            squares += std::pow(slope(i, c, a) / unit_[c], 2);
            ++count;
          }
      const double side = extent[a] > 0 ? extent[a] : largest;
      frame_.scales[a] = side;
      if (count > 0 && options_.scale_axes)
        frame_.scales[a] = std::min(longest_axis * side, std::sqrt(count / std::max(squares, 1e-300)));
    }
    if (!options_.scale_axes) frame_.scales.setConstant(largest);
    x_.array().colwise() /= frame_.scales.array();
    y_ = (y_.rowwise() - mean_) * unit_.cwiseInverse().asDiagonal();
    for (Index c = 0; c < k(); ++c)
      for (Index a = 0; a < Dim; ++a) slopes_.col(Dim * c + a) *= frame_.scales[a] / unit_[c];
  }

  // The samples `rows` as a system in lengths of the kernel; a derivative counts if it is known for all values.
  [[nodiscard]] HermiteSystem<Dim> system(const std::vector<Index>& rows, double length, double value_nugget,
                                          double slope_nugget) const {
    HermiteSystem<Dim> result;
    result.centers = chosen_points<Dim>(x_, rows) / length;
    result.nuggets.resize(std::ssize(rows), rows_each);
    for (Index i = 0; i < result.size(); ++i) {
      const Index row = rows[static_cast<std::size_t>(i)];
      result.nuggets(i, 0) = value_nugget / weights_[row];
      for (Index a = 0; a < Dim; ++a) {
        bool known = true;
        for (Index c = 0; c < k(); ++c) known = known && std::isfinite(slope(row, c, a));
        result.nuggets(i, 1 + a) = known ? slope_nugget / weights_[row] : std::numeric_limits<double>::infinity();
      }
    }
    return result;
  }

  // Values and derivatives in lengths of the kernel, row by row.
  [[nodiscard]] Eigen::MatrixXd right_side(const std::vector<Index>& rows, double length) const {
    Eigen::MatrixXd result(rows_each * std::ssize(rows), k());
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (Index c = 0; c < k(); ++c) {
        const Index first = rows_each * static_cast<Index>(i);
        result(first, c) = y_(rows[i], c);
        for (Index a = 0; a < Dim; ++a) result(first + 1 + a, c) = length * slope(rows[i], c, a);
      }
    return result;
  }

  struct Solved {
    Eigen::MatrixXd alpha;  // of the known rows
    Eigen::RowVectorXd mean, squares;
    double log_determinant = 0;
    double degrees = 0;
  };
  [[nodiscard]] Solved solve(const HermiteFactor<Dim>& factor, const Eigen::MatrixXd& right) const {
    Solved solved;
    Eigen::MatrixXd white = right(factor.known, Eigen::all);
    solve_lower(factor.llt, white);
    solved.mean = Eigen::RowVectorXd::Zero(k());
    solved.degrees = static_cast<double>(white.rows());
    solved.log_determinant = 2 * factor.llt.matrixLLT().diagonal().array().log().sum();
    if (factor.information > 0) {
      solved.mean = factor.trend.transpose() * white / factor.information;
      white -= factor.trend * solved.mean;
      solved.log_determinant += std::log(factor.information);
      solved.degrees -= 1;
    }
    solved.squares = white.colwise().squaredNorm();
    solve_upper(factor.llt, white);
    solved.alpha = std::move(white);
    return solved;
  }

  // Kernel, length and nuggets of largest restricted likelihood for some blocks of neighbours.
  void choose() {
    const std::vector<Index> order = morton_order<Dim>(x_);
    const Index each = std::min(n(), block_rows / rows_each), blocks = std::min(most_blocks, n() / each);
    std::vector<std::vector<Index>> rows;
    for (Index b = 0; b < blocks; ++b) {
      const auto first = order.begin() + (blocks > 1 ? b * (n() - each) / (blocks - 1) : 0);
      rows.emplace_back(first, first + each);
    }
    const double reach = std::max(bounding_box<Dim>(x_).extent().maxCoeff(), 1e-300);
    const auto fixed = options_.smoothing;
    const auto nugget = [&](double logarithm) {
      return fixed ? std::max(*fixed, least_nugget) : std::max(std::exp(logarithm), least_nugget);
    };
    const auto cost = [&](const HermiteKernel& kernel, const Eigen::VectorXd& p) {
      const double length = std::exp(p[0]);
      if (length > longest * reach || nugget(p[1]) > largest_nugget || nugget(p[2]) > largest_nugget)
        return std::numeric_limits<double>::infinity();
      double sum = 0, degrees = 0;
      Eigen::RowVectorXd squares = Eigen::RowVectorXd::Zero(k());
      for (const auto& block : rows) {
        const HermiteFactor<Dim> factor(kernel, system(block, length, nugget(p[1]), nugget(p[2])));
        const Solved solved = solve(factor, right_side(block, length));
        // Derivatives are in lengths of the kernel: back in one unit for all lengths.
        const double slopes = static_cast<double>(factor.known.size()) - static_cast<double>(block.size());
        sum += static_cast<double>(k()) * (solved.log_determinant - 2 * slopes * p[0]);
        squares += solved.squares;
        degrees += solved.degrees;
      }
      for (const double s : squares) sum += degrees * std::log(std::max(s, 1e-300) / degrees);
      return sum;
    };
    std::vector<std::string> kernels = HermiteKernel::names();
    if (options_.kernel != "auto") kernels = {HermiteKernel(options_.kernel).name()};
    double best = std::numeric_limits<double>::infinity();
    Eigen::VectorXd start = Eigen::Vector3d(std::log(2.0), std::log(1e-6), std::log(1e-6));
    for (const std::string& name : kernels) {
      const HermiteKernel kernel(name);
      const SimplexMinimum found = simplex_search([&](const Eigen::VectorXd& p) { return cost(kernel, p); }, start,
                                                  Eigen::Vector3d(1, -8, -8), {.evaluations = 50, .tolerance = 0.1});
      start = found.x;
      if (!(found.value < best)) continue;
      best = found.value;
      kernel_ = name;
      length_ = std::exp(found.x[0]);
      value_nugget_ = nugget(found.x[1]);
      slope_nugget_ = nugget(found.x[2]);
    }
    require(best < std::numeric_limits<double>::infinity(), "fit", "derivatives", n(),
            "no covariance describes values and derivatives; are they in the units of values and coordinates?");
    report_.kernel = kernel_;
    report_.smoothing = value_nugget_ > 2 * least_nugget ? value_nugget_ : 0;
  }

  typename HermiteField<Dim>::Patch patch_of(const HermiteSystem<Dim>& system, const HermiteFactor<Dim>& factor,
                                             const Solved& solved) const {
    typename HermiteField<Dim>::Patch patch;
    patch.centers = system.centers;
    patch.coefficients = Eigen::MatrixXd::Zero(rows_each * system.size(), k());
    patch.coefficients(factor.known, Eigen::all) = solved.alpha * unit_.asDiagonal();
    patch.mean = (solved.mean.cwiseProduct(unit_) + mean_).transpose();
    return patch;
  }

  // Of values left out: mean square of their errors, and sigma^2, by component, that these follow from.
  struct LeftOut {
    double mean_square = 0;
    Eigen::VectorXd sigma2;
  };
  LeftOut left_out(const HermiteFactor<Dim>& factor, const Solved& solved) const {
    const Eigen::MatrixXd inverse = factor.llt.solve(Eigen::MatrixXd::Identity(factor.llt.rows(), factor.llt.rows()));
    LeftOut result{0, Eigen::VectorXd::Zero(k())};
    double count = 0;
    for (std::size_t j = 0; j < factor.known.size(); ++j) {
      if (factor.known[j] % rows_each != 0) continue;
      const auto row = static_cast<Index>(j);
      const Eigen::VectorXd square = solved.alpha.row(row).cwiseProduct(unit_).cwiseAbs2() / inverse(row, row);
      result.sigma2 += square;
      result.mean_square += square.mean() / inverse(row, row);
      ++count;
    }
    if (count > 0) result.mean_square /= count;
    if (count > 0) result.sigma2 /= count;
    return result;
  }

  void solve_at_once(typename HermiteField<Dim>::Data& data) {
    std::vector<Index> rows(static_cast<std::size_t>(n()));
    for (Index i = 0; i < n(); ++i) rows[static_cast<std::size_t>(i)] = i;
    const HermiteSystem<Dim> all = system(rows, 1, value_nugget_, slope_nugget_);
    Eigen::MatrixXd right = right_side(rows, length_);
    const HermiteFactor<Dim> factor(data.kernel, all);
    const Solved solved = solve(factor, right);
    data.patches.push_back(patch_of(all, factor, solved));
    data.sigma2 = (solved.squares / std::max(1.0, solved.degrees)).cwiseProduct(unit_.cwiseAbs2()).transpose();
    data.noise = value_nugget_ > 2 * least_nugget ? value_nugget_ : 0;
    const LeftOut errors = left_out(factor, solved);
    // Derivatives that fit exactly make all rows together say less of the noise than there is.
    if (data.noise > 0) data.sigma2 = data.sigma2.cwiseMax(errors.sigma2);
    data.patches.front().variance = data.sigma2;
    report_.cross_validation_rmse = std::sqrt(errors.mean_square);
    for (const double s : data.sigma2) report_.noise.push_back(std::sqrt(s * data.noise));
    data.system = all;
    report_.centers = n();
  }

  void solve_patches(typename HermiteField<Dim>::Data& data) {
    const Index each = std::max<Index>(2 * rows_each, patch_rows / rows_each);
    const double share = 1.25 * std::pow(cover_growth<Dim>, Dim) * 0.72;  // as in fit_patches
    data.cover.emplace(x_, std::max<Index>(1, static_cast<Index>(static_cast<double>(each) / share)),
                       cover_growth<Dim>);
    const Cover<Dim>& cover = *data.cover;
    data.patches.resize(static_cast<std::size_t>(cover.size()));
    Eigen::VectorXd squares(cover.size());
    const double noise = value_nugget_ > 2 * least_nugget ? value_nugget_ : 0;
    parallel_for(cover.size(), 8, [&](Index begin, Index end) {
      typename Cover<Dim>::Search search;
      for (Index cell = begin; cell < end; ++cell) {
        cover.nearest(cover.cell(cell).center(), std::min(each, n()), cover.cell(cell).diagonal(), search);
        std::vector<Index> rows;
        for (const auto& [d2, column] : search.found) rows.push_back(cover.order()[column]);
        const HermiteSystem<Dim> here = system(rows, 1, value_nugget_, slope_nugget_);
        const HermiteFactor<Dim> factor(data.kernel, here);
        const Solved solved = solve(factor, right_side(rows, length_));
        auto& patch = data.patches[static_cast<std::size_t>(cell)];
        patch = patch_of(here, factor, solved);
        squares[cell] = left_out(factor, solved).mean_square;
        // The variance in the middle and at two corners stands for that about the patch.
        const Box<Dim>& box = cover.cell(cell);
        double unexplained = 0;
        for (const Point<Dim>& at : {box.lo, box.hi, box.center()})
          unexplained += factor.variance(data.kernel, here, at) / 3;
        patch.variance =
            ((unexplained + noise) / std::max(1.0, solved.degrees) * solved.squares.cwiseProduct(unit_.cwiseAbs2()))
                .transpose();
      }
    });
    report_.cross_validation_rmse = std::sqrt(squares.mean());
    report_.centers = cover.size() * each;
    report_.partition = {cover.size(), each, 0};
  }

  void finish_report(const typename HermiteField<Dim>::Data& data) {
    report_.method = data.cover ? "partition-of-unity" : "interpolate";
    report_.support = 1;
    report_.degree = 0;
    report_.axis_scales.assign(frame_.scales.data(), frame_.scales.data() + Dim);
  }

  const FitOptions& options_;
  FitReport report_;
  typename FittedField<Dim>::Frame frame_;
  Points<Dim> x_;
  Eigen::MatrixXd y_, slopes_;
  Eigen::VectorXd weights_;
  Eigen::RowVectorXd mean_, unit_;
  std::string kernel_;
  double length_ = 1, value_nugget_ = 0, slope_nugget_ = 0;
};

}  // namespace

template <int Dim>
Fit<Dim> fit_with_derivatives(const Samples<Dim>& samples, const FitOptions& options) {
  require(options.gradients.rows() == samples.size() && options.gradients.cols() == Dim * samples.components(), "fit",
          "gradients", options.gradients.cols(),
          "there must be one row per sample, and for every value one derivative by each coordinate");
  const auto refuse = [](bool given, const char* option) {
    require(!given, "fit", option, "given", "this cannot be combined with derivatives; leave one of both out");
  };
  refuse(!options.sphere.empty(), "sphere");
  refuse(!options.drift.empty(), "drift");
  refuse(!options.faults.empty(), "faults");
  refuse(!options.periods.empty(), "periods");
  refuse(options.tolerance > 0, "tolerance");
  refuse(options.centers > 0, "centers");
  refuse(options.method != "auto", "method");
  return DerivativeFit<Dim>(samples, options).fit();
}

#define CSRBF_INSTANTIATE(Dim) template Fit<Dim> fit_with_derivatives<Dim>(const Samples<Dim>&, const FitOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
