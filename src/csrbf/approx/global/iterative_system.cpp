#include "csrbf/approx/global/iterative_system.hpp"

#include "csrbf/approx/global/inverse_factor.hpp"
#include "csrbf/approx/sums/fast_sum.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/linalg/decompositions.hpp"

#include <functional>
#include <iomanip>
#include <memory>
#include <sstream>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double lowest_accuracy = 1e-6;    // of the sums inside of iterations
constexpr double accuracy_step = 1e-2;      // to a better one, where iterations with it gain too little
constexpr double highest_accuracy = 1e-14;  // about what rounding allows
constexpr double trusted = .2;              // share of the residual's goal that sums may be off by
constexpr double close = .2;                // of the accuracy of the sums inside: not worth others for residuals
constexpr double costly_accuracy = 1e-8;    // below which operators in space take some tenths of a second
constexpr Index many_direct = 20000, few_direct = 2000;  // points summed directly with such operators and others
constexpr double unseen = 2;                             // the largest error at all samples, in units of that at some
constexpr Index checked = 64;                            // samples at which sums are compared with direct ones
constexpr int check_interval = 4;                        // iterations between comparisons
constexpr double floor_margin = 2;  // iterations end when the residual is this many times what sums are off by
constexpr double least_gain = .1;   // of the residual by a pass, above which sums need a better accuracy

// Neighbours of the preconditioner: iterations cost more than these as long as about ten are needed.
Index default_neighbors(int dimension, int smoothness) {
  if (dimension == 1) return 12 + 4 * std::min(smoothness, 6);
  if (dimension == 2) return 24 + 8 * std::min(smoothness, 10);
  return 60 + 25 * std::min(smoothness, 4);
}

// Errors of the sums must not change the sign of the least eigenvalues, which are about the common variance; the norm
// of n x n random errors grows as sqrt(n).
double inner_accuracy(const InverseFactor& inverse, Index n) {
  return std::clamp(inverse.common_variance() / std::sqrt(static_cast<double>(n)), highest_accuracy, lowest_accuracy);
}

// What is different in every dimension.
struct Sums {
  using Sum = std::function<Eigen::VectorXd(const Eigen::VectorXd& alpha)>;
  std::function<Sum(double accuracy, Index leaf_size)> prepare;  // A alpha by fast sums, and directly at some samples
  std::function<Eigen::VectorXd(const Eigen::VectorXd& alpha, const std::vector<Index>& at)> directly;
  Index points = 0;
  bool in_space = false;
};

template <int Dim>
Sums sums_of(const PointsRef<Dim>& points, const Kernel& kernel, double support) {
  Sums sums;
  sums.points = points.cols();
  sums.in_space = Dim == 3;
  sums.prepare = [&points, &kernel, support](double accuracy, Index leaf_size) -> Sums::Sum {
    const auto sum = std::make_shared<const FastSum<Dim>>(points, kernel, support,
                                                          TreeOptions{.tolerance = accuracy, .leaf_size = leaf_size});
    return [sum](const Eigen::VectorXd& alpha) { return sum->multiply(alpha); };
  };
  sums.directly = [&points, &kernel, support](const Eigen::VectorXd& alpha, const std::vector<Index>& at) {
    const Index n = points.cols();
    Eigen::VectorXd r2(n), phi(n), result(at.size());
    for (std::size_t k = 0; k < at.size(); ++k) {
      r2 = (points.colwise() - points.col(at[k])).colwise().squaredNorm().transpose() / (support * support);
      kernel.values(r2.data(), n, phi.data());
      result[k] = phi.dot(alpha);
    }
    return result;
  };
  return sums;
}

// (A + D) alpha by fast sums of an accuracy that can be raised.
class Product {
 public:
  Product(const Sums& sums, const Eigen::VectorXd& noise, double accuracy)
      : sums_(sums), noise_(noise), accuracy_(accuracy) {}

  [[nodiscard]] double accuracy() const { return accuracy_; }
  void set_accuracy(double accuracy) {
    accuracy_ = accuracy;
    sum_ = nullptr;
  }

  [[nodiscard]] Eigen::VectorXd operator()(const Eigen::VectorXd& alpha) {
    if (sum_ == nullptr) sum_ = sums_.prepare(accuracy_, few_points() ? sums_.points : 0);
    Eigen::VectorXd product = sum_(alpha);
    if (noise_.size() == 1)
      product += noise_[0] * alpha;
    else
      product += noise_.cwiseProduct(alpha);
    return product;
  }

