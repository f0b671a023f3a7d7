#include "csrbf/approx/partition_of_unity.hpp"

#include "csrbf/approx/choose_local_options.hpp"
#include "csrbf/approx/lane_sums.hpp"
#include "csrbf/core/dimensions.hpp"
#include "csrbf/core/parallel.hpp"

#include <array>
#include <cmath>
#include <numeric>

namespace csrbf {
namespace {

constexpr int lanes = batch_lanes;

// Sums over the supports at eight points of one cell.
template <int Dim>
struct Sums {
  static constexpr int terms = LocalEvaluator<Dim>::terms;
  double W[terms][lanes], S[terms][lanes];

  void clear(int wanted) {
    for (int t = 0; t < wanted; ++t)
      for (int l = 0; l < lanes; ++l) W[t][l] = S[t][l] = 0;
  }

  // W += w, S += w f, with the derivatives of the product.
  void add(const double (*w)[lanes], const double (*f)[lanes], Derivatives derivatives) {
    for (int l = 0; l < lanes; ++l) {
      W[0][l] += w[0][l];
      S[0][l] += w[0][l] * f[0][l];
    }
    if (derivatives == Derivatives::none) return;
    for (int a = 1; a <= Dim; ++a)
      for (int l = 0; l < lanes; ++l) {
        W[a][l] += w[a][l];
        S[a][l] += w[a][l] * f[0][l] + w[0][l] * f[a][l];
      }
    if (derivatives == Derivatives::gradient) return;
    for (int a = 1, t = 1 + Dim; a <= Dim; ++a)
      for (int b = a; b <= Dim; ++b, ++t)
        for (int l = 0; l < lanes; ++l) {
          W[t][l] += w[t][l];
          S[t][l] += w[t][l] * f[0][l] + w[a][l] * f[b][l] + w[b][l] * f[a][l] + w[0][l] * f[t][l];
        }
  }

  // f = S / W of one lane (thesis appendix C, corrected: the Hessian is symmetric).
  void store(int lane, Index i, const JetBlock& out) const {
    const double inverse = 1 / W[0][lane], f = S[0][lane] * inverse;
    out.value[i] = f;
    if (out.gradient == nullptr) return;
    std::array<double, Dim> g;
    for (int a = 0; a < Dim; ++a)
      out.gradient[Dim * i + a] = g[static_cast<std::size_t>(a)] = (S[1 + a][lane] - f * W[1 + a][lane]) * inverse;
    if (out.hessian == nullptr) return;
    for (int a = 0, t = 1 + Dim; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++t)
        out.hessian[symmetric_size<Dim> * i + t - 1 - Dim] =
            (S[t][lane] - f * W[t][lane] - g[static_cast<std::size_t>(a)] * W[1 + b][lane] -
             g[static_cast<std::size_t>(b)] * W[1 + a][lane]) *
            inverse;
  }
};

// Evaluates groups of points of one cell.
template <int Dim>
class Evaluation {
 public:
  Evaluation(const typename PartitionOfUnity<Dim>::Data& data, Index component, const JetBlock& out)
      : data_(data), component_(component), out_(out), evaluator_(data.models) {}

  // Points [begin, end) of `order`, all in `cell`.
  void evaluate(Index cell, const PointsRef<Dim>& x, const std::pair<Index, Index>* order, Index count) {
    const Derivatives derivatives = out_.derivatives();
    const int wanted = derivatives == Derivatives::none       ? 1
                       : derivatives == Derivatives::gradient ? 1 + Dim
                                                              : Sums<Dim>::terms;
    const Box<Dim>& box = data_.cover.box();
    for (Index first = 0; first < count; first += lanes) {
      const Index used = std::min<Index>(lanes, count - first);
      for (int l = 0; l < lanes; ++l) {
        const Index column = order[first + std::min<Index>(l, used - 1)].second;
        for (int a = 0; a < Dim; ++a) x_[lanes * a + l] = std::clamp(x(a, column), box.lo[a], box.hi[a]);
      }
      sums_.clear(wanted);
      for (const std::uint32_t i : data_.cover.supports_over(cell)) {
        const Point<Dim> center = data_.cover.cell(i).center(),
                         half = 0.5 * data_.cover.growth() * data_.cover.cell(i).extent();
        if (!lane_sums::box_weights(x_, Dim, center.data(), half.data(), wanted, w_[0])) continue;
        evaluator_.evaluate(i, component_, x_, derivatives, f_);
        sums_.add(w_, f_, derivatives);
      }
      for (int l = 0; l < used; ++l) store(l, x, order[first + l].second);
    }
  }

