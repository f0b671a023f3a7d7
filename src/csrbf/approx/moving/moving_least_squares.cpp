#include "csrbf/approx/moving/moving_least_squares.hpp"

#include "csrbf/approx/moving/moving_least_squares_field.hpp"
#include "csrbf/approx/moving/track_directions.hpp"
#include "csrbf/approx/samples/merge_duplicates.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/decompositions.hpp"

namespace csrbf {

namespace {

constexpr const char* function = "moving_least_squares";
// All chosen by hand.
constexpr double across_track = 5;     // factor of distances across a track: larger ones follow tracks more closely
constexpr double track_eps = 0.005;    // in radii: closer to a sample than this no other one matters
constexpr double track_ridge = 1e-4;   // of slopes: larger ones flatten, smaller ones leave slopes across a track open
constexpr Index track_neighbors = 24;  // determine the radius of a sample

// The weight of a sample as a function of the point, with derivatives.
template <int Dim>
struct Weight {
  double value = 0;
  Point<Dim> gradient;
  Eigen::Matrix<double, Dim, Dim> hessian;
};

// d = p - p_i. Derivatives only if requested.
template <int Dim>
Weight<Dim> weight_of(const typename MovingLeastSquares<Dim>::Data& data, Index i, const Point<Dim>& d,
                      bool derivatives) {
  const double radius = data.radii[i], per = 1 / (radius * radius), r = d.norm() / radius;
  const double w = data.samples.weight(i);
  Weight<Dim> weight;
  weight.value = w * data.kernel.value(r);
  double g = 0, h = 0;
  if (derivatives) {
    g = w * per * data.kernel.g(r);
    h = w * per * per * data.kernel.h(r);
    for (int a = 0; a < Dim; ++a) weight.gradient[a] = g * d[a];
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) weight.hessian(a, b) = h * d[a] * d[b] + (a == b ? g : 0);
  }
  if (data.directions.cols() == 0) return weight;
  const double* direction = data.directions.col(i).data();
  const double square = across_track * across_track;
  double along = 0;
  for (int a = 0; a < Dim; ++a) along += direction[a] * d[a];
  Point<Dim> m;  // M d / h^2
  for (int a = 0; a < Dim; ++a) m[a] = per * (square * d[a] - (square - 1) * along * direction[a]);
  const double T = d.dot(m) + track_eps * track_eps, B = std::pow(T, -2.5);
  const Weight<Dim> plain = weight;
  weight.value = plain.value * B;
  if (!derivatives) return weight;
  const auto B1 = [&](int a) { return -5 * B / T * m[a]; };
  for (int a = 0; a < Dim; ++a) weight.gradient[a] = B * plain.gradient[a] + plain.value * B1(a);
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) {
      const double metric = per * ((a == b ? square : 0) - (square - 1) * direction[a] * direction[b]);
      const double B2 = 35 * B / (T * T) * m[a] * m[b] - 5 * B / T * metric;
      weight.hessian(a, b) =
          B * plain.hessian(a, b) + plain.gradient[a] * B1(b) + B1(a) * plain.gradient[b] + plain.value * B2;
    }
  return weight;
}

// The fit around one point. All lengths are divided by `scale`, all positions are relative to the point, so the value
// is the first coefficient.
template <int Dim>
class LocalFit {
 public:
  using Data = typename MovingLeastSquares<Dim>::Data;

  LocalFit(const Data& data, Index component) : data_(data), component_(component) {}

  // Collects the samples around p; false when there are none.
  bool gather(const Point<Dim>& p) {
    data_.supports.find(p, runs_);
    ids_.clear();
    for (const auto& run : runs_)
      for (Index slot = run.begin; slot < run.end; ++slot) {
        const Index i = data_.supports.ball(slot);
        if (i >= 0 && (data_.samples.points.col(i) - p).norm() < data_.radii[i]) ids_.push_back(i);
      }
    const auto n = static_cast<Index>(ids_.size());
    if (n == 0) return false;
    points_.resize(Dim, n);
    values_ = Eigen::VectorXd::Zero(n + penalties());
    weights_.resize(n);
    scale_ = 0;
    for (Index k = 0; k < n; ++k) {
      points_.col(k) = data_.samples.points.col(ids_[k]) - p;
      scale_ = std::max(scale_, points_.col(k).norm());
    }
    if (scale_ == 0) scale_ = 1;
    for (Index k = 0; k < n; ++k) {
      const Index i = ids_[k];
      values_[k] = data_.samples.values(i, component_);
      weights_[k] = weight_of<Dim>(data_, i, -points_.col(k), false).value;
    }
    points_ /= scale_;
    return true;
  }

