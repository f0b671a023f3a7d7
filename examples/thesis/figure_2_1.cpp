#include "figure_2_1.hpp"

#include "csrbf/approx/basis/polynomial.hpp"
#include "csrbf/kernels/kernel.hpp"
#include "signals.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <cmath>
#include <functional>

namespace csrbf::thesis {
namespace {

using Profile = std::function<double(double)>;

constexpr Index gram_points = 200;
constexpr double eigenvalue_rounding = 1e-9;  // of the largest eigenvalue

// The smallest eigenvalue of the matrix phi(|p_i - p_j| / support) of random points of the unit cube over the largest,
// on coefficients orthogonal to all polynomials of degree order - 1.
template <int Dim>
double smallest_eigenvalue(const Profile& phi, int order, double support) {
  const Points<Dim> p = random_points<Dim>(gram_points, 1);
  Eigen::MatrixXd A(gram_points, gram_points);
  for (Index i = 0; i < gram_points; ++i)
    for (Index j = 0; j < gram_points; ++j) A(i, j) = phi((p.col(i) - p.col(j)).norm() / support);
  if (order > 0) {
    const Polynomials<Dim> basis(order - 1);
    Eigen::MatrixXd G(gram_points, basis.size());
    basis.rows(p, G.data());
    const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(G).householderQ();
    const Eigen::MatrixXd Z = Q.rightCols(gram_points - basis.size());
    A = (Z.transpose() * A * Z).eval();
  }
  const Eigen::VectorXd found = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
  return found.minCoeff() / found.maxCoeff();
}

Profile profile(const Kernel& kernel) {
  return [kernel](double r) { return kernel.value(r); };
}

Table curves(const std::string& name, const std::vector<std::pair<std::string, Profile>>& all, double end) {
  Table table{.name = name, .columns = {"r"}};
  for (const auto& [label, phi] : all) table.columns.push_back(label);
  constexpr int steps = 300;
  for (int i = 0; i <= steps; ++i) {
    const double r = end * i / steps;
    table.rows.push_back({r});
    for (const auto& [label, phi] : all) table.rows.back().push_back(phi(r));
  }
  return table;
}

// Whether all kernels of a table are what it says, in one to three dimensions.
Claim definite(const std::string& what, const std::vector<Kernel>& kernels, double support) {
  double least = 1;
  std::string where;
  for (const Kernel& kernel : kernels) {
    const Profile phi = profile(kernel);
    std::vector<double> found = {smallest_eigenvalue<1>(phi, kernel.order(), support),
                                 smallest_eigenvalue<2>(phi, kernel.order(), support),
                                 smallest_eigenvalue<3>(phi, kernel.order(), support)};
    found.resize(kernel.dimension());
    for (const double eigenvalue : found)
      if (eigenvalue < least) least = eigenvalue, where = kernel.name();
  }
  return {what, "yes", "smallest eigenvalue over the largest " + number(least, 2) + " (" + where + ")",
          verdict(least > -eigenvalue_rounding)};
}

double power(double base, int exponent) {
  return base > 0 ? std::pow(base, exponent) : 0;
}

// Theorem 2.1 for k = 2 with a constant c in l^2 + 4 l + c; d = 3, so l = 4.
double wendland_c4(double r, double c) {
  constexpr double l = 4;
  return power(1 - r, 6) * ((l * l + 4 * l + c) * r * r + (3 * l + 6) * r + 3) / 3;
}

// The coefficient of r^3 at 0, which an even function of four derivatives does not have: third differences.
double cubic_term(const Profile& phi) {
  constexpr double h = 1e-4;
  return (-phi(0) + 3 * phi(h) - 3 * phi(2 * h) + phi(3 * h)) / (6 * h * h * h);
}

void add_misprints(Figure& figure) {
  const Profile printed = [](double r) { return power(1 - r, 5) * (38 * r * r + 5 * r + 1); };
  const Profile correct = profile(Kernel("wendland-c4", 1));
  const double wrong = smallest_eigenvalue<1>(printed, 0, 0.5), right = smallest_eigenvalue<1>(correct, 0, 0.5);
  figure.claims.push_back(
      {"Table 2.3, d = 1, C4 as printed, 38 r^2 + 5 r + 1: positive definite", "yes",
       "smallest eigenvalue over the largest " + number(wrong, 2) + "; with 8 r^2: " + number(right, 2),
       verdict(wrong > -eigenvalue_rounding)});
  const double kink = cubic_term([](double r) { return wendland_c4(r, 1); }),
               smooth = cubic_term([](double r) { return wendland_c4(r, 3); });
  figure.claims.push_back({"theorem 2.1, k = 2 as printed, l^2 + 4 l + 1: four derivatives", "yes",
                           "no: a term of r^3 at the centre, third difference " + number(kink, 2) +
                               "; with l^2 + 4 l + 3: " + number(std::abs(smooth), 1),
                           verdict(std::abs(kink) < 0.5)});
  figure.tables.push_back(curves("misprint", {{"as printed: 38 r^2", printed}, {"correct: 8 r^2", correct}}, 1.1));
}

}  // namespace

Figure figure_2_1() {
  Figure figure{.name = "figure-2.1",
                .title = "Tables 2.1-2.3, Figs. 2.1-2.3: radial basis functions",
                .text =
                    "The functions as the library has them, compactly supported ones with the value 1 at the centre. "
                    "Eigenvalues are those of matrices phi(|p_i - p_j| / s) of 200 random points of the unit cube in "
                    "1, 2 and 3 dimensions, on coefficients orthogonal to the polynomials that the order of the "
                    "function demands; s is 1/2 for compact supports and 1/4 for the others. What is positive definite "
                    "has none below 0 but for rounding."};
  const std::vector<Kernel> definite_ones = {Kernel("gaussian", 3), Kernel("inverse-multiquadric", 3),
                                             Kernel("matern-c2", 3), Kernel("wendland-c2", 3)};
  const std::vector<Kernel> conditional = {Kernel("multiquadric", 3), Kernel("linear", 3), Kernel("cubic", 3),
                                           Kernel("thin-plate", 3)};
  figure.tables = {curves("Table 2.1",
                          {{"Gaussian", profile(definite_ones[0])},
                           {"inverse multiquadric", profile(definite_ones[1])},
                           {"Sobolev spline (Matern), ν = 3/2", profile(definite_ones[2])},
                           {"compact (Wendland C2)", profile(definite_ones[3])}},
                          4),
                   curves("Table 2.2",
                          {{"multiquadric", profile(conditional[0])},
                           {"-r", profile(conditional[1])},
                           {"r^3", profile(conditional[2])},
                           {"thin plate", profile(conditional[3])}},
                          2)};
  figure.claims = {definite("Table 2.1: strictly positive definite", definite_ones, 0.25),
                   definite("Table 2.2: conditionally positive definite of the order printed", conditional, 0.25)};
  std::vector<Kernel> wendland;
  for (const int d : {1, 3, 5}) {
    std::vector<std::pair<std::string, Profile>> all;
    for (const char* c : {"c0", "c2", "c4"}) {
      const Kernel kernel(std::string("wendland-") + c, d);
      all.emplace_back(std::string(1, 'C') + (c + 1), profile(kernel));
      if (d <= 3) wendland.push_back(kernel);
    }
    figure.tables.push_back(curves("Table 2.3, d = " + std::to_string(d), all, 1.1));
  }
  figure.claims.push_back(definite("Table 2.3, d = 1 and 3: positive definite (C4, d = 1 corrected)", wendland, 0.5));
  const double beyond = smallest_eigenvalue<2>(profile(Kernel("wendland-c0", 1)), 0, 0.5);
  figure.claims.push_back({"beyond its dimension a function is not positive definite: d = 1, C0 in the plane",
                           "implied by theorem 2.1", "smallest eigenvalue over the largest " + number(beyond, 2),
                           verdict(beyond < -eigenvalue_rounding)});
  add_misprints(figure);
  return figure;
}

}  // namespace csrbf::thesis