 private:
  void store(int lane, const PointsRef<Dim>& x, Index column) {
    sums_.store(lane, column, out_);
    if (out_.gradient == nullptr) return;
    const Box<Dim>& box = data_.cover.box();
    for (int a = 0; a < Dim; ++a) {  // constant beyond the box
      if (x(a, column) >= box.lo[a] && x(a, column) <= box.hi[a]) continue;
      out_.gradient[Dim * column + a] = 0;
      if (out_.hessian == nullptr) continue;
      for (int b = 0, t = 0; b < Dim; ++b)
        for (int c = b; c < Dim; ++c, ++t)
          if (b == a || c == a) out_.hessian[symmetric_size<Dim> * column + t] = 0;
    }
  }

  const typename PartitionOfUnity<Dim>::Data& data_;
  Index component_;
  JetBlock out_;
  LocalEvaluator<Dim> evaluator_;
  alignas(64) double x_[Dim * lanes];
  alignas(64) double w_[Sums<Dim>::terms][lanes];
  alignas(64) double f_[Sums<Dim>::terms][lanes];
  Sums<Dim> sums_;
};

// Numbers parts of a cell along a Morton curve, so that points near each other get the same number or the next.
template <int Dim>
struct Parts {
  static constexpr int bits = Dim <= 2 ? 2 : 1;  // per axis
  static constexpr std::uint32_t count = 1U << (bits * Dim);

  static std::uint32_t number(const Box<Dim>& cell, const Point<Dim>& x) {
    std::uint32_t code = 0;
    for (int a = 0; a < Dim; ++a) {
      const double t = (x[a] - cell.lo[a]) / (cell.hi[a] - cell.lo[a]) * (1 << bits);
      const auto part = t > 0 ? static_cast<std::uint32_t>(std::min(t, (1 << bits) - 0.5)) : 0U;  // 0 also for NaN
      for (int bit = 0; bit < bits; ++bit) code |= (part >> bit & 1U) << (Dim * bit + a);
    }
    return code;
  }
};

template <int Dim>
void check(const PartitionOfUnityOptions& options) {
  constexpr const char* function = "partition_of_unity";
  if (options.kernel)
    require(Kernel(*options.kernel, Dim).order() == 0, function, "kernel", *options.kernel,
            "is only conditionally positive definite; use another one, such as wendland-c4");
  const int degree = options.degree.value_or(0);
  require(degree >= -1 && degree <= 8, function, "degree", degree, "must be -1 (none), 0, ... or 8");
  const Index samples = options.samples_per_patch.value_or(1), centers = options.centers_per_patch.value_or(0);
  require(samples >= 1, function, "samples_per_patch", samples, "must be at least 1");
  require(centers >= 0, function, "centers_per_patch", centers, "must not be negative");
  const double smoothing = options.smoothing.value_or(0);
  require(smoothing >= 0 && std::isfinite(smoothing), function, "smoothing", smoothing, "must not be negative");
}

}  // namespace

template <int Dim>
void PartitionOfUnity<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const Cover<Dim>& cover = data_->cover;
  std::vector<std::pair<Index, Index>> order(static_cast<std::size_t>(x.cols()));  // cell, point
  Index cell = -1;
  for (Index i = 0; i < x.cols(); ++i) {
    if (cell < 0 || !cover.cell(cell).contains(x.col(i))) cell = cover.find(x.col(i));
    order[static_cast<std::size_t>(i)] = {cell, i};
  }
  std::sort(order.begin(), order.end());
  Evaluation<Dim> evaluation(*data_, component_, out);
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && order[end].first == order[begin].first) ++end;
    evaluation.evaluate(order[begin].first, x, order.data() + begin, static_cast<Index>(end - begin));
  }
  for (Index i = 0; i < x.cols(); ++i)
    if (!x.col(i).allFinite()) out.value[i] = std::numeric_limits<double>::quiet_NaN();
}