  // Finds the coefficients for the largest degree that the samples determine; false when all weights round to 0.
  bool solve() {
    constexpr double most_condition = 1e10;  // of the weighted rows, chosen by hand: beyond, a lower degree is used
    const Index n = weights_.size();
    if (!(weights_.maxCoeff() > 0)) return false;
    weight_unit_ = weights_.maxCoeff();
    Eigen::VectorXd roots(n + penalties());
    roots.head(n) = (weights_ / weight_unit_).cwiseSqrt();
    roots.tail(penalties()).setConstant(std::sqrt(penalty_shares().dot(weights_) / weight_unit_));
    for (auto basis = data_.bases.rbegin(); basis != data_.bases.rend(); ++basis) {
      basis_ = &*basis;
      if (basis->size() > n) continue;
      rows_ = Eigen::MatrixXd::Zero(n + penalties(), basis->size());
      rows_.topRows(n) = sample_rows(*basis);
      if (basis->size() > 1) rows_.bottomRightCorner(penalties(), penalties()).setIdentity();
      qr_.setThreshold(1 / most_condition);
      qr_.compute(Eigen::MatrixXd(roots.asDiagonal() * rows_));
      if (qr_.rank() < basis->size()) continue;
      coefficients_ = csrbf::solve(qr_, roots.cwiseProduct(values_));
      return true;
    }
    return false;
  }

  [[nodiscard]] double value() const { return coefficients_[0]; }

  // f = P^T a with G a = b; P and its derivatives at the point are unit vectors times factorials.
  void derivatives(double* gradient, double* hessian) {
    const Index n = weights_.size(), rows = rows_.rows();
    const Index Q = basis_->size();
    const Eigen::VectorXd misfit = values_ - rows_ * coefficients_;
    Eigen::MatrixXd slopes(rows, Dim), bends(rows, symmetric_size<Dim>);  // of the weights
    for (Index k = 0; k < n; ++k) {
      const Index i = ids_[k];
      const Weight<Dim> w = weight_of<Dim>(data_, i, -scale_ * points_.col(k), true);
      slopes.row(k) = scale_ / weight_unit_ * w.gradient.transpose();
      for (int a = 0, entry = 0; a < Dim; ++a)
        for (int b = a; b < Dim; ++b, ++entry) bends(k, entry) = scale_ * scale_ / weight_unit_ * w.hessian(a, b);
    }
    const Eigen::VectorXd shares = penalty_shares();
    for (Index k = n; k < rows; ++k) {
      slopes.row(k) = shares.transpose() * slopes.topRows(n);
      bends.row(k) = shares.transpose() * bends.topRows(n);
    }
    Eigen::MatrixXd first(Q, Dim);  // derivatives of the coefficients
    for (int a = 0; a < Dim; ++a) first.col(a) = normal_solve(slopes.col(a).cwiseProduct(misfit));
    for (int a = 0; a < Dim; ++a) gradient[a] = (monomial(a) + first(0, a)) / scale_;
    if (hessian == nullptr) return;
    for (int a = 0, entry = 0; a < Dim; ++a)
      for (int b = a; b < Dim; ++b, ++entry) {
        const Eigen::VectorXd right = bends.col(entry).cwiseProduct(misfit) -
                                      slopes.col(a).cwiseProduct(rows_ * first.col(b)) -
                                      slopes.col(b).cwiseProduct(rows_ * first.col(a));
        double sum = normal_solve(right)[0] + second_monomial(a, b);
        if (Q > Dim) sum += first(1 + a, b) + first(1 + b, a);
        hessian[entry] = sum / (scale_ * scale_);
      }
  }

 private:
  // Rows after those of the samples, which penalise slopes.
  [[nodiscard]] Index penalties() const { return data_.directions.cols() > 0 ? Dim : 0; }
  // What each sample's weight adds to the weight of such a row: a share of the square of its radius.
  [[nodiscard]] Eigen::VectorXd penalty_shares() const {
    Eigen::VectorXd shares(weights_.size());
    for (Index k = 0; k < shares.size(); ++k) {
      const double radius = data_.radii[ids_[k]] / scale_;
      shares[k] = track_ridge * radius * radius;
    }
    return shares;
  }
  [[nodiscard]] Eigen::MatrixXd sample_rows(const Polynomials<Dim>& basis) const {
    Eigen::MatrixXd rows(points_.cols(), basis.size());
    basis.rows(points_, rows.data());
    return rows;
  }
  // G^-1 P^T right, G = P^T W P = (permuted) R^T R.
  [[nodiscard]] Eigen::VectorXd normal_solve(const Eigen::VectorXd& right) const {
    const Index Q = basis_->size();
    const auto R = qr_.matrixQR().topLeftCorner(Q, Q).template triangularView<Eigen::Upper>();
    Eigen::VectorXd y = qr_.colsPermutation().transpose() * Eigen::VectorXd(rows_.transpose() * right);
    R.transpose().solveInPlace(y);
    R.solveInPlace(y);
    return qr_.colsPermutation() * y;
  }
  // The monomials follow each other by degree, within one as x, y, ... and xx, xy, ..., yy, ...
  [[nodiscard]] double monomial(int a) const { return basis_->degree() >= 1 ? coefficients_[1 + a] : 0; }
  [[nodiscard]] double second_monomial(int a, int b) const {
    if (basis_->degree() < 2) return 0;
    const int place = a * Dim - a * (a - 1) / 2 + b - a;
    return (a == b ? 2 : 1) * coefficients_[1 + Dim + place];
  }

