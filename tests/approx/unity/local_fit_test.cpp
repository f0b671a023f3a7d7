#include "csrbf/approx/unity/local_fit.hpp"

#include "approx/partition_testing.hpp"
#include "csrbf/approx/unity/patch_samples.hpp"

#include <Eigen/Dense>

#include <array>

namespace csrbf::local_fit_test {
namespace {

constexpr double solved = 1e-7;  // normal equations of condition up to about 1e8, values of size 1

// Samples in the order of a cover, as a fitter takes them.
template <int Dim>
struct Problem {
  Problem(const Samples<Dim>& samples, Index leaf_size)
      : cover(samples.points, leaf_size, 1.5),
        values(samples.values(cover.order(), Eigen::all)),
        weights(samples.weights.size() == 0 ? samples.weights : Eigen::VectorXd(samples.weights(cover.order()))) {}

  LocalModels<Dim> fit(const LocalOptions& options, const std::vector<Index>& cells) const {
    LocalFitter<Dim> fitter(cover, values, weights, options);
    LocalModels<Dim> models = fitter.models();
    models.resize(static_cast<Index>(cells.size()));
    for (std::size_t first = 0; first < cells.size(); first += batch_lanes) {
      const auto count = static_cast<int>(std::min<std::size_t>(batch_lanes, cells.size() - first));
      fitter.fit(cells.data() + first, count, models, static_cast<Index>(first));
    }
    return models;
  }

  Cover<Dim> cover;
  Eigen::MatrixXd values;
  Eigen::VectorXd weights;
};

template <int Dim>
Problem<Dim> random_problem(Index n, bool weighted = false) {
  Samples<Dim> samples = sample<Dim>(random_points<Dim>(n, 1), waves<Dim>);
  samples.values.conservativeResize(Eigen::NoChange, 2);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (Index i = 0; i < n; ++i) samples.values(i, 1) = normal(random);
  if (weighted) samples.weights = (0.5 + random_points<1>(n, 4).transpose().array()).matrix();
  return Problem<Dim>(samples, 20);
}

// Squared distances and numbers of the samples nearest to the middle of a cell.
template <int Dim>
std::vector<std::pair<double, std::uint32_t>> nearest(const Problem<Dim>& problem, Index cell, Index count) {
  const Points<Dim>& points = problem.cover.points();
  std::vector<std::pair<double, std::uint32_t>> all;
  for (Index i = 0; i < points.cols(); ++i)
    all.emplace_back((points.col(i) - problem.cover.cell(cell).center()).squaredNorm(), static_cast<std::uint32_t>(i));
  std::sort(all.begin(), all.end());
  all.resize(std::min(count, points.cols()));
  return all;
}

// Three cells with nearest samples all around them, which are taken as they are.
template <int Dim>
std::array<Index, 3> even_cells(const Problem<Dim>& problem, Index samples) {
  std::array<Index, 3> cells{};
  std::size_t count = 0;
  for (Index i = 0; i < problem.cover.size() && count < 3; ++i)
    if (!lopsided<Dim>(problem.cover.points(), nearest(problem, i, samples))) cells[count++] = i;
  EXPECT_EQ(count, 3U);
  return cells;
}

// The systems of one patch as dense matrices.
template <int Dim>
struct Dense {
  Dense(const Problem<Dim>& problem, Index cell, const LocalOptions& options) {
    const Points<Dim>& points = problem.cover.points();
    const Point<Dim> center = problem.cover.cell(cell).center();
    const auto chosen = nearest(problem, cell, options.samples);
    std::vector<Index> ids;
    for (const auto& [d2, id] : chosen) ids.push_back(id);
    const auto n = static_cast<Index>(ids.size()), M = std::min(options.centers, n);
    const double radius = (points.col(ids.back()) - center).norm();
    q = (points(Eigen::all, ids).colwise() - center) / radius;
    s = problem.values(ids, Eigen::all);
    w = problem.weights.size() == 0 ? Eigen::VectorXd::Ones(n).eval() : Eigen::VectorXd(problem.weights(ids));
    const Polynomials<Dim> monomials(options.degree);
    P.resize(n, monomials.size());
    monomials.rows(q, P.data());
    const Kernel kernel(options.kernel, Dim);
    A.resize(n, M);
    for (Index j = 0; j < M; ++j) {
      rows.push_back(j * n / M);
      for (Index i = 0; i < n; ++i) A(i, j) = kernel.value((q.col(i) - q.col(rows.back())).norm() / options.support);
    }
    lambda = options.smoothing;
  }

