#include "introduction.hpp"

#include "csrbf/approx/fit.hpp"
#include "k_space.hpp"
#include "signals.hpp"

namespace csrbf::thesis {
namespace {

Table table_of(const std::string& name, const Points<2>& points) {
  Table table{.name = name, .columns = {"x", "y"}};
  for (const auto& p : points.colwise()) table.rows.push_back({p.x(), p.y()});
  return table;
}

// Measured every night but for cloudy weeks: brightness of a star of two periods.
double brightness(double day) {
  return 1 + 0.3 * std::sin(day / 9) + 0.2 * std::sin(day / 5.3 + 1);
}

bool cloudy(int day) {
  return (day > 31 && day < 38) || (day > 70 && day < 83) || day % 17 == 5;
}

void add_gaps(Figure& figure) {
  constexpr int days = 121;
  Table measured{.name = "measured", .columns = {"day", "brightness"}};
  for (int day = 0; day < days; ++day)
    if (!cloudy(day)) measured.rows.push_back({static_cast<double>(day), brightness(day)});
  const auto n = static_cast<Index>(measured.rows.size());
  Points<1> at(1, n);
  Eigen::VectorXd values(n);
  for (Index i = 0; i < n; ++i) at(0, i) = measured.rows[i][0], values[i] = measured.rows[i][1];
  const Points<1> x = (days - 1) * line(1201);
  const Eigen::VectorXd found = fit<1>({at, values, {}}).components[0]->evaluate(x).value;
  Table curves{.name = "curves", .columns = {"day", "truth", "fit"}};
  double covered = 0, gap = 0;
  for (Index i = 0; i < x.cols(); ++i) {
    const double day = x(0, i), truth = brightness(day);
    const bool in_gap = cloudy(static_cast<int>(std::floor(day))) || cloudy(static_cast<int>(std::ceil(day)));
    double& largest = in_gap ? gap : covered;
    largest = std::max(largest, std::abs(found[i] - truth));
    curves.rows.push_back({day, truth, found[i]});
  }
  figure.tables.push_back(std::move(measured));
  figure.tables.push_back(std::move(curves));
  figure.claims.push_back(
      {"Fig. 3: a signal from regular samples of which some are missing", "to be reconstructed",
       "largest error " + number(covered, 2) + " where samples are, " + number(gap, 2) + " in the gaps; amplitude 0.5",
       verdict(covered < 0.005 && gap < 0.25)});
}

}  // namespace

Figure introduction() {
  Figure figure{.name = "introduction",
                .title = "Introduction of Part II, Figs. 1 and 3: where samples may lie",
                .text =
                    "Uniform samples and samples on spokes, as a scanner takes them in the Fourier space (what becomes "
                    "of these: see k-space); and a signal that is measured every day but for gaps of up to 12 days, "
                    "with the default fit."};
  figure.tables = {table_of("uniform", lattice(17, -1, 1)), table_of("polar", trajectory(Trajectory::radial, 16) / 8)};
  add_gaps(figure);
  return figure;
}

}  // namespace csrbf::thesis
