#include "csrbf/approx/left_out/left_out_extremes.hpp"

#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/spatial/even_pairs.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_extremes_of = 800;  // samples
constexpr std::array<double, 4> outermost_shares = {0, 0.05, 0.1, 0.2};
constexpr Index most_left_out = 50;  // samples at a time, and a fifth of all, but always
constexpr Index always_left_out = 3;
constexpr Index fewest_predicted = 4;

// The prediction of a random function from all samples but some, whose matrix is factorised once: without them it is
// that of all samples if these have the values that are predicted for them.
class WithoutSome {
 public:
  WithoutSome(const SampleView& samples, const AxisCovariance<Eigen::Dynamic>& covariance)
      : samples_(samples), covariance_(covariance), places_(in_lengths<Eigen::Dynamic>(samples.points, covariance)) {
    const Index n = samples.size();
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd r2(n);
    for (Index j = 0; j < n; ++j) {
      squared_distances(places_, j, places_.col(j).data(), r2.data());
      covariance.kernel.values(r2.data(), n - j, &A(j, j));
      A(j, j) += std::max(covariance.nugget, least_noise) / samples.weight(j);
    }
    llt_.compute(A);
    if (!is_regular()) return;
    center_ = places_.rowwise().mean();
    white_ = trend(places_);
    solve_lower(llt_, white_);
    Eigen::MatrixXd information = white_.transpose() * white_;
    constexpr double rounding = 1e-12;
    information.diagonal().array() += rounding * information.trace();
    information_.compute(information);
  }

  [[nodiscard]] bool is_regular() const { return llt_.info() == Eigen::Success; }

  // Coefficients of the radial functions for some values.
  [[nodiscard]] Eigen::MatrixXd alpha(const Eigen::MatrixXd& values) const {
    Eigen::MatrixXd white = values;
    solve_lower(llt_, white);
    white -= white_ * pi(white);
    solve_upper(llt_, white);
    return white;
  }

  // Errors of samples predicted from all others, and of those of them outside the box of the others when they are
  // predicted by the value at its nearest point. Returns how many these are; adds the squares of both.
  Index add_errors(const std::vector<Index>& left_out, double& of_trend, double& of_constant) const {
    const auto m = std::ssize(left_out);
    const Index n = samples_.size();
    std::vector<char> is_left_out(static_cast<std::size_t>(n), 0);
    for (const Index i : left_out) is_left_out[static_cast<std::size_t>(i)] = 1;
    Eigen::MatrixXd rest(samples_.dimension(), n - m);
    for (Index i = 0, k = 0; i < n; ++i)
      if (is_left_out[static_cast<std::size_t>(i)] == 0) rest.col(k++) = samples_.points.col(i);
    const Eigen::VectorXd lo = rest.rowwise().minCoeff(), hi = rest.rowwise().maxCoeff();
    Eigen::MatrixXd units = Eigen::MatrixXd::Zero(n, m);
    for (Index k = 0; k < m; ++k) units(left_out[static_cast<std::size_t>(k)], k) = 1;
    const Eigen::MatrixXd columns = alpha(units), all = alpha(samples_.values);
    const Eigen::MatrixXd errors =
        solve(Eigen::LDLT<Eigen::MatrixXd>(columns(left_out, Eigen::all)), Eigen::MatrixXd(all(left_out, Eigen::all)));
    Eigen::MatrixXd values = samples_.values;
    for (Index k = 0; k < m; ++k) values.row(left_out[static_cast<std::size_t>(k)]) -= errors.row(k);
    Eigen::MatrixXd white = values;
    solve_lower(llt_, white);
    const Eigen::MatrixXd beta = pi(white), coefficients = alpha(values);
    Index count = 0;
    for (Index k = 0; k < m; ++k) {
      const Index i = left_out[static_cast<std::size_t>(k)];
      const Eigen::VectorXd x = samples_.points.col(i);
      const Eigen::MatrixXd nearest = x.cwiseMax(lo).cwiseMin(hi);
      if (nearest == x) continue;
      const Eigen::MatrixXd there = in_lengths<Eigen::Dynamic>(nearest, covariance_);
      Eigen::VectorXd r2(n), phi(n);
      squared_distances(places_, 0, there.data(), r2.data());
      covariance_.kernel.values(r2.data(), n, phi.data());
      const Eigen::RowVectorXd value = phi.transpose() * coefficients + trend(there) * beta;
      of_trend += errors.row(k).squaredNorm();
      of_constant += (samples_.values.row(i) - value).squaredNorm();
      ++count;
    }
    return count;
  }