  // Least squares of all unknowns, without the sample `left_out`: minimises sum w (F b - s)^2 + lambda alpha^T A alpha.
  Eigen::MatrixXd least_squares(Index left_out = -1) const {
    const Index n = P.rows(), Q = P.cols(), M = A.cols();
    Eigen::MatrixXd F = Eigen::MatrixXd::Zero(n + M, Q + M), b = Eigen::MatrixXd::Zero(n + M, s.cols());
    Eigen::VectorXd roots = w.cwiseSqrt();
    if (left_out >= 0) roots[left_out] = 0;
    F.topRows(n) << roots.asDiagonal() * P, roots.asDiagonal() * A;
    b.topRows(n) = roots.asDiagonal() * s;
    if (lambda > 0 && M > 0)
      F.bottomRightCorner(M, M) =
          std::sqrt(lambda) * Eigen::MatrixXd(A(rows, Eigen::all)).llt().matrixU().toDenseMatrix();
    return F.colPivHouseholderQr().solve(b);
  }

  // A least squares polynomial, then the radial functions.
  Eigen::MatrixXd interpolant() const {
    Eigen::MatrixXd b(P.cols() + A.cols(), s.cols());
    Eigen::MatrixXd residual = s;
    if (P.cols() > 0) {
      const Eigen::VectorXd roots = w.cwiseSqrt();
      b.topRows(P.cols()) = (roots.asDiagonal() * P).colPivHouseholderQr().solve(roots.asDiagonal() * s);
      residual -= P * b.topRows(P.cols());
    }
    b.bottomRows(A.cols()) = regularised().fullPivLu().solve(residual);
    return b;
  }

  // Sample k minus its prediction by the interpolant of the others with the polynomial as part of it.
  Eigen::RowVectorXd left_out_error(Index k) const {
    const Index n = P.rows(), Q = P.cols();
    std::vector<Index> others;
    for (Index i = 0; i < n; ++i)
      if (i != k) others.push_back(i);
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n - 1 + Q, n - 1 + Q), b = Eigen::MatrixXd::Zero(n - 1 + Q, s.cols());
    S.topLeftCorner(n - 1, n - 1) = regularised()(others, others);
    S.topRightCorner(n - 1, Q) = P(others, Eigen::all);
    S.bottomLeftCorner(Q, n - 1) = S.topRightCorner(n - 1, Q).transpose();
    b.topRows(n - 1) = s(others, Eigen::all);
    const Eigen::MatrixXd x = S.fullPivLu().solve(b);
    return s.row(k) - A(k, others) * x.topRows(n - 1) - P.row(k) * x.bottomRows(Q);
  }

  Eigen::MatrixXd regularised() const {
    return A + Eigen::MatrixXd((lambda * w.cwiseInverse() +
                                Eigen::VectorXd::Constant(w.size(), 1e-14 * static_cast<double>(w.size())))
                                   .asDiagonal());
  }