template <int Dim>
std::vector<Index> PartitionOfUnity<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  const Cover<Dim>& cover = data_->cover;
  std::vector<std::uint32_t> part(static_cast<std::size_t>(x.cols()));  // of a cell
  parallel_for(x.cols(), 4096, [&](Index begin, Index end) {
    Index current = -1;
    for (Index i = begin; i < end; ++i) {
      if (current < 0 || !cover.cell(current).contains(x.col(i))) current = cover.find(x.col(i));
      part[static_cast<std::size_t>(i)] =
          Parts<Dim>::count * static_cast<std::uint32_t>(current) + Parts<Dim>::number(cover.cell(current), x.col(i));
    }
  });
  std::vector<std::uint32_t> begin(static_cast<std::size_t>(cover.size()) * Parts<Dim>::count + 1, 0);
  for (const std::uint32_t p : part) ++begin[p + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Index> order(part.size());
  for (std::size_t i = 0; i < part.size(); ++i) order[begin[part[i]]++] = static_cast<Index>(i);
  return order;
}

template <int Dim>
double PartitionOfUnity<Dim>::detail() const {
  return data_->models.radius.minCoeff();
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> PartitionOfUnityFit<Dim>::fields() const {
  std::vector<std::shared_ptr<const Field<Dim>>> result;
  for (Index c = 0; c < data->models.components; ++c)
    result.push_back(std::make_shared<PartitionOfUnity<Dim>>(data, c));
  return result;
}

template <int Dim>
PartitionOfUnityFit<Dim> partition_of_unity(const Samples<Dim>& given, const PartitionOfUnityOptions& options) {
  require_valid(given, "partition_of_unity");
  check<Dim>(options);
  report(options.progress, "fit", 0);
  const Samples<Dim> normalized = given.weights.size() == 0 ? Samples<Dim>{} : normalize_weights(given);
  const Samples<Dim>& samples = given.weights.size() == 0 ? given : normalized;
  PartitionOfUnityFit<Dim> result;
  ChosenLocalOptions chosen = choose_local_options(samples, options);
  result.report.local = chosen.options;
  result.report.cross_validation_rmse = chosen.rmse;

  // Cells hold about .72 of their leaf size, supports growth^Dim times that, and the ball of the samples is a little
  // larger than the support.
  const double share = 1.25 * std::pow(cover_growth<Dim>, Dim) * 0.72;
  const auto leaf = std::max<Index>(1, static_cast<Index>(static_cast<double>(chosen.options.samples) / share));
  auto data = std::make_shared<typename PartitionOfUnity<Dim>::Data>(
      typename PartitionOfUnity<Dim>::Data{Cover<Dim>(samples.points, leaf, cover_growth<Dim>), {}});
  const Cover<Dim>& cover = data->cover;
  Eigen::MatrixXd values(samples.size(), samples.components());
  Eigen::VectorXd sample_weights(samples.weights.size());
  for (Index i = 0; i < samples.size(); ++i) {
    const Index from = cover.order()[static_cast<std::size_t>(i)];
    values.row(i) = samples.values.row(from);
    if (sample_weights.size() > 0) sample_weights[i] = samples.weights[from];
  }
  data->models = LocalFitter<Dim>(cover, values, sample_weights, chosen.options).models();
  data->models.resize(cover.size());
  const Index batches = (cover.size() + lanes - 1) / lanes, slice = std::max<Index>(1, batches / 16);
  for (Index done = 0; done < batches; done += slice) {
    report(options.progress, "fit", static_cast<double>(done) / static_cast<double>(batches));
    parallel_for(std::min(slice, batches - done), 8, [&](Index begin, Index end) {
      LocalFitter<Dim> fitter(cover, values, sample_weights, chosen.options);
      for (Index b = done + begin; b < done + end; ++b) {
        std::array<Index, lanes> cells;
        const auto count = static_cast<int>(std::min<Index>(lanes, cover.size() - lanes * b));
        std::iota(cells.begin(), cells.end(), lanes * b);
        fitter.fit(cells.data(), count, data->models, lanes * b);
      }
    });
  }
  result.report.patches = cover.size();
  result.report.centers = cover.size() * data->models.centers_each;
  result.data = std::move(data);
  report(options.progress, "fit", 1);
  return result;
}

#define CSRBF_INSTANTIATE(Dim)              \
  template class PartitionOfUnity<Dim>;     \
  template struct PartitionOfUnityFit<Dim>; \
  template PartitionOfUnityFit<Dim> partition_of_unity<Dim>(const Samples<Dim>&, const PartitionOfUnityOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