 private:
  static constexpr double least_noise = 1e-9;
  [[nodiscard]] Eigen::MatrixXd trend(const Eigen::MatrixXd& x) const {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Ones(x.cols(), covariance_.degree >= 1 ? 1 + x.rows() : 1);
    if (covariance_.degree >= 1) rows.rightCols(x.rows()) = (x.colwise() - center_).transpose();
    return rows;
  }
  [[nodiscard]] Eigen::MatrixXd pi(const Eigen::MatrixXd& white) const {
    return solve(information_, Eigen::MatrixXd(white_.transpose() * white));
  }

  const SampleView samples_;
  const AxisCovariance<Eigen::Dynamic> covariance_;
  Eigen::MatrixXd places_;
  Eigen::LLT<Eigen::MatrixXd> llt_;
  Eigen::VectorXd center_;
  Eigen::MatrixXd white_;
  Eigen::LDLT<Eigen::MatrixXd> information_;
};

// This share of the samples, or one more at the same coordinate each, that are outermost along an axis; none where
// these are too many to tell.
std::vector<Index> outermost(const SampleView& samples, Index axis, double sign, double share) {
  const Index n = samples.size(), most = std::max(always_left_out, std::min(most_left_out, n / 4));
  const Index least = std::min(most, static_cast<Index>(std::ceil(share * static_cast<double>(n))));
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  const auto coordinate = [&](Index i) { return sign * samples.points(axis, i); };
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return coordinate(a) > coordinate(b); });
  Index count = 1;
  while (count < n && (count < least || coordinate(order[count]) == coordinate(order[count - 1]))) ++count;
  if (count > most) return {};
  order.resize(static_cast<std::size_t>(count));
  return order;
}

// Of many samples the outermost ones and others spread over all.
template <int Dim>
Samples<Dim> some_with_extremes(const Samples<Dim>& samples) {
  if (samples.size() <= most_extremes_of) return samples;
  std::vector<Index> some = even_samples(morton_order<Dim>(samples.points), most_extremes_of);
  for (int axis = 0; axis < Dim; ++axis)
    for (const double sign : {1.0, -1.0}) {
      const std::vector<Index> left_out = outermost(SampleView(samples), axis, sign, outermost_shares.back());
      some.insert(some.end(), left_out.begin(), left_out.end());
    }
  std::sort(some.begin(), some.end());
  some.erase(std::unique(some.begin(), some.end()), some.end());
  return chosen_samples(samples, some);
}

Extrapolation best_for_extremes(const SampleView& samples, const AxisCovariance<Eigen::Dynamic>& covariance) {
  const WithoutSome without(samples, covariance);
  if (!without.is_regular()) return Extrapolation::automatic;
  double of_trend = 0, of_constant = 0;
  Index count = 0;
  for (Index axis = 0; axis < samples.dimension(); ++axis)
    for (const double sign : {1.0, -1.0})
      for (const double share : outermost_shares) {
        const std::vector<Index> left_out = outermost(samples, axis, sign, share);
        if (!left_out.empty()) count += without.add_errors(left_out, of_trend, of_constant);
      }
  return count >= fewest_predicted && of_trend < of_constant ? Extrapolation::trend : Extrapolation::constant;
}

}  // namespace

template <int Dim>
Extrapolation best_for_extremes(const Samples<Dim>& all, const AxisCovariance<Dim>& covariance) {
  if (all.size() > most_extremes_of && Dim <= 3) return Extrapolation::automatic;
  const Samples<Dim> samples = some_with_extremes(all);
  return best_for_extremes(SampleView(samples), of_any_dimension(covariance));
}

#define CSRBF_INSTANTIATE(Dim) \
  template Extrapolation best_for_extremes<Dim>(const Samples<Dim>&, const AxisCovariance<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
