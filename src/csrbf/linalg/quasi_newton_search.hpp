#pragma once

#include <Eigen/Core>

#include <functional>

namespace csrbf {

struct QuasiNewtonOptions {
  int evaluations = 30;     ///< at most
  double tolerance = 1e-2;  ///< ends when a step lowers the value by less
  double largest_step = 2;  ///< of a variable
  double first_step = 1;    ///< of the variable that changes most
};

struct QuasiNewtonMinimum {
  Eigen::VectorXd x;
  double value = 0;
};

/// Searches a minimum of f in the box [lower, upper] from `start`: steps by an approximation of the inverse Hessian
/// from the gradients (BFGS; Nocedal and Wright 2006, algorithm 6.1), clamped to the box, cut until they lower the
/// value. f(x, gradient) writes the gradient and returns the value; values that are not finite count as infinite.
/// Deterministic.
QuasiNewtonMinimum quasi_newton_search(
    const std::function<double(const Eigen::VectorXd&, Eigen::VectorXd& gradient)>& f, const Eigen::VectorXd& start,
    const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, const QuasiNewtonOptions& options = {});

}  // namespace csrbf