  Points<Dim> q;
  Eigen::MatrixXd s, P, A;  // values; monomials; kernel values of samples and centres
  Eigen::VectorXd w;
  std::vector<Index> rows;  // of the centres
  double lambda = 0;
};

// Values of all components of local function i at its samples.
template <int Dim>
Eigen::MatrixXd values_at(const LocalModels<Dim>& models, Index i, const Points<Dim>& q) {
  Eigen::MatrixXd value(q.cols(), models.components);
  for (Index k = 0; k < q.cols(); ++k)
    for (Index c = 0; c < models.components; ++c)
      value(k, c) = plain_value<Dim>(models, i, c, models.center.col(i) + models.radius[i] * q.col(k));
  return value;
}

TEST(LocalFit, ReproducesPolynomialsOfItsDegree) {
  for (int degree = 0; degree <= 5; ++degree) {
    const auto function = [&](const Point<2>& p) {
      return std::pow(1 + p[0] + 2 * p[1], degree) / std::pow(4, degree);
    };
    const Problem<2> problem(sample<2>(random_points<2>(400, 1), function), 20);
    for (const Index centers : {0, 10, 80}) {
      const LocalModels<2> models =
          problem.fit({.degree = degree, .samples = 80, .centers = centers, .smoothing = 1e-3}, {0, 3, 7});
      for (Index i = 0; i < 3; ++i) {
        const Points<2> q = (random_points<2>(20, 5).array() - .5).matrix();
        const Eigen::MatrixXd value = values_at<2>(models, i, q);
        for (Index k = 0; k < q.cols(); ++k)
          EXPECT_NEAR(value(k, 0), function(models.center.col(i) + models.radius[i] * q.col(k)), solved);
      }
    }
  }
}

template <int Dim>
void expect_interpolation(const LocalOptions& options) {
  const auto problem = random_problem<Dim>(300);
  const std::array<Index, 3> cells = even_cells(problem, options.samples);
  const LocalModels<Dim> models = problem.fit(options, {cells.begin(), cells.end()});
  for (Index i = 0; i < 3; ++i) {
    const Dense<Dim> dense(problem, cells[i], options);
    EXPECT_LE((values_at<Dim>(models, i, dense.q) - dense.s).cwiseAbs().maxCoeff(), 1e-5) << Dim;
  }
}

// A support of one radius: systems of condition about 1e6. Values at random are far from what the polynomial can do.
TEST(LocalFit, InterpolatesWithACentreAtEverySample) {
  expect_interpolation<1>({.kernel = "wendland-c0", .support = 1, .degree = 1, .samples = 20, .centers = 20});
  expect_interpolation<2>({.kernel = "wendland-c2", .support = 1, .degree = 2, .samples = 40, .centers = 40});
  expect_interpolation<2>({.kernel = "wendland-c2", .support = 1, .degree = -1, .samples = 40, .centers = 99});
  expect_interpolation<3>({.kernel = "wendland-c2", .support = 1, .degree = 2, .samples = 60, .centers = 60});
  expect_interpolation<4>({.kernel = "matern-c2", .support = 1, .degree = 1, .samples = 60, .centers = 60});
  expect_interpolation<6>({.kernel = "wendland-c2", .support = 1, .degree = 1, .samples = 60, .centers = 60});
}

template <int Dim>
void expect_dense_solution(const LocalOptions& options, bool weighted) {
  const auto problem = random_problem<Dim>(300, weighted);
  const auto [a, b, c] = even_cells(problem, options.samples);
  const std::vector<Index> cells = {a, b, c, a, b, c, a, b, c, b};  // more than one batch
  const LocalModels<Dim> models = problem.fit(options, cells);
  for (const Index i : {0, 5, 9}) {
    const Dense<Dim> dense(problem, cells[i], options);
    const Eigen::MatrixXd x = options.centers < options.samples ? dense.least_squares() : dense.interpolant();
    const Eigen::MatrixXd at_samples = dense.P * x.topRows(dense.P.cols()) + dense.A * x.bottomRows(dense.A.cols());
    EXPECT_LE((values_at<Dim>(models, i, dense.q) - at_samples).cwiseAbs().maxCoeff(), solved)
        << Dim << " " << i << " " << options.degree << " " << options.centers << " " << options.smoothing;
  }
}

TEST(LocalFit, IsTheDenseLeastSquaresSolution) {
  for (const bool weighted : {false, true}) {
    expect_dense_solution<1>({.degree = 3, .samples = 30, .centers = 0}, weighted);
    expect_dense_solution<2>({.degree = 4, .samples = 60, .centers = 0}, weighted);
    expect_dense_solution<2>({.support = 1, .degree = 2, .samples = 60, .centers = 12}, weighted);
    expect_dense_solution<2>({.support = 2, .degree = -1, .samples = 60, .centers = 12, .smoothing = .1}, weighted);
    expect_dense_solution<3>({.degree = 2, .samples = 80, .centers = 20, .smoothing = 1}, weighted);
    expect_dense_solution<5>({.degree = 1, .samples = 80, .centers = 20, .smoothing = .01}, weighted);
  }
}

TEST(LocalFit, IsTheDenseSmoothingSolution) {
  for (const bool weighted : {false, true}) {
    expect_dense_solution<1>({.degree = 2, .samples = 20, .centers = 20, .smoothing = 1e-3}, weighted);
    expect_dense_solution<2>({.degree = 2, .samples = 40, .centers = 40, .smoothing = .1}, weighted);
    expect_dense_solution<3>({.kernel = "gaussian", .degree = 1, .samples = 50, .centers = 50, .smoothing = .01},
                             weighted);
    expect_dense_solution<4>({.degree = -1, .samples = 50, .centers = 50, .smoothing = .01}, weighted);
  }
}

template <int Dim>
void expect_left_out_errors(const LocalOptions& options, bool weighted) {
  constexpr Index targets = 6;
  const auto problem = random_problem<Dim>(200, weighted);
  LocalFitter<Dim> fitter(problem.cover, problem.values, problem.weights, options);
  LocalModels<Dim> models = fitter.models();
  models.resize(3);
  const std::array<Index, 3> cells = even_cells(problem, options.samples);
  fitter.fit(cells.data(), 3, models, 0);
  std::vector<double> error(batch_lanes * 2 * targets);
  fitter.left_out_errors(targets, error.data());
  for (Index lane = 0; lane < 3; ++lane) {
    const Dense<Dim> dense(problem, cells[lane], options);
    for (Index k = 0; k < targets; ++k) {
      Eigen::RowVectorXd expected(2);
      if (options.centers >= options.samples) {
        expected = dense.left_out_error(k);
      } else {
        const Eigen::MatrixXd b = dense.least_squares(k);
        expected =
            dense.s.row(k) - dense.P.row(k) * b.topRows(dense.P.cols()) - dense.A.row(k) * b.bottomRows(dense.A.cols());
      }
      for (Index c = 0; c < 2; ++c)
        EXPECT_NEAR(error[(lane * 2 + c) * targets + k], expected[c], 1e-5 * (1 + std::abs(expected[c])))
            << Dim << " " << weighted << " " << options.centers << " " << options.smoothing;
    }
  }
}

TEST(LocalFit, PredictsSamplesAsIfTheyWereLeftOut) {
  for (const bool weighted : {false, true}) {
    expect_left_out_errors<1>({.support = 1, .degree = 1, .samples = 15, .centers = 15}, weighted);
    expect_left_out_errors<2>({.support = 1, .degree = 2, .samples = 30, .centers = 30}, weighted);
    expect_left_out_errors<2>({.support = 2, .degree = -1, .samples = 30, .centers = 30, .smoothing = .1}, weighted);
    expect_left_out_errors<3>({.degree = 1, .samples = 40, .centers = 40, .smoothing = .01}, weighted);
    expect_left_out_errors<2>({.degree = 3, .samples = 50, .centers = 0}, weighted);
    expect_left_out_errors<2>({.support = 2, .degree = 1, .samples = 50, .centers = 10, .smoothing = .1}, weighted);
    expect_left_out_errors<4>({.degree = 1, .samples = 50, .centers = 10, .smoothing = 1}, weighted);
  }
}

TEST(LocalFit, CountsAWeightOfFourAsFourCopies) {
  const Samples<2> once = sample<2>(random_points<2>(60, 1), franke);
  Samples<2> weighted = once;
  weighted.weights = Eigen::VectorXd::Ones(60);
  Samples<2> copied{Points<2>(2, 63), Eigen::MatrixXd(63, 1), {}};
  copied.points.leftCols(60) = once.points;
  copied.values.topRows(60) = once.values;
  weighted.values(7) = copied.values(7) = 9;
  weighted.weights[7] = 4;
  for (Index i = 60; i < 63; ++i) {
    copied.points.col(i) = once.points.col(7);
    copied.values(i) = 9;
  }
  const LocalOptions options{.degree = 3, .samples = 100, .centers = 0};
  const LocalModels<2> one = Problem<2>(weighted, 100).fit(options, {0});
  const LocalModels<2> other = Problem<2>(copied, 100).fit(options, {0});
  const Points<2> q = (random_points<2>(20, 5).array() - .5).matrix();
  EXPECT_LE((values_at<2>(one, 0, q) - values_at<2>(other, 0, q)).cwiseAbs().maxCoeff(), solved);
}

TEST(LocalFit, FitsComponentsAndPatchesAsIfTheyWereAlone) {
  const auto both = random_problem<3>(300);
  for (const Index centers : {0, 20, 50}) {
    const LocalOptions options{.degree = 2, .samples = 50, .centers = centers, .smoothing = 1e-3};
    const LocalModels<3> together = both.fit(options, {0, 1, 2, 3, 4});
    Problem<3> alone = both;
    alone.values = both.values.col(1).eval();
    const LocalModels<3> single = alone.fit(options, {3});
    const Points<3> q = (random_points<3>(10, 5).array() - .5).matrix();
    EXPECT_EQ(single.center.col(0), together.center.col(3));
    EXPECT_EQ(single.radius[0], together.radius[3]);
    EXPECT_LE((values_at<3>(single, 0, q).col(0) - values_at<3>(together, 3, q).col(1)).cwiseAbs().maxCoeff(), solved);
  }
}

TEST(LocalFit, TakesAllSamplesWhereThereAreFewer) {
  const Problem<2> problem(sample<2>(random_points<2>(5, 1), franke), 2);
  const LocalModels<2> models = problem.fit({.degree = 1, .samples = 40, .centers = 40}, {0});
  EXPECT_EQ(models.centers_each, 5);
  for (Index k = 0; k < 5; ++k)
    EXPECT_NEAR(plain_value<2>(models, 0, 0, problem.cover.points().col(k)), problem.values(k, 0), solved);
}

TEST(LocalFit, LeavesTheModelsOfOthersAlone) {
  constexpr double untouched = 7;
  const auto problem = random_problem<3>(300);
  for (const Index centers : {0, 20, 50}) {
    const LocalOptions options{.degree = 1, .samples = 50, .centers = centers};
    LocalFitter<3> fitter(problem.cover, problem.values, problem.weights, options);
    LocalModels<3> models = fitter.models();
    models.resize(9);
    const auto parts = [](auto& of) { return std::array{&of.polynomial, &of.alpha, &of.position}; };
    models.center.setConstant(untouched);
    models.radius.setConstant(untouched);
    for (auto* part : parts(models)) std::fill(part->begin(), part->end(), untouched);
    constexpr Index no_cell = 1'000'000;
    const std::array<Index, batch_lanes> cells{2, 0, 4, no_cell, no_cell, no_cell, no_cell, no_cell};
    fitter.fit(cells.data(), 3, models, 4);
    const LocalModels<3> alone = problem.fit(options, {2, 0, 4});
    for (Index i = 0; i < 9; ++i) {
      const bool fitted = i >= 4 && i < 7;
      EXPECT_EQ(models.center.col(i), fitted ? alone.center.col(i - 4) : Point<3>::Constant(untouched).eval());
      EXPECT_EQ(models.radius[i], fitted ? alone.radius[i - 4] : untouched);
      for (std::size_t part = 0; part < 3; ++part) {
        const auto &all = *parts(models)[part], &expected = *parts(alone)[part];
        const std::size_t each = all.size() / 9, first = each * static_cast<std::size_t>(i);
        for (std::size_t k = 0; k < each; ++k)
          EXPECT_EQ(all[first + k], fitted ? expected[first - 4 * each + k] : untouched);
      }
    }
  }
}

// In its own coordinates an anisotropic patch spreads evenly, to a distance of one.
TEST(LocalFit, StretchesLongPatches) {
  Samples<2> samples = sample<2>(random_points<2>(60, 1), waves<2>);
  samples.points.row(1) *= 0.2;
  const Problem<2> problem(samples, 100);  // one cell
  for (const Index centers : {12, 60}) {
    const LocalModels<2> models = problem.fit(
        {.kernel = "wendland-c2", .support = 1, .degree = 1, .samples = 60, .centers = centers, .anisotropy = 1}, {0});
    ASSERT_TRUE(models.anisotropic);
    const Eigen::Matrix2d metric = Eigen::Map<const Eigen::Matrix2d>(models.metric.data());
    const Points<2> q = metric * (problem.cover.points().colwise() - models.center.col(0)) / models.radius[0];
    EXPECT_NEAR(q.colwise().norm().maxCoeff(), 1, solved);
    const Eigen::Matrix2d spread = q * q.transpose();
    EXPECT_NEAR(spread(0, 1), 0, solved * spread(0, 0));
    EXPECT_NEAR(spread(1, 1), spread(0, 0), solved * spread(0, 0));
    for (Index k = 0; k < 60 && centers == 60; ++k)
      EXPECT_NEAR(plain_value<2>(models, 0, 0, problem.cover.points().col(k)), problem.values(k, 0), solved);
  }
}

TEST(LocalFit, StretchesForRadialFunctionsOnly) {
  const auto problem = random_problem<2>(100);
  const auto stretched = [&](Index centers, double anisotropy) {
    return problem.fit({.degree = 1, .samples = 30, .centers = centers, .anisotropy = anisotropy}, {0}).anisotropic;
  };
  EXPECT_TRUE(stretched(1, 0.1));
  EXPECT_FALSE(stretched(0, 1));  // polynomials stay the same
  EXPECT_FALSE(stretched(30, 0));
}

// Two tracks: the nearest samples of a patch are on one of them.
TEST(LocalFit, LooksFurtherWhereTheNearestSamplesAreLopsided) {
  Points<2> tracks(2, 400);
  for (Index i = 0; i < 400; ++i) tracks.col(i) << static_cast<double>(i % 200) / 200, i < 200 ? .35 : .65;
  const auto function = [](const Point<2>& p) { return 1 + p[0] + 10 * p[1]; };
  const Problem<2> problem(sample<2>(tracks, function), 15);
  const Index cell = problem.cover.find(Point<2>(.5, .35));
  const LocalModels<2> models = problem.fit({.degree = 1, .samples = 30, .centers = 0}, {cell});
  const Point<2> between(.5, .5);
  EXPECT_NEAR(plain_value<2>(models, 0, 0, between), function(between), 1e-6);
  EXPECT_GE(models.radius[0], .2);  // both tracks
}

}  // namespace
}  // namespace csrbf::local_fit_test
