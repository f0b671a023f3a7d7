#include "csrbf/approx/unity/partition_of_unity.hpp"

#include "csrbf/approx/unity/choose_local_options.hpp"
#include "csrbf/approx/unity/fit_patches.hpp"
#include "csrbf/approx/unity/lane_sums.hpp"
#include "csrbf/linalg/batched_cholesky.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/radix_sort.hpp"

#include <array>
#include <cmath>

namespace csrbf {
namespace {

// Values, or values and derivatives, of products and quotients: the terms of a jet are value, gradient, upper triangle
// of the Hessian.
template <int Dim>
constexpr int terms = LocalEvaluator<Dim>::terms;

// W += w, S += w f for the jets of one point; those of w and f are `lanes` apart.
template <int Dim>
void add_product(const double* w, const double* f, Derivatives derivatives, double* W, double* S) {
  const auto at = [](const double* jet, int term) { return jet[batch_lanes * term]; };
  W[0] += at(w, 0);
  S[0] += at(w, 0) * at(f, 0);
  if (derivatives == Derivatives::none) return;
  for (int a = 1; a <= Dim; ++a) {
    W[a] += at(w, a);
    S[a] += at(w, a) * at(f, 0) + at(w, 0) * at(f, a);
  }
  if (derivatives == Derivatives::gradient) return;
  for (int a = 1, t = 1 + Dim; a <= Dim; ++a)
    for (int b = a; b <= Dim; ++b, ++t) {
      W[t] += at(w, t);
      S[t] += at(w, t) * at(f, 0) + at(w, a) * at(f, b) + at(w, b) * at(f, a) + at(w, 0) * at(f, t);
    }
}

// f = S / W (thesis appendix C, corrected: the Hessian is symmetric). Outside the box, f is constant along the axes
// that are `outside`.
template <int Dim>
void store_quotient(const double* W, const double* S, const std::array<bool, Dim>& outside, Index i,
                    const JetBlock& out) {
  const double inverse = 1 / W[0], f = S[0] * inverse;
  out.value[i] = f;
  if (out.gradient == nullptr) return;
  std::array<double, Dim> g;
  for (std::size_t a = 0; a < Dim; ++a) {
    g[a] = (S[1 + a] - f * W[1 + a]) * inverse;
    out.gradient[Dim * i + static_cast<Index>(a)] = outside[a] ? 0 : g[a];
  }
  if (out.hessian == nullptr) return;
  double* h = out.hessian + symmetric_size<Dim> * i;
  for (std::size_t a = 0, t = 1 + Dim; a < Dim; ++a)
    for (std::size_t b = a; b < Dim; ++b, ++t)
      *h++ = outside[a] || outside[b] ? 0 : (S[t] - f * W[t] - g[a] * W[1 + b] - g[b] * W[1 + a]) * inverse;
}

// Evaluates a block of points support by support, so that all lanes are in use.
template <int Dim>
class Evaluation {
 public:
  Evaluation(const typename PartitionOfUnity<Dim>::Data& data, Index component, const JetBlock& out)
      : data_(data), component_(component), out_(out), evaluator_(data) {}

  void evaluate(const PointsRef<Dim>& x) {
    sort_by_cell(x);
    const auto n = static_cast<std::size_t>(x.cols()), size = static_cast<std::size_t>(wanted_);
    W_.assign(n * size, 0.0);
    S_.assign(n * size, 0.0);
    inside_.resize(n + batch_lanes);
    for (std::size_t begin = 0, end = 0; begin < visits_.size(); begin = end) {
      while (end < visits_.size() && visits_[end].key == visits_[begin].key) ++end;
      add_support(begin, end);
    }
    for (std::size_t k = 0; k < n; ++k) {
      const Index i = order_[k].index;
      std::array<bool, Dim> outside;
      for (std::size_t a = 0; a < Dim; ++a) outside[a] = x_[stride() * a + k] != x(static_cast<Index>(a), i);
      store_quotient<Dim>(W_.data() + size * k, S_.data() + size * k, outside, i, out_);
    }
  }

 private:
  void sort_by_cell(const PointsRef<Dim>& x) {
    const Cover<Dim>& cover = data_.cover;
    const auto n = static_cast<std::size_t>(x.cols());
    order_.resize(n);
    std::uint32_t cell = 0;
    for (Index i = 0; i < x.cols(); ++i) {
      if (!cover.cell(cell).contains(x.col(i))) cell = static_cast<std::uint32_t>(cover.find(x.col(i)));
      order_[i] = {cell, static_cast<std::uint32_t>(i)};
    }
    radix_sort(order_, static_cast<std::uint32_t>(cover.size()));
    x_.resize(Dim * (n + batch_lanes));
    for (std::size_t a = 0; a < Dim; ++a) {
      const auto axis = static_cast<Index>(a);
      const double lo = cover.box().lo[axis], hi = cover.box().hi[axis];
      for (std::size_t k = 0; k < n; ++k) x_[stride() * a + k] = std::clamp(x(axis, order_[k].index), lo, hi);
      std::fill_n(x_.data() + stride() * a + n, batch_lanes, lo);
    }
    runs_.clear();
    visits_.clear();
    for (std::uint32_t begin = 0, end = 0; begin < n; begin = end) {
      while (end < n && order_[end].key == order_[begin].key) ++end;
      for (const std::uint32_t support : cover.supports_over(order_[begin].key))
        visits_.push_back({support, static_cast<std::uint32_t>(runs_.size())});
      runs_.push_back({begin, end});
    }
    radix_sort(visits_, static_cast<std::uint32_t>(cover.size()));
  }

