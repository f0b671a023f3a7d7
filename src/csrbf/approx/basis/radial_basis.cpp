#include "csrbf/approx/basis/radial_basis.hpp"

#include "csrbf/approx/sums/fast_sum.hpp"
#include "csrbf/core/once.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <memory>
#include <utility>

namespace csrbf {
namespace {

constexpr const char* function = "RadialBasis";
constexpr Index many_centers = 8000;        // beyond which fast sums are faster than direct ones; chosen by hand
constexpr double accuracy = 1e-9;           // of fast sums ...
constexpr double accuracy_in_space = 1e-8;  // ... below which boxes two apart are near, and memory is tenfold
constexpr double most_shifts = 1000;        // periodic images per query, each a search; chosen by hand

}  // namespace

template <int Dim>
struct RadialBasis<Dim>::LazyFastSum {
  Once once;
  std::unique_ptr<const FastSum<Dim>> sum;
};

template <int Dim>
RadialBasis<Dim>::RadialBasis(const Kernel& kernel, const PointsRef<Dim>& centers, const Eigen::VectorXd& supports,
                              const RadialMetric<Dim>& metric)
    : kernel_(kernel), centers_(centers), supports_(supports), metric_(metric) {
  static_assert(Dim <= RadialBatch::max_dimension && SupportTree<Dim>::leaf_size % 8 == 0);
  check();
  // Several centres with one transform share it; a single centre may count as either.
  if (common_transform()) transform_ = metric_.transforms[0];
  for (Index j = 0; j < size(); ++j)
    for (int a = 0; a < Dim; ++a)
      if (metric_.periods[a] > 0)
        centers_(a, j) -= metric_.periods[a] * std::floor(centers_(a, j) / metric_.periods[a]);
  const Points<Dim> mapped = common_transform() ? Points<Dim>(transform_ * centers_) : centers_;
  tree_ = SupportTree<Dim>(mapped, search_radii());
  list_shifts();
  fill_arrays(mapped);
  if (Dim <= 3 && !kernel_.compact() && size() > many_centers && supports_.size() == 1 && !own_transforms())
    fast_sum_ = std::make_shared<LazyFastSum>();
}

template <int Dim>
const FastSum<Dim>* RadialBasis<Dim>::fast_sum() const {
  if constexpr (Dim > 3) {
    return nullptr;
  } else {
    if (fast_sum_ == nullptr) return nullptr;
    fast_sum_->once.call([this] {
      fast_sum_->sum = std::make_unique<const FastSum<Dim>>(
          Points<Dim>(transform_ * centers_), kernel_, support(0),
          TreeOptions{.tolerance = Dim == 3 ? accuracy_in_space : accuracy, .everywhere = true});
    });
    return fast_sum_->sum.get();
  }
}

template <int Dim>
void RadialBasis<Dim>::check() const {
  require(centers_.allFinite(), function, "centers", "NaN or infinity", "every coordinate must be finite");
  require(supports_.size() == 1 || supports_.size() == size(), function, "supports", supports_.size(),
          "there must be one support or one per centre");
  require(size() == 0 || (supports_.allFinite() && supports_.minCoeff() > 0), function, "supports",
          "not positive or not finite", "every support must be positive and finite");
  const auto count = static_cast<Index>(metric_.transforms.size());
  require(count <= 1 || count == size(), function, "transforms", count, "there must be none, one, or one per centre");
  for (const Matrix& transform : metric_.transforms)
    require(transform.allFinite() && smallest_singular_value(transform) > 0, function, "transforms",
            "singular or not finite", "every transform must be invertible");
  require(metric_.periods.allFinite() && metric_.periods.minCoeff() >= 0, function, "periods",
          metric_.periods.transpose(), "must be 0 (not periodic) or the positive length of the period");
  require(metric_.periods.maxCoeff() == 0 || kernel_.compact(), function, "kernel", kernel_.name(),
          "periodic axes need a compactly supported kernel; choose wendland-c2 or another one");
}

// Radii of balls around the (mapped) centres that contain the supports.
template <int Dim>
Eigen::VectorXd RadialBasis<Dim>::search_radii() const {
  if (!kernel_.compact()) return Eigen::VectorXd::Constant(size(), std::numeric_limits<double>::infinity());
  // Rounding must not lose a function whose support ends at the point.
  constexpr double margin = 1 + 1e-12;
  Eigen::VectorXd radii(size());
  for (Index j = 0; j < size(); ++j) {
    radii[j] = margin * support(j);
    if (own_transforms()) radii[j] /= smallest_singular_value(metric_.transforms[j]);
  }
  return radii;
}

template <int Dim>
void RadialBasis<Dim>::list_shifts() {
  shifts_ = {Point<Dim>::Zero()};
  if (metric_.periods.maxCoeff() == 0 || size() == 0) return;
  double reach = search_radii().maxCoeff();
  if (common_transform()) reach /= smallest_singular_value(transform_);
  for (int a = 0; a < Dim; ++a) {
    if (metric_.periods[a] == 0) continue;
    const double repetitions = std::ceil(reach / metric_.periods[a]);
    const double count = static_cast<double>(shifts_.size()) * (2 * repetitions + 1);
    require(count <= most_shifts, function, "supports", reach,
            "is too many times the period; use smaller supports or no period on this axis");
    std::vector<Point<Dim>> shifted;
    for (const Point<Dim>& shift : shifts_)
      for (double i = -repetitions; i <= repetitions; ++i)
        shifted.push_back(shift + i * metric_.periods[a] * Point<Dim>::Unit(a));
    shifts_ = std::move(shifted);
  }
}

template <int Dim>
void RadialBasis<Dim>::fill_arrays(const Points<Dim>& mapped) {
  const Index slots = tree_.slots();
  position_.setZero(slots, Dim);
  shape_.setZero(slots, own_transforms() ? symmetric_size<Dim> : 1);
  for (Index i = 0; i < slots; ++i) {
    const Index j = tree_.ball(i);
    if (j < 0) continue;
    position_.row(i) = mapped.col(j).transpose();
    if (!own_transforms()) {
      shape_(i, 0) = 1 / (support(j) * support(j));
      continue;
    }
    const Matrix scaled = metric_.transforms[j] / support(j);
    const Matrix S = scaled.transpose() * scaled;
    for (int a = 0, entry = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++entry) shape_(i, entry) = S(a, b);
  }
}

template <int Dim>
Point<Dim> RadialBasis<Dim>::wrapped(const Point<Dim>& x) const {
  Point<Dim> y = x;
  for (int a = 0; a < Dim; ++a)
    if (metric_.periods[a] > 0) y[a] -= metric_.periods[a] * std::floor(y[a] / metric_.periods[a]);
  return y;
}

template <int Dim>
CenterArrays RadialBasis<Dim>::arrays() const {
  return {Dim, position_.rows(), position_.data(), shape_.data(), own_transforms()};
}

// Calls use(batch) with r2 (and v) filled, for all slots whose supports may contain x.
template <int Dim>
template <class Use>
void RadialBasis<Dim>::for_each_batch(const Point<Dim>& x, bool with_directions, Runs& runs, RadialBatch& batch,
                                      const Use& use) const {
  const CenterArrays centers = arrays();
  const Point<Dim> base = wrapped(x);
  for (const Point<Dim>& shift : shifts_) {
    Point<Dim> p = base + shift;
    if (common_transform()) p = (transform_ * p).eval();
    tree_.find(p, runs);
    batch.size = batch.runs = 0;
    const auto flush = [&] {
      radial_distances(centers, p.data(), with_directions, batch);
      use(batch);
      batch.size = batch.runs = 0;
    };
    for (const auto& run : runs) {
      for (Index begin = run.begin; begin < run.end;) {
        const Index length = std::min(run.end - begin, RadialBatch::capacity - batch.size);
        batch.slot[batch.runs] = begin;
        batch.length[batch.runs++] = length;
        batch.size += length;
        begin += length;
        if (batch.size == RadialBatch::capacity) flush();
      }
    }
    if (batch.size > 0) flush();
  }
}

template <int Dim>
std::vector<Index> RadialBasis<Dim>::reaching(const Box<Dim>& box) const {
  Runs runs;
  tree_.find(box, runs);
  std::vector<Index> found;
  for (const auto& [begin, end] : runs)
    for (Index i = begin; i < end; ++i)
      if (tree_.ball(i) >= 0) found.push_back(tree_.ball(i));
  return found;
}

template <int Dim>
Eigen::VectorXd RadialBasis<Dim>::to_slots(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const {
  require(coefficients.size() == size(), function, "coefficients", coefficients.size(), "there must be one per centre");
  Eigen::VectorXd slots = Eigen::VectorXd::Zero(tree_.slots());
  for (Index i = 0; i < slots.size(); ++i)
    if (tree_.ball(i) >= 0) slots[i] = coefficients[tree_.ball(i)];
  return slots;
}

template <int Dim>
void RadialBasis<Dim>::add_sums(const PointsRef<Dim>& x, const Eigen::VectorXd& slot_coefficients,
                                const JetBlock& out) const {
  const Derivatives wanted = out.derivatives();
  const CenterArrays centers = arrays();
  const auto batch = std::make_unique<RadialBatch>();
  Runs runs;
  for (Index k = 0; k < x.cols(); ++k) {
    double value = 0;
    Point<Dim> gradient = Point<Dim>::Zero();
    Matrix hessian = Matrix::Zero();
    double triangle[symmetric_size<Dim>] = {};
    for_each_batch(x.col(k), wanted >= Derivatives::gradient, runs, *batch, [&](RadialBatch& b) {
      if (wanted == Derivatives::none) kernel_.values(b.r2, b.size, b.phi);
      if (wanted == Derivatives::gradient) kernel_.gradients(b.r2, b.size, b.phi, b.g);
      if (wanted == Derivatives::hessian) kernel_.hessians(b.r2, b.size, b.phi, b.g, b.h);
      add_radial_sums(centers, slot_coefficients.data(), b, &value,
                      wanted >= Derivatives::gradient ? gradient.data() : nullptr,
                      wanted >= Derivatives::hessian ? triangle : nullptr);
    });
    out.value[k] += value;
    if (wanted >= Derivatives::gradient)
      Eigen::Map<Point<Dim>>(out.gradient + Dim * k) += transform_.transpose() * gradient;
    if (wanted < Derivatives::hessian) continue;
    for (int a = 0, entry = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++entry) hessian(a, b) = hessian(b, a) = triangle[entry];
    if (common_transform()) hessian = (transform_.transpose() * hessian * transform_).eval();
    double* target = out.hessian + symmetric_size<Dim> * k;
    for (int a = 0, entry = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++entry) target[entry] += hessian(a, b);
  }
}

// visit(column, value) for the entries of one row of B, in no order; several per column where space is periodic.
template <int Dim>
template <class Visit>
void RadialBasis<Dim>::for_each_entry(const Point<Dim>& x, Runs& runs, RadialBatch& batch, const Visit& visit) const {
  for_each_batch(x, false, runs, batch, [&](RadialBatch& b) {
    kernel_.values(b.r2, b.size, b.phi);
    Index at = 0;
    for (int run = 0; run < b.runs; ++run) {
      const Index begin = b.slot[run];
      for (Index i = 0; i < b.length[run]; ++i, ++at) {
        const Index j = tree_.ball(begin + i);
        if (j >= 0 && (b.r2[at] < 1 || !kernel_.compact())) visit(static_cast<int>(j), b.phi[at]);
      }
    }
  });
}

// Entries (column, value) of one row of B, sorted, one per column.
template <int Dim>
void RadialBasis<Dim>::row(const Point<Dim>& x, Runs& runs, RadialBatch& batch,
                           std::vector<std::pair<int, double>>& entries) const {
  entries.clear();
  for_each_entry(x, runs, batch, [&](int column, double value) { entries.emplace_back(column, value); });
  std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (shifts_.size() == 1) return;
  std::size_t last = 0;
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (entries[i].first == entries[last].first)
      entries[last].second += entries[i].second;
    else
      entries[++last] = entries[i];
  }
  if (!entries.empty()) entries.resize(last + 1);
}

template <int Dim>
Eigen::SparseMatrix<double, Eigen::RowMajor> RadialBasis<Dim>::matrix(const PointsRef<Dim>& points) const {
  require(kernel_.compact(), function, "kernel", kernel_.name(), "a sparse matrix needs a compactly supported kernel");
  constexpr Index grain = 1024;  // rows per task, chosen by hand
  const Index n = points.cols();
  std::vector<std::vector<std::pair<int, double>>> blocks((n + grain - 1) / grain);
  std::vector<Index> begin(static_cast<std::size_t>(n) + 1, 0);
  parallel_for(n, grain, [&](Index first, Index last) {
    const auto batch = std::make_unique<RadialBatch>();
    Runs runs;
    std::vector<std::pair<int, double>> entries;
    auto& block = blocks[first / grain];
    for (Index k = first; k < last; ++k) {
      row(points.col(k), runs, *batch, entries);
      block.insert(block.end(), entries.begin(), entries.end());
      begin[static_cast<std::size_t>(k) + 1] = static_cast<Index>(entries.size());
    }
  });
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  require(begin.back() <= std::numeric_limits<int>::max(), function, "entries of the matrix", begin.back(),
          "are too many; use smaller supports");

  Eigen::SparseMatrix<double, Eigen::RowMajor> B(n, size());
  B.resizeNonZeros(begin.back());
  std::transform(begin.begin(), begin.end(), B.outerIndexPtr(), [](Index i) { return static_cast<int>(i); });
  parallel_for(n, grain, [&](Index first, Index /*last*/) {
    auto& block = blocks[first / grain];
    Index at = begin[first];
    for (const auto& [column, value] : block) {
      B.innerIndexPtr()[at] = column;
      B.valuePtr()[at++] = value;
    }
    std::vector<std::pair<int, double>>().swap(block);
  });
  return B;
}

template <int Dim>
Eigen::MatrixXd RadialBasis<Dim>::dense_matrix(const PointsRef<Dim>& points) const {
  Eigen::MatrixXd B(points.cols(), size());
  parallel_for(points.cols(), 64, [&](Index first, Index last) {
    const auto batch = std::make_unique<RadialBatch>();
    Runs runs;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(size(), last - first);  // transposed, to write one after the other
    for (Index k = first; k < last; ++k)
      for_each_entry(points.col(k), runs, *batch, [&](int column, double value) { rows(column, k - first) += value; });
    B.middleRows(first, last - first) = rows.transpose();
  });
  return B;
}

#define CSRBF_INSTANTIATE(Dim) template class RadialBasis<Dim>;
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
