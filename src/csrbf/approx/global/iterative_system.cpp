#include "csrbf/approx/global/iterative_system.hpp"

#include "csrbf/approx/global/inverse_factor.hpp"
#include "csrbf/approx/sums/fast_sum.hpp"
#include "csrbf/core/error.hpp"

#include <Eigen/QR>

#include <iomanip>
#include <memory>
#include <sstream>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double first_inner_accuracy = 1e-6;            // of the sums inside of an iteration, at most ...
constexpr double variance_share = .02;                   // ... and in units of the smallest variance
constexpr double first_outer_accuracy = 1e-9;            // of those that residuals are computed with
constexpr double accuracy_step = 1e-2;                   // to the next of the former
constexpr double highest_accuracy = 1e-14;               // about what rounding allows
constexpr double inner_goal = 1e-4;                      // reduction of the residual before it is computed anew
constexpr double trusted = .2;                           // share of the residual's goal that sums may be off by
constexpr double costly_accuracy = 1e-8;                 // below which operators in space take seconds
constexpr Index many_direct = 40000, few_direct = 2000;  // points summed directly with such operators and others
constexpr int most_smoothness = 6;                       // that needs more neighbours in the preconditioner
constexpr double unseen = 2;                             // the largest error at all samples, in units of that at some
constexpr Index checked = 64;                            // samples at which sums are compared with direct ones

// K alpha at some samples, directly.
template <int Dim>
Eigen::VectorXd direct_sums(const PointsRef<Dim>& points, const Kernel& kernel, double support,
                            const Eigen::VectorXd& alpha, const std::vector<Index>& at) {
  const Index n = points.cols();
  Eigen::VectorXd r2(n), phi(n), sums(at.size());
  for (std::size_t k = 0; k < at.size(); ++k) {
    r2 = (points.colwise() - points.col(at[k])).colwise().squaredNorm().transpose() / (support * support);
    kernel.values(r2.data(), n, phi.data());
    sums[k] = phi.dot(alpha);
  }
  return sums;
}

// (A + D) alpha by fast sums of an accuracy that can be raised.
template <int Dim>
class Product {
 public:
  Product(const PointsRef<Dim>& points, const Kernel& kernel, double support, const Eigen::VectorXd& noise,
          double accuracy)
      : points_(points), kernel_(kernel), support_(support), noise_(noise), accuracy_(accuracy) {}

  [[nodiscard]] double accuracy() const { return accuracy_; }
  void set_accuracy(double accuracy) {
    accuracy_ = accuracy;
    sum_.reset();
  }

  [[nodiscard]] Eigen::VectorXd operator()(const Eigen::VectorXd& alpha) {
    if (sum_ == nullptr)
      sum_ = std::make_unique<FastSum<Dim>>(
          points_, kernel_, support_,
          TreeOptions{.tolerance = accuracy_, .leaf_size = few_points() ? points_.cols() : 40});
    Eigen::VectorXd product = sum_->multiply(alpha);
    if (noise_.size() == 1)
      product += noise_[0] * alpha;
    else
      product += noise_.cwiseProduct(alpha);
    return product;
  }

  // Whether direct sums cost less than the operators of fast ones.
  [[nodiscard]] bool few_points() const {
    return points_.cols() <= (Dim == 3 && accuracy_ < costly_accuracy ? many_direct : few_direct);
  }

  // Largest difference from direct sums at a few samples.
  [[nodiscard]] double error(const Eigen::VectorXd& alpha, const Eigen::VectorXd& product) const {
    std::vector<Index> at;
    for (Index k = 0; k < points_.cols(); k += std::max<Index>(1, points_.cols() / checked)) at.push_back(k);
    const Eigen::VectorXd direct = direct_sums<Dim>(points_, kernel_, support_, alpha, at);
    double largest = 0;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const double noise = noise_[noise_.size() == 1 ? 0 : at[k]];
      largest = std::max(largest, std::abs(direct[k] + noise * alpha[at[k]] - product[at[k]]));
    }
    return largest;
  }

 private:
  const PointsRef<Dim>& points_;
  const Kernel& kernel_;
  double support_;
  const Eigen::VectorXd& noise_;
  double accuracy_;
  std::unique_ptr<const FastSum<Dim>> sum_;
};

double largest(const Eigen::VectorXd& v) {
  return v.cwiseAbs().maxCoeff();
}

// Conjugate gradients for K e = r on the range of `project`, until |r| <= goal; r becomes the residual. False when K is
// not positive definite as it is computed.
template <class Multiply, class Precondition, class Count>
bool conjugate_gradients(const Multiply& multiply, const Precondition& precondition, double goal, Eigen::VectorXd& e,
                         Eigen::VectorXd& r, const Count& count) {
  Eigen::VectorXd direction;
  double before = 0;
  while (largest(r) > goal && count()) {
    const Eigen::VectorXd z = precondition(r);
    const double product = r.dot(z);
    direction = direction.size() == 0 ? z : (z + product / before * direction).eval();
    before = product;
    const Eigen::VectorXd K_direction = multiply(direction);
    const double bend = direction.dot(K_direction);
    if (!(bend > 0) || !(product > 0)) return false;
    e += product / bend * direction;
    r -= product / bend * K_direction;
  }
  return true;
}

}  // namespace

