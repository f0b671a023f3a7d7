#include "figure_2_4.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "signals.hpp"

#include <Eigen/Eigenvalues>

namespace csrbf::thesis {

namespace {

constexpr Index line_samples = 41;
constexpr double spacing = 1.0 / (line_samples - 1);

std::shared_ptr<const Expansion<1>> interpolant(double support) {
  const Points<1> points = line(line_samples);
  const Eigen::VectorXd values = values_at(points, [](const Point<1>& p) { return wavy_signal(p[0]); });
  return interpolate<1>({points, values, {}}, {.kernel = "wendland-c2", .support = support * spacing, .degree = -1})
      .components[0];
}

}  // namespace

std::vector<SupportSize> support_sizes(const std::vector<double>& supports) {
  const Points<1> x = line(2001);
  const Eigen::VectorXd truth = values_at(x, [](const Point<1>& p) { return wavy_signal(p[0]); });
  const Points<1> middle = line(line_samples).leftCols(line_samples - 1).array() + spacing / 2;
  const Eigen::VectorXd middle_truth = values_at(middle, [](const Point<1>& p) { return wavy_signal(p[0]); });

  std::vector<SupportSize> sizes;
  for (const double support : supports) {
    const auto f = interpolant(support);
    const Eigen::MatrixXd A = f->basis().dense_matrix(f->basis().centers());
    const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvalues();
    sizes.push_back({.support = support,
                     .rmse = rms(f->evaluate(x).value, truth),
                     .midpoint = f->evaluate(middle).value.cwiseAbs().sum() / middle_truth.cwiseAbs().sum(),
                     .density = static_cast<double>((A.array() != 0).count()) / static_cast<double>(A.size()),
                     .condition = eigenvalues.maxCoeff() / eigenvalues.minCoeff()});
  }
  return sizes;
}

Figure figure_2_4() {
  Figure figure{.name = "figure-2.4",
                .title = "Fig. 2.4: the size of the support",
                .text =
                    "Interpolants of 41 samples of the signal (3.5) at equal distances h by Wendland's C2 function "
                    "with one support. f stays as smooth as the kernel, whatever the support; it is the collapse "
                    "to 0 between the samples that looks like a discontinuity."};
  const std::vector<double> shown{0.8, 4, 40};
  const Points<1> x = line(1001);
  Table curves{.name = "curves", .columns = {"x", "signal", "0.8 h", "4 h", "40 h"}};
  curves.rows.resize(x.cols());
  for (Index i = 0; i < x.cols(); ++i) curves.rows[i] = {x(0, i), wavy_signal(x(0, i))};
  for (const double support : shown) {
    const Eigen::VectorXd f = interpolant(support)->evaluate(x).value;
    for (Index i = 0; i < x.cols(); ++i) curves.rows[i].push_back(f[i]);
  }

  const auto sizes = support_sizes({0.5, 0.8, 1, 1.2, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32, 40});
  Table table{.name = "supports", .columns = {"support / h", "RMSE", "midpoint", "density", "condition"}};
  for (const SupportSize& s : sizes) table.rows.push_back({s.support, s.rmse, s.midpoint, s.density, s.condition});
  figure.tables = {curves, table};

  const SupportSize& small = sizes.front();
  const SupportSize& large = sizes.back();
  figure.claims = {
      {"too small a support", "the reconstructed signal is not continuous",
       "f = 0 between the samples at support h / 2 (RMSE " + number(small.rmse) + "), but as smooth as the kernel",
       Verdict::fails},
      {"too large a support", "smooth, but the matrix becomes dense",
       "at 40 h RMSE " + number(large.rmse) + ", " + number(100 * large.density) +
           " % of the matrix is not 0, condition " + number(large.condition, 2),
       verdict(large.density > 0.9 && large.rmse < small.rmse / 10)}};
  return figure;
}

}  // namespace csrbf::thesis