  const Data& data_;
  Index component_;
  std::vector<typename SupportTree<Dim>::Run> runs_;
  std::vector<Index> ids_;
  Points<Dim> points_;
  Eigen::VectorXd values_;
  Eigen::VectorXd weights_;
  double scale_ = 1;
  double weight_unit_ = 1;
  const Polynomials<Dim>* basis_ = nullptr;
  Eigen::MatrixXd rows_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
  Eigen::VectorXd coefficients_;
};

// Radii from the distances to the neighbours; distance 0 does not occur among distinct points.
template <int Dim>
Eigen::VectorXd sample_radii(const Points<Dim>& points, const KdTree<Dim>& tree, Index neighbors, double support) {
  const Index k = std::min(neighbors + 1, points.cols());
  Eigen::VectorXd radii(points.cols());
  parallel_for(points.cols(), 256, [&](Index first, Index last) {
    std::vector<Index> indices(k);
    std::vector<double> squared(indices.size());
    for (Index i = first; i < last; ++i) {
      tree.nearest(points.col(i), k, indices.data(), squared.data());
      radii[i] = k > 1 ? support * std::sqrt(squared.back()) : 1;
    }
  });
  return radii;
}

template <int Dim>
Samples<Dim> with_weight(const Samples<Dim>& samples) {
  if (samples.weights.size() == 0 || samples.weights.minCoeff() > 0) return samples;
  std::vector<Index> ids;
  for (Index i = 0; i < samples.size(); ++i)
    if (samples.weights[i] > 0) ids.push_back(i);
  return chosen_samples(samples, ids);
}

}  // namespace

template <int Dim>
MovingLeastSquares<Dim>::MovingLeastSquares(std::shared_ptr<const Data> data, Index component)
    : data_(std::move(data)), component_(component) {}

template <int Dim>
Box<Dim> MovingLeastSquares<Dim>::bounds() const {
  return bounding_box<Dim>(data_->samples.points);
}

template <int Dim>
void MovingLeastSquares<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  constexpr int entries = symmetric_size<Dim>;
  LocalFit<Dim> fit(*data_, component_);
  for (Index k = 0; k < x.cols(); ++k) {
    double gradient[Dim] = {};
    double hessian[entries] = {};
    if (fit.gather(x.col(k)) && fit.solve()) {
      out.value[k] = fit.value();
      if (out.gradient != nullptr || out.hessian != nullptr)
        fit.derivatives(gradient, out.hessian != nullptr ? hessian : nullptr);
    } else {
      Index nearest = 0;
      double squared = 0;
      data_->nearest.nearest(x.col(k), 1, &nearest, &squared);
      out.value[k] = data_->samples.values(nearest, component_);
    }
    if (out.gradient != nullptr) std::copy_n(gradient, Dim, out.gradient + Dim * k);
    if (out.hessian != nullptr) std::copy_n(hessian, entries, out.hessian + entries * k);
  }
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> moving_least_squares(const Samples<Dim>& samples,
                                                                    const MovingLeastSquaresOptions& options) {
  require_valid(samples, function);
  require(options.degree >= 0 && options.degree <= 5, function, "degree", options.degree, "must lie between 0 and 5");
  require(options.support > 0 && std::isfinite(options.support), function, "support", options.support,
          "must be positive, in distances to a neighbour");
  require(options.neighbors >= 0, function, "neighbors", options.neighbors, "must not be negative; 0 chooses");
  require(!options.tracks || options.degree == 1, function, "degree", options.degree, "must be 1 with tracks");
  const Kernel kernel(options.kernel, Dim);
  require(kernel.compact() && kernel.smoothness() >= 2, function, "kernel", kernel.name(),
          "must have compact support and two derivatives; choose wendland-c2 or another one");
  using Data = typename MovingLeastSquares<Dim>::Data;
  auto data = std::make_shared<Data>(with_weight(merge_duplicates(samples).samples), kernel, options.degree);
  const Index usual = options.tracks ? track_neighbors : std::max<Index>(2 * Dim, 2 * data->bases.back().size());
  const Index neighbors = options.neighbors > 0 ? options.neighbors : usual;
  if (options.tracks) data->directions = track_directions<Dim>(data->samples.points, data->nearest);
  data->set_radii(sample_radii<Dim>(data->samples.points, data->nearest, neighbors, options.support));
  std::vector<std::shared_ptr<const Field<Dim>>> fields;
  for (Index c = 0; c < samples.components(); ++c)
    fields.push_back(std::make_shared<const MovingLeastSquares<Dim>>(data, c));
  return fields;
}

#define CSRBF_INSTANTIATE(Dim)                                                                           \
  template class MovingLeastSquares<Dim>;                                                                \
  template std::vector<std::shared_ptr<const Field<Dim>>> moving_least_squares<Dim>(const Samples<Dim>&, \
                                                                                    const MovingLeastSquaresOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