  // Whether direct sums cost less than the operators of fast ones.
  [[nodiscard]] bool few_points() const {
    return sums_.points <= (sums_.in_space && accuracy_ < costly_accuracy ? many_direct : few_direct);
  }

  // Largest difference from direct sums at a few samples.
  [[nodiscard]] double error(const Eigen::VectorXd& alpha, const Eigen::VectorXd& product) const {
    std::vector<Index> at;
    for (Index k = 0; k < sums_.points; k += std::max<Index>(1, sums_.points / checked)) at.push_back(k);
    const Eigen::VectorXd direct = sums_.directly(alpha, at);
    double largest = 0;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const double noise = noise_[noise_.size() == 1 ? 0 : at[k]];
      largest = std::max(largest, std::abs(direct[k] + noise * alpha[at[k]] - product[at[k]]));
    }
    return largest;
  }

 private:
  const Sums& sums_;
  const Eigen::VectorXd& noise_;
  double accuracy_;
  Sums::Sum sum_;
};

double largest(const Eigen::VectorXd& v) {
  return v.cwiseAbs().maxCoeff();
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& G) {
  if (G.cols() == 0) return G;
  return thin_q(Eigen::HouseholderQR<Eigen::MatrixXd>(G), G.cols());
}

// Solves for one column of values at a time.
class Solver {
 public:
  Solver(const Sums& sums, const Eigen::VectorXd& noise, const Eigen::MatrixXd& G, const InverseFactor& inverse,
         const IterativeSystemOptions& options)
      : Q_(orthonormal(G)),
        inverse_(inverse),
        options_(options),
        inner_(sums, noise, inner_accuracy(inverse, sums.points)),
        outer_(sums, noise, inner_.accuracy()) {}

  struct Column {
    Eigen::VectorXd alpha, rest;  // values - K alpha, a polynomial up to the residual
    int iterations = 0;
    double residual = 0;
  };

  [[nodiscard]] Column solve(const Eigen::VectorXd& values) {
    Column column{Eigen::VectorXd::Zero(values.size()), values};
    const double goal = options_.tolerance * largest(values);
    if (goal == 0) return column;
    Eigen::VectorXd r = project(values);
    double off = 0;
    column.residual = largest(r);
    Column best = column;
    while (column.residual > goal) {
      const double before = largest(r);
      const Pass pass = conjugate_gradients(r, .5 * (1 - trusted) * goal, column.iterations);
      column.alpha = project(column.alpha + pass.correction);
      const double enough = accuracy_for(goal, pass.off, inner_.accuracy());
      if (enough < close * sums().accuracy()) outer_.set_accuracy(enough);
      off = update(values, column, r);
      while (off > trusted * goal && sums().accuracy() > highest_accuracy) {
        const double better = std::min(accuracy_for(goal, off, sums().accuracy()), close * sums().accuracy());
        outer_.set_accuracy(std::max(better, highest_accuracy));
        off = update(values, column, r);
      }
      column.residual = largest(r) + off;
      if (column.residual <= best.residual) best = column;
      if (column.residual <= goal) break;
      const bool gained = pass.definite && largest(r) <= least_gain * before;
      const bool enough_next = largest(r) / goal <= before / largest(r);  // if the next pass gains as much
      const bool exhausted = column.iterations >= options_.most_iterations;
      if (!(gained && enough_next) && !exhausted && inner_.accuracy() > highest_accuracy)
        inner_.set_accuracy(std::max(accuracy_step * inner_.accuracy(), highest_accuracy));
      else if (exhausted || !gained)
        return acceptable(std::move(best), largest(values), column.iterations);
    }
    return column;
  }

 private:
  struct Pass {
    Eigen::VectorXd correction;
    double off = 0;  // of the product with it, at most
    bool definite = true;
  };

  // For K e = r on the complement of the polynomials, by the sums inside: until the residual is below `goal`, or about
  // what the product with e, which the steps add up to, is found to be off by.
  Pass conjugate_gradients(Eigen::VectorXd r, double goal, int& iterations) {
    Pass pass{Eigen::VectorXd::Zero(r.size())};
    Eigen::VectorXd direction, product = Eigen::VectorXd::Zero(r.size());
    double before = 0;
    for (int step = 0; iterations < options_.most_iterations; ++step, ++iterations) {
      const bool done = largest(r) <= goal;
      if (step > 0 && (done || step % check_interval == 0)) {
        pass.off = unseen * inner_.error(pass.correction, product);
        if (done || largest(r) <= floor_margin * pass.off) return pass;
      }
      report(options_.progress, "solve", std::min(1., iterations / 30.));
      const Eigen::VectorXd z = project(inverse_.apply(r));
      const double length = r.dot(z);
      direction = step == 0 ? z : (z + length / before * direction).eval();
      before = length;
      const Eigen::VectorXd of_direction = inner_(direction);
      const double bend = direction.dot(of_direction);
      if (!(bend > 0) || !(length > 0)) {
        pass.definite = false;
        break;
      }
      pass.correction += length / bend * direction;
      product += length / bend * of_direction;
      r -= length / bend * project(of_direction);
    }
    pass.off = unseen * inner_.error(pass.correction, product);
    return pass;
  }

