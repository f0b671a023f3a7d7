#include "figure_6_1.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "signals.hpp"

#include <cmath>

namespace csrbf::thesis {

Figure figure_6_1() {
  constexpr double snr = 20;
  Figure figure{.name = "figure-6.1",
                .title = "Fig. 6.1: noisy data, interpolated and regularised",
                .text =
                    "60 random samples of a smooth function with white noise of 20 dB, Wendland's C2 function with "
                    "support 0.5: lambda = 0, and lambda chosen by cross-validation."};
  const auto truth = [](const Point<1>& p) { return std::sin(6 * p[0]) + 0.5 * std::cos(11 * p[0]); };
  const Points<1> points = random_points<1>(60, 7);
  Eigen::VectorXd values = values_at(points, truth);
  const double noise = add_noise(values, snr, 8);
  const Points<1> x = line(1001);
  const Eigen::VectorXd exact = values_at(x, truth);
  const auto curve = [&](std::optional<double> smoothing) {
    return interpolate<1>({points, values, {}},
                          {.kernel = "wendland-c2", .support = 0.5, .smoothing = smoothing, .degree = -1})
        .components[0]
        ->evaluate(x)
        .value;
  };
  const Eigen::VectorXd interpolated = curve(0.0), regularised = curve(std::nullopt);
  Table samples{.name = "samples", .columns = {"x", "s"}};
  for (Index i = 0; i < points.cols(); ++i) samples.rows.push_back({points(0, i), values[i]});
  Table curves{.name = "curves", .columns = {"x", "truth", "interpolation", "regularised"}};
  for (Index i = 0; i < x.cols(); ++i) curves.rows.push_back({x(0, i), exact[i], interpolated[i], regularised[i]});
  const double without = rms(interpolated, exact), with = rms(regularised, exact);
  figure.claims = {{"interpolation takes up the noise, regularisation does not", "yes (picture)",
                    "RMSE " + number(without, 2) + " and " + number(with, 2) + "; noise " + number(noise, 2),
                    verdict(with < noise && without > noise)}};
  figure.tables = {std::move(samples), std::move(curves)};
  return figure;
}

namespace {

double value(const std::vector<double>& polynomial, double d) {
  double sum = 0;
  for (std::size_t k = polynomial.size(); k-- > 0;) sum = sum * d + polynomial[k];
  return sum;
}

// The order of the first derivative of a polynomial that is not 0 at d = 1, where the function goes on as 0.
int first_jump(std::vector<double> polynomial) {
  constexpr double zero = 1e-9;
  int order = 0;
  while (std::abs(value(polynomial, 1)) < zero) {
    std::vector<double> derivative;
    for (std::size_t k = 1; k < polynomial.size(); ++k) derivative.push_back(static_cast<double>(k) * polynomial[k]);
    polynomial = std::move(derivative);
    ++order;
  }
  return order;
}

}  // namespace

Figure figure_6_3() {
  struct Decay {
    const char* name;
    std::vector<double> polynomial;
    int printed;  // -1: not in the thesis
  };
  const std::vector<Decay> all = {{"1 - d", {1, -1}, 0},
                                  {"1 - 3 d^2 + 2 d^3", {1, 0, -3, 2}, 1},
                                  {"(d^2 - 1)^2", {1, 0, -2, 0, 1}, 2},
                                  {"1 - 10 d^3 + 15 d^4 - 6 d^5", {1, 0, 0, -10, 15, -6}, 3},
                                  {"1 - 35 d^4 + 84 d^5 - 70 d^6 + 20 d^7", {1, 0, 0, 0, -35, 84, -70, 20}, -1}};
  Figure figure{.name = "figure-6.3",
                .title = "Fig. 6.3: decay functions of the weights",
                .text =
                    "(6.11)-(6.14) over the distance d from the centre of a patch, 0 beyond 1, and one that the "
                    "thesis does not have. A function has as many continuous derivatives at 1 as vanish there. The "
                    "library takes products of (1 - t^2)^4, three continuous derivatives."};
  Table curves{.name = "decay", .columns = {"d"}};
  constexpr int steps = 120;
  for (int i = 0; i <= steps; ++i) curves.rows.push_back({1.2 * i / steps});
  for (const Decay& decay : all) {
    const int continuous = first_jump(decay.polynomial) - 1;
    curves.columns.push_back(std::string(decay.name) + " (C" + std::to_string(continuous) + ")");
    for (auto& row : curves.rows) row.push_back(row[0] < 1 ? value(decay.polynomial, row[0]) : 0);
    const bool known = decay.printed >= 0;
    figure.claims.push_back({std::string("smoothness of ") + decay.name,
                             known ? "C" + std::to_string(decay.printed) : "-", "C" + std::to_string(continuous),
                             known ? verdict(continuous == decay.printed) : Verdict::not_comparable});
  }
  figure.tables = {std::move(curves)};
  return figure;
}

}  // namespace csrbf::thesis