  // All visits to one support.
  void add_support(std::size_t first, std::size_t last) {
    const std::uint32_t support = visits_[first].key;
    const Box<Dim>& cell = data_.cover.cell(support);
    const Point<Dim> center = cell.center(), half = 0.5 * data_.cover.growth() * cell.extent();
    std::size_t count = 0;
    for (std::size_t v = first; v < last; ++v) {
      const auto [begin, end] = runs_[visits_[v].index];
      count +=
          lane_sums::inside(x_.data(), stride(), Dim, begin, end, center.data(), half.data(), inside_.data() + count);
    }
    for (std::size_t begin = 0; begin < count; begin += batch_lanes) {
      const std::size_t used = std::min<std::size_t>(batch_lanes, count - begin);
      for (std::size_t l = 0; l < batch_lanes; ++l) {
        const std::uint32_t k = inside_[begin + std::min(l, used - 1)];
        for (std::size_t a = 0; a < Dim; ++a) lane_x_[batch_lanes * a + l] = x_[stride() * a + k];
      }
      lane_sums::box_weights(lane_x_, Dim, center.data(), half.data(), wanted_, w_[0]);
      evaluator_.evaluate(support, component_, lane_x_, derivatives_, f_);
      for (std::size_t l = 0; l < used; ++l) {
        const std::size_t at = static_cast<std::size_t>(wanted_) * inside_[begin + l];
        add_product<Dim>(w_[0] + l, f_[0] + l, derivatives_, W_.data() + at, S_.data() + at);
      }
    }
  }

  // From one coordinate to the next: lanes may read beyond the last point.
  [[nodiscard]] std::size_t stride() const { return order_.size() + batch_lanes; }

  struct Run {
    std::uint32_t begin, end;
  };

  const typename PartitionOfUnity<Dim>::Data& data_;
  Index component_;
  JetBlock out_;
  Derivatives derivatives_ = out_.derivatives();
  int wanted_ = derivatives_ == Derivatives::none ? 1 : derivatives_ == Derivatives::gradient ? 1 + Dim : terms<Dim>;
  SupportEvaluator<Dim> evaluator_;
  std::vector<Keyed> order_;           // points by cell
  std::vector<Run> runs_;              // of points in the same cell
  std::vector<Keyed> visits_;          // runs, by the supports that reach into their cells
  std::vector<double> x_;              // by coordinate, in order, moved into the box
  std::vector<double> W_, S_;          // sums of the weights and of the weighted functions, point by point
  std::vector<std::uint32_t> inside_;  // points of a support
  alignas(64) double lane_x_[Dim * batch_lanes];
  alignas(64) double w_[terms<Dim>][batch_lanes];
  alignas(64) double f_[terms<Dim>][batch_lanes];
};

template <int Dim>
void check(const PartitionOfUnityOptions& options) {
  constexpr const char* function = "partition_of_unity";
  if (options.kernel)
    require(Kernel(*options.kernel, Dim).order() == 0, function, "kernel", *options.kernel,
            "is only conditionally positive definite; use another one, such as wendland-c4");
  if (const auto degree = options.degree)
    require(*degree >= -1 && *degree <= 8, function, "degree", *degree, "must be -1 (none), 0, ... or 8");
  if (const auto samples = options.samples_per_patch)
    require(*samples >= 1, function, "samples_per_patch", *samples, "must be at least 1");
  if (const auto centers = options.centers_per_patch)
    require(*centers >= 0, function, "centers_per_patch", *centers, "must not be negative");
  if (const auto anisotropy = options.anisotropy)
    require(*anisotropy >= 0 && *anisotropy <= 1, function, "anisotropy", *anisotropy, "must be from 0 (none) to 1");
  if (const auto smoothing = options.smoothing)
    require(*smoothing >= 0 && std::isfinite(*smoothing), function, "smoothing", *smoothing, "must not be negative");
}

// Samples whose weights have mean 1.
template <int Dim>
PartitionOfUnityFit<Dim> fit_normalized(const Samples<Dim>& samples, const PartitionOfUnityOptions& options) {
  PartitionOfUnityFit<Dim> result;
  Cover<Dim> sorted = cover_to_choose_by(samples);
  const ChosenLocalOptions chosen = choose_local_options(samples, sorted, options);
  result.report.local = chosen.options;
  result.report.cross_validation_rmse = chosen.rmse;
  result.data = fit_patches(samples, std::move(sorted), chosen.options, options.progress);
  result.report.patches = result.data->cover.size();
  result.report.centers = result.report.patches * result.data->models.centers_each;
  return result;
}

}  // namespace

template <int Dim>
void PartitionOfUnity<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  Evaluation<Dim>(*data_, component_, out).evaluate(x);
  for (Index i = 0; i < x.cols(); ++i)
    if (!x.col(i).allFinite()) out.value[i] = std::numeric_limits<double>::quiet_NaN();
}

template <int Dim>
std::vector<Index> PartitionOfUnity<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  return rough_morton_order<Dim>(x);  // blocks are sorted by cell
}

template <int Dim>
double PartitionOfUnity<Dim>::feature_size() const {
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
PartitionOfUnityFit<Dim> partition_of_unity(const Samples<Dim>& samples, const PartitionOfUnityOptions& options) {
  require_valid(samples, "partition_of_unity");
  check<Dim>(options);
  report(options.progress, "fit", 0);
  PartitionOfUnityFit<Dim> result = samples.weights.size() == 0 ? fit_normalized(samples, options)
                                                                : fit_normalized(normalize_weights(samples), options);
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