  // That of sums which are off by less than their share of the goal, if those of an accuracy are by `off`.
  static double accuracy_for(double goal, double off, double accuracy) {
    const double wanted = .5 * trusted * goal / std::max(off, std::numeric_limits<double>::min()) * accuracy;
    return std::clamp(wanted, highest_accuracy, std::max(highest_accuracy, accuracy));
  }

  [[nodiscard]] Product& sums() { return outer_.accuracy() < inner_.accuracy() ? outer_ : inner_; }

  // The residual with the accurate sums. Returns what they are off by, at most.
  double update(const Eigen::VectorXd& values, Column& column, Eigen::VectorXd& r) {
    const Eigen::VectorXd product = sums()(column.alpha);
    column.rest = values - product;
    r = project(column.rest);
    return unseen * sums().error(column.alpha, product);
  }

  [[nodiscard]] Eigen::VectorXd project(Eigen::VectorXd v) const {
    for (int twice = 0; twice < 2; ++twice) v -= Q_ * (Q_.transpose() * v).eval();
    return v;
  }

  // The best that rounding allows, if it is good enough.
  [[nodiscard]] Column acceptable(Column best, double largest_value, int iterations) const {
    best.iterations = iterations;
    if (best.residual <= options_.acceptable * largest_value) return best;
    std::ostringstream text;
    text << "interpolate: residuals of " << std::setprecision(2) << best.residual / largest_value
         << " of the largest value remain after " << iterations
         << " iterations: the system is too ill conditioned; give smoothing > 0, or take a rougher kernel";
    throw SolverFailure(text.str());
  }

  Eigen::MatrixXd Q_;
  const InverseFactor& inverse_;
  const IterativeSystemOptions& options_;
  Product inner_, outer_;
};

IterativeSolution solve_columns(Solver solver, const Eigen::MatrixXd& G, const Eigen::MatrixXd& s,
                                const InverseFactor& inverse) {
  IterativeSolution solution;
  solution.alpha.setZero(s.rows(), s.cols());
  solution.pi.setZero(G.cols(), s.cols());
  solution.inverse_diagonal = inverse.diagonal();
  for (Index component = 0; component < s.cols(); ++component) {
    const auto column = solver.solve(s.col(component));
    solution.alpha.col(component) = column.alpha;
    if (G.cols() > 0) solution.pi.col(component) = solve(Eigen::HouseholderQR<Eigen::MatrixXd>(G), column.rest);
    solution.iterations = std::max(solution.iterations, column.iterations);
    solution.residual = std::max(solution.residual, column.residual);
  }
  return solution;
}

}  // namespace

// Iterations need sums of a few digits only: they solve for a correction of the coefficients, whose residual is then
// computed with as many digits as it needs.
template <int Dim>
IterativeSolution solve_iteratively(const PointsRef<Dim>& points, const Kernel& kernel, double support,
                                    const Eigen::VectorXd& noise, const Eigen::MatrixXd& G, const Eigen::MatrixXd& s,
                                    const IterativeSystemOptions& options) {
  const Index neighbors = options.neighbors > 0 ? options.neighbors : default_neighbors(Dim, kernel.smoothness());
  const InverseFactor inverse(points, kernel, support, noise, G, neighbors, options.progress);
  const Sums sums = sums_of<Dim>(points, kernel, support);
  return solve_columns(Solver(sums, noise, G, inverse, options), G, s, inverse);
}

#define CSRBF_INSTANTIATE(Dim)                                                                      \
  template IterativeSolution solve_iteratively<Dim>(const PointsRef<Dim>&, const Kernel&, double,   \
                                                    const Eigen::VectorXd&, const Eigen::MatrixXd&, \
                                                    const Eigen::MatrixXd&, const IterativeSystemOptions&);
CSRBF_INSTANTIATE(1) CSRBF_INSTANTIATE(2) CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