// Iterations need sums of a few digits only: they solve for a correction of the coefficients, whose residual is then
// computed with as many digits as it needs.
template <int Dim>
IterativeSolution solve_iteratively(const PointsRef<Dim>& points, const Kernel& kernel, double support,
                                    const Eigen::VectorXd& noise, const Eigen::MatrixXd& G, const Eigen::MatrixXd& s,
                                    const IterativeSystemOptions& options) {
  const Index n = points.cols(), q = G.cols();
  const Index neighbors =
      options.neighbors > 0 ? options.neighbors : 12 * Dim + 4 * std::min(kernel.smoothness(), most_smoothness);
  const InverseFactor inverse(points, kernel, support, noise, G, neighbors, options.progress);
  Eigen::MatrixXd Q(n, q);
  if (q > 0) Q = Eigen::HouseholderQR<Eigen::MatrixXd>(G).householderQ() * Eigen::MatrixXd::Identity(n, q);
  const auto project = [&](Eigen::VectorXd v) {
    for (int twice = 0; twice < 2; ++twice) v -= Q * (Q.transpose() * v).eval();
    return v;
  };
  Product<Dim> inner(points, kernel, support, noise,
                     std::clamp(variance_share * inverse.smallest_variance(), highest_accuracy, first_inner_accuracy));
  Product<Dim> outer(points, kernel, support, noise, first_outer_accuracy);

  IterativeSolution solution;
  solution.alpha.setZero(n, s.cols());
  solution.pi.setZero(q, s.cols());
  solution.inverse_diagonal = inverse.diagonal();
  for (Index component = 0; component < s.cols(); ++component) {
    const Eigen::VectorXd values = s.col(component);
    const double goal = options.tolerance * largest(values);
    if (goal == 0) continue;
    Eigen::VectorXd alpha = Eigen::VectorXd::Zero(n), rest = values, r = project(values);
    int iterations = 0;
    double off = 0;
    const auto count = [&] {
      report(options.progress, "solve", std::min(1., iterations / 30.));
      return iterations++ < options.most_iterations;
    };
    const auto update = [&] {
      const Eigen::VectorXd product = outer(alpha);
      rest = values - product;
      r = project(rest);
      off = unseen * outer.error(alpha, product);
    };
    while (largest(r) + off > goal) {
      const double before = largest(r);
      Eigen::VectorXd correction = Eigen::VectorXd::Zero(n), remaining = r;
      const bool definite =
          conjugate_gradients([&](const Eigen::VectorXd& v) { return project(inner(v)); },
                              [&](const Eigen::VectorXd& v) { return project(inverse.apply(v)); },
                              std::max(.5 * (1 - trusted) * goal, inner_goal * before), correction, remaining, count);
      alpha = project(alpha + correction);
      update();
      while (off > trusted * goal && outer.accuracy() > highest_accuracy) {
        outer.set_accuracy(std::max(.3 * trusted * goal / off * outer.accuracy(), highest_accuracy));
        update();
      }
      if (largest(r) + off <= goal) break;
      if ((!definite || largest(r) > .1 * before) && inner.accuracy() > highest_accuracy)
        inner.set_accuracy(accuracy_step * inner.accuracy());
      else if (iterations >= options.most_iterations || !definite || largest(r) > .9 * before) {
        std::ostringstream text;
        text << "interpolate: residuals of " << std::setprecision(2) << (largest(r) + off) / largest(values)
             << " of the largest value remain after " << iterations
             << " iterations: the system is too ill conditioned; give smoothing > 0, or take a rougher kernel";
        throw SolverFailure(text.str());
      }
    }
    solution.alpha.col(component) = alpha;
    if (q > 0) solution.pi.col(component) = Eigen::HouseholderQR<Eigen::MatrixXd>(G).solve(rest);
    solution.iterations = std::max(solution.iterations, iterations);
    solution.residual = std::max(solution.residual, largest(r) + off);
  }
  return solution;
}

#define CSRBF_INSTANTIATE(Dim)                                                                      \
  template IterativeSolution solve_iteratively<Dim>(const PointsRef<Dim>&, const Kernel&, double,   \
                                                    const Eigen::VectorXd&, const Eigen::MatrixXd&, \
                                                    const Eigen::MatrixXd&, const IterativeSystemOptions&);
CSRBF_INSTANTIATE(1) CSRBF_INSTANTIATE(2) CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
