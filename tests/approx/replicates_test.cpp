#include "approx/approx_testing.hpp"
#include "csrbf/approx/fit.hpp"

#include <numeric>

namespace csrbf::replicates_test {
namespace {

// `each` samples at every place, with noise.
Samples<2> repeated(const Points<2>& places, Index each, double noise,
                    const std::function<double(const Point<2>&)>& f) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> error(0, noise);
  Samples<2> data{Points<2>(2, each * places.cols()), Eigen::MatrixXd(each * places.cols(), 1), {}};
  for (Index i = 0; i < data.size(); ++i) {
    data.points.col(i) = places.col(i / each);
    data.values(i, 0) = f(data.points.col(i)) + error(random);
  }
  return data;
}

double left(const Point<2>& p) {
  return p[0];
}

TEST(Replicates, TellTheNoiseOfFewPlaces) {
  for (const Index places : {1, 2, 3, 4}) {
    const Fit<2> fit = csrbf::fit<2>(repeated(random_points<2>(places, 1), 40, .3, left));
    ASSERT_EQ(fit.variances.size(), 1u) << places;
    const Eigen::VectorXd variance = fit.variances[0]->evaluate(random_points<2>(places, 1)).value;
    EXPECT_NEAR(std::sqrt(variance.mean()), .3, .06) << places;
  }
}

TEST(Replicates, TellTheNoiseOfPlacesWithOneMean) {
  Samples<2> data = repeated(random_points<2>(6, 1), 20, 1, [](const Point<2>&) { return 0.; });
  for (Index i = 0; i < data.size(); ++i) data.values(i, 0) = i % 2 == 0 ? .5 : 1.5;
  const Fit<2> fit = csrbf::fit<2>(data);
  EXPECT_NEAR(fit.report.noise.at(0), .5, .05);
  EXPECT_NEAR(std::sqrt(fit.variances.at(0)->evaluate(data.points).value.mean()), .5, .05);
}

// The same subjects at every place: their means follow the function more closely than their scatter suggests.
TEST(Replicates, TellTheNoiseOfPlacesWithSmoothMeans) {
  constexpr double scatter = .5;
  Samples<2> data = repeated(random_points<2>(12, 1), 20, 1, left);
  for (Index i = 0; i < data.size(); ++i)
    data.values(i, 0) = left(data.points.col(i)) + (i % 2 == 0 ? -1 : 1) * scatter;
  const Fit<2> fit = csrbf::fit<2>(data);
  EXPECT_NEAR(fit.report.noise.at(0), scatter, .1 * scatter);
  EXPECT_NEAR(std::sqrt(fit.variances.at(0)->evaluate(data.points).value.mean()), scatter, .1 * scatter);
}

// Rows that are there many times, as after files were joined.
TEST(Replicates, AreNoneWhereRowsAreCopies) {
  const Samples<2> once = repeated(random_points<2>(600, 1), 1, .2, franke);
  std::vector<Index> rows(600);
  std::iota(rows.begin(), rows.end(), Index{0});
  for (Index i = 0; i < 600; ++i) rows.insert(rows.end(), i % 3 == 0 ? 7 : 0, i);
  const Fit<2> fit = csrbf::fit<2>({once.points(Eigen::all, rows), once.values(rows, Eigen::all), {}});
  EXPECT_NEAR(fit.report.noise.at(0), .2, .03);
  const Points<2> x = random_points<2>(300, 2);
  const Eigen::VectorXd f = csrbf::fit<2>(once).components[0]->evaluate(x).value;
  EXPECT_LE((fit.components[0]->evaluate(x).value - f).norm(), .01 * f.norm());  // with a weight of 8 for some: .1
}

// The same where some places were measured again, and not where whole numbers are equal by chance.
TEST(Replicates, AreToldFromCopies) {
  const Samples<2> once = repeated(random_points<2>(600, 1), 2, .2, franke);
  std::vector<Index> rows;
  for (Index i = 0; i < 1200; i += 2) rows.insert(rows.end(), i % 6 == 0 ? 8 : 1, i);
  for (Index i = 3; i < 60; i += 2) rows.push_back(i);
  const Fit<2> fit = csrbf::fit<2>({once.points(Eigen::all, rows), once.values(rows, Eigen::all), {}});
  EXPECT_NEAR(fit.report.noise.at(0), .2, .03);
  Samples<2> whole = repeated(random_points<2>(200, 1), 4, .7, [](const Point<2>& p) { return 3 * p[0]; });
  whole.values = whole.values.array().round();
  EXPECT_NEAR(csrbf::fit<2>(whole).report.noise.at(0), std::hypot(.7, std::sqrt(1. / 12)), .05);
}

// Of many places, some with many samples and most with one.
TEST(Replicates, TellTheNoiseOfManyPlaces) {
  const Points<2> places = random_points<2>(3000, 1);
  Samples<2> data = repeated(places, 8, .2, franke);
  std::vector<Index> rows;
  for (Index i = 0; i < data.size(); ++i)
    if (i % 8 == 0 || (i / 8) % 3 == 0) rows.push_back(i);
  data = Samples<2>{data.points(Eigen::all, rows), data.values(rows, Eigen::all), {}};
  for (const std::string method : {"auto", "partition-of-unity"}) {
    const Fit<2> fit = csrbf::fit<2>(data, {.method = method});
    ASSERT_EQ(fit.report.method, method == "auto" ? "interpolate" : method);
    const Eigen::VectorXd deviation = fit.variances.at(0)->evaluate(places).value.cwiseSqrt();
    EXPECT_NEAR(deviation.mean(), .2, .02) << method;
  }
}

// Where centres are fitted, a place is a sample of the weight of those at it.
TEST(Replicates, TellTheErrorOfTheFunctionToo) {
  const auto f = [](const Point<2>& p) { return std::sin(3 * p[0]) * std::cos(2 * p[1]); };
  const Fit<2> fit = csrbf::fit<2>(repeated(random_points<2>(3000, 1), 3, .2, f));
  ASSERT_EQ(fit.report.method, "interpolate");
  EXPECT_NEAR(fit.report.noise.at(0), .2, .01);
  const Eigen::VectorXd variance = fit.variances.at(0)->evaluate(random_points<2>(100, 3)).value;
  EXPECT_LE(std::sqrt(variance.mean() - std::pow(fit.report.noise.at(0), 2)), .04);  // as if each weighed 1: .1
}

}  // namespace
}  // namespace csrbf::replicates_test
