#include "csrbf/approx/basis/expansion.hpp"

#include "approx/approx_testing.hpp"
#include "core/error_testing.hpp"
#include "csrbf/core/parallel.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace csrbf::expansion_test {
namespace {

constexpr double rounding = 1e-12;  // sums of some hundred terms of order one, in another order

template <int Dim>
using Matrix = Eigen::Matrix<double, Dim, Dim>;

template <int Dim>
Eigen::VectorXd random_vector(Index n, unsigned seed) {
  return random_points<1>(n, seed).transpose().array() - .5;
}

// The definition, summed term by term over all centres and over repetitions within `images` periods.
template <int Dim>
double direct_sum(const Expansion<Dim>& f, const Point<Dim>& x) {
  const RadialBasis<Dim>& basis = f.basis();
  double sum = 0;
  for (Index j = 0; j < basis.size(); ++j) {
    const auto& transforms = basis.metric().transforms;
    const Matrix<Dim> T = transforms.empty() ? Matrix<Dim>::Identity()
                                             : transforms[transforms.size() == 1 ? 0 : static_cast<std::size_t>(j)];
    const double r = (T * (x - basis.centers().col(j))).norm() / basis.support(j);
    sum += f.coefficients()[j] * basis.kernel().value(r);
  }
  return sum;
}

template <int Dim>
void expect_direct_sums(const Expansion<Dim>& f, const Points<Dim>& x) {
  const Eigen::VectorXd value = f.evaluate(x).value;
  for (Index i = 0; i < x.cols(); ++i) EXPECT_NEAR(value[i], direct_sum<Dim>(f, x.col(i)), rounding);
}

// Supports over a wide range: several trees.
Eigen::VectorXd mixed_supports(Index n, unsigned seed) {
  return (6 * random_points<1>(n, seed).transpose().array() - 5).exp();
}

template <class T>
class ExpansionIn : public testing::Test {};
template <int Dim>
using InDimension = std::integral_constant<int, Dim>;
using AllDimensions =
    testing::Types<InDimension<1>, InDimension<2>, InDimension<3>, InDimension<4>, InDimension<5>, InDimension<6>>;
TYPED_TEST_SUITE(ExpansionIn, AllDimensions);

TEST(Expansion, IsTheKernelForOneCentre) {
  const auto f = make_expansion<2>(Kernel("wendland-c2", 2), Point<2>(1, 2), Eigen::VectorXd::Constant(1, 4.0),
                                   Eigen::VectorXd::Constant(1, 3.0));
  EXPECT_DOUBLE_EQ((*f)(Point<2>(1, 2)), 3);
  EXPECT_NEAR((*f)(Point<2>(3, 2)), 3 * .1875, rounding);  // phi_{3,1}(1/2)
  EXPECT_EQ((*f)(Point<2>(1, 6)), 0);
  EXPECT_EQ(f->feature_size(), 4);
}

TYPED_TEST(ExpansionIn, IsTheSumOverAllCentresForEverySupport) {
  constexpr int Dim = TypeParam::value;
  const Index n = 300;
  const Points<Dim> x = random_points<Dim>(200, 3);
  for (const char* kernel : {"wendland-c0", "wendland-c2", "wendland-c6", "gaussian"}) {
    for (const bool mixed : {false, true}) {
      const Eigen::VectorXd supports = mixed ? mixed_supports(n, 2) : Eigen::VectorXd::Constant(1, .6);
      expect_direct_sums<Dim>(
          *make_expansion<Dim>(Kernel(kernel, Dim), random_points<Dim>(n, 1), supports, random_vector<Dim>(n, 4)), x);
    }
  }
}

TYPED_TEST(ExpansionIn, HasTrueGradientsAndHessians) {
  constexpr int Dim = TypeParam::value;
  const Index n = 60;
  PolynomialTail<Dim> tail{2, Point<Dim>::Constant(.3), 2, {}};
  tail.coefficients = random_vector<Dim>((Dim + 1) * (Dim + 2) / 2, 5);
  const Points<Dim> x = random_points<Dim>(30, 3);
  const Eigen::VectorXd supports = 1.5 + mixed_supports(n, 2).array();
  for (const char* kernel : {"wendland-c4", "gaussian"}) {
    const auto f =
        make_expansion<Dim>(Kernel(kernel, Dim), random_points<Dim>(n, 1), supports, random_vector<Dim>(n, 4), tail);
    expect_true_derivatives<Dim>(*f, x, 1e-5, 1e-7);
  }
}

TYPED_TEST(ExpansionIn, MeasuresDistancesByACommonMetricOrOnePerCentre) {
  constexpr int Dim = TypeParam::value;
  const Index n = 40;
  const Points<Dim> x = random_points<Dim>(30, 3);
  RadialMetric<Dim> common;
  common.transforms = {Matrix<Dim>::Identity() + .5 * random_points<Dim>(Dim, 8)};
  RadialMetric<Dim> own;
  for (Index j = 0; j < n; ++j)
    own.transforms.push_back(Matrix<Dim>::Identity() + .5 * random_points<Dim>(Dim, 10 + static_cast<unsigned>(j)));
  for (const auto& metric : {common, own}) {
    const auto f = make_expansion<Dim>(Kernel("wendland-c4", Dim), random_points<Dim>(n, 1),
                                       Eigen::VectorXd::Constant(1, .9), random_vector<Dim>(n, 4), {}, metric);
    expect_direct_sums<Dim>(*f, x);
    expect_true_derivatives<Dim>(*f, x, 1e-5, 1e-6);
  }
}

TYPED_TEST(ExpansionIn, AgreesWithItsSparseAndDenseMatrices) {
  constexpr int Dim = TypeParam::value;
  const Index n = 200;
  const Points<Dim> x = random_points<Dim>(150, 3);
  const Eigen::VectorXd alpha = random_vector<Dim>(n, 4);
  const auto f = make_expansion<Dim>(Kernel("wendland-c2", Dim), random_points<Dim>(n, 1), mixed_supports(n, 2), alpha);
  const Eigen::VectorXd value = f->evaluate(x).value;
  const auto B = f->basis().matrix(x);
  EXPECT_LT((B * alpha - value).cwiseAbs().maxCoeff(), rounding);
  EXPECT_LT((f->basis().dense_matrix(x) * alpha - value).cwiseAbs().maxCoeff(), rounding);
  for (Index k = 0; k < B.rows(); ++k)
    EXPECT_TRUE(std::is_sorted(B.innerIndexPtr() + B.outerIndexPtr()[k], B.innerIndexPtr() + B.outerIndexPtr()[k + 1]));
}

TEST(Expansion, DoesNotDependOnTheOrderOfThePoints) {
  const auto f = make_expansion<2>(Kernel("wendland-c2", 2), random_points<2>(2000, 1), mixed_supports(2000, 2),
                                   random_vector<2>(2000, 4));
  const Points<2> x = random_points<2>(10000, 3);  // enough to be sorted
  const Eigen::VectorXd value = f->evaluate(x).value;
  for (Index i = 0; i < x.cols(); i += 97) EXPECT_EQ(value[i], (*f)(x.col(i)));
}

TEST(Expansion, DoesNotDependOnTheNumberOfThreads) {
  const auto f = make_expansion<3>(Kernel("wendland-c2", 3), random_points<3>(2000, 1), mixed_supports(2000, 2),
                                   random_vector<3>(2000, 4));
  const Points<3> x = random_points<3>(3000, 3);
  set_thread_count(1);
  const Jet<3> one = f->evaluate(x, Derivatives::hessian);
  const auto matrix = f->basis().matrix(x);
  set_thread_count(3);
  const Jet<3> three = f->evaluate(x, Derivatives::hessian);
  const auto again = f->basis().matrix(x);
  set_thread_count(0);
  EXPECT_EQ(one.value, three.value);
  EXPECT_EQ(one.gradient, three.gradient);
  EXPECT_EQ(one.hessian, three.hessian);
  EXPECT_EQ((matrix - again).norm(), 0);
}

TEST(Expansion, IsPeriodicAlongPeriodicAxes) {
  RadialMetric<2> metric;
  metric.periods = {2, 0};
  Points<2> centers = random_points<2>(50, 1);
  centers.row(0) *= 6;  // over three periods
  // The support reaches beyond one period.
  const auto f = make_expansion<2>(Kernel("wendland-c4", 2), centers, Eigen::VectorXd::Constant(1, 2.3),
                                   random_vector<2>(50, 4), {}, metric);
  const Points<2> x = random_points<2>(40, 3);
  const Eigen::VectorXd value = f->evaluate(x).value;
  for (const double shift : {-4.0, 2.0, 20.0}) {
    const Points<2> shifted = x.colwise() + Point<2>(shift, 0);
    EXPECT_LT((f->evaluate(shifted).value - value).cwiseAbs().maxCoeff(), rounding);
  }
  expect_true_derivatives<2>(*f, x, 1e-5, 1e-6);
  const Eigen::MatrixXd A = f->basis().matrix(centers);
  EXPECT_LT((A - A.transpose()).cwiseAbs().maxCoeff(), rounding);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvalues().minCoeff(), 0);
}

// Interpolates a ridge that varies ten times as fast along x as along y.
double ridge_error(const RadialMetric<2>& metric, double support) {
  const auto ridge = [](const Point<2>& p) { return std::sin(12 * p[0]) * std::cos(1.2 * p[1]); };
  const Samples<2> data = sample<2>(random_points<2>(300, 1), ridge);
  const auto basis = std::make_shared<const RadialBasis<2>>(Kernel("wendland-c4", 2), data.points,
                                                            Eigen::VectorXd::Constant(1, support), metric);
  const Eigen::VectorXd alpha = basis->dense_matrix(data.points).ldlt().solve(data.values.col(0));
  return rms_error<2>(Expansion<2>(basis, alpha), ridge);
}

TEST(Expansion, ErrsLessWhenItsMetricFollowsTheData) {
  RadialMetric<2> stretched;
  stretched.transforms = {Eigen::Vector2d(std::sqrt(10), 1 / std::sqrt(10)).asDiagonal()};
  // Supports of the same area, in which are as many centres.
  EXPECT_LT(ridge_error(stretched, 1), .4 * ridge_error({}, 1));
}

// Waves in rings, with centres closer to each other across the rings than along them: least squares with a metric per
// centre, or with circular supports of the same area.
double ring_error(bool own_metrics) {
  const Point<2> middle(.5, -.3);
  const auto ring = [&](const Point<2>& p) { return std::sin(25 * (p - middle).norm()); };
  const Samples<2> data = sample<2>(random_points<2>(2000, 1), ring);
  constexpr double across = .25, along = 1.2;  // radii of the supports
  Points<2> centers(2, 0);
  RadialMetric<2> metric;
  for (double radius = .25; radius < 1.5; radius += .06)
    for (double angle = .2; angle < 3; angle += .3) {
      const Point<2> direction(std::cos(angle), std::sin(angle));
      const Point<2> center = middle + radius * direction;
      if ((center.array() - .5).abs().maxCoeff() > .6) continue;
      centers.conservativeResize(Eigen::NoChange, centers.cols() + 1);
      centers.rightCols(1) = center;
      const Matrix<2> projection = direction * direction.transpose();
      if (own_metrics) metric.transforms.push_back(projection / across + (Matrix<2>::Identity() - projection) / along);
    }
  const double support = own_metrics ? 1 : std::sqrt(across * along);
  const auto basis = std::make_shared<const RadialBasis<2>>(Kernel("wendland-c2", 2), centers,
                                                            Eigen::VectorXd::Constant(1, support), metric);
  const Eigen::MatrixXd B = basis->dense_matrix(data.points);
  const Eigen::VectorXd alpha = B.colPivHouseholderQr().solve(data.values.col(0));
  return rms_error<2>(Expansion<2>(basis, alpha), ring);
}

TEST(Expansion, ErrsLessWhenTheMetricOfEveryCentreFollowsTheData) {
  EXPECT_LT(ring_error(true), .5 * ring_error(false));
}

TEST(Expansion, ScalesWithTheData) {
  const Points<2> centers = random_points<2>(100, 1);
  const Points<2> x = random_points<2>(100, 3);
  const Eigen::VectorXd alpha = random_vector<2>(100, 4);
  const Kernel kernel("wendland-c2", 2);
  const auto f = make_expansion<2>(kernel, centers, Eigen::VectorXd::Constant(1, .4), alpha);
  for (const double factor : {1e-30, 1e30}) {
    const Points<2> scaled = factor * centers;
    const Points<2> where = factor * x;
    const auto g = make_expansion<2>(kernel, scaled, Eigen::VectorXd::Constant(1, .4 * factor), alpha);
    EXPECT_LT((g->evaluate(where).value - f->evaluate(x).value).cwiseAbs().maxCoeff(), rounding);
  }
}

TEST(Expansion, AddsItsPolynomialInBlocksOfAnySize) {
  const PolynomialTail<2> tail{1, {1, 1}, 2, Eigen::Vector3d(5, 4, 2)};
  const auto f = make_expansion<2>(Kernel("wendland-c2", 2), Points<2>(2, 0), Eigen::VectorXd::Ones(1), {}, tail);
  for (const Index n : {0, 1, 512, 513, 1031}) {
    const Points<2> x = random_points<2>(n, 11);
    Jet<2> jet(n, Derivatives::hessian);
    f->evaluate_block(x, {jet.value.data(), jet.gradient.data(), jet.hessian.data()});
    for (Index i = 0; i < n; ++i) {
      EXPECT_NEAR(jet.value[i], 5 + 4 * (x(0, i) - 1) / 2 + 2 * (x(1, i) - 1) / 2, rounding);
      EXPECT_LT((jet.gradient.col(i) - Point<2>(2, 1)).norm(), rounding);
      EXPECT_EQ(jet.hessian.col(i), Eigen::Vector3d::Zero());
    }
  }
}

TEST(Expansion, IsItsPolynomialWithoutCentres) {
  PolynomialTail<2> tail{1, {1, 1}, 2, Eigen::Vector3d(5, 4, 2)};
  const auto f = make_expansion<2>(Kernel("wendland-c2", 2), Points<2>(2, 0), Eigen::VectorXd::Ones(1), {}, tail);
  EXPECT_DOUBLE_EQ((*f)(Point<2>(3, 5)), 5 + 4 * 1 + 2 * 2);
}

TEST(Expansion, RefusesWhatItCannotRepresent) {
  const Kernel kernel("wendland-c2", 2);
  const Points<2> centers = random_points<2>(3, 1);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  const Eigen::VectorXd alpha = Eigen::VectorXd::Ones(3);
  EXPECT_EQ(invalid_input_message([&] { make_expansion<2>(kernel, centers, one, one); }),
            "RadialBasis: coefficients = 1: there must be one per centre");
  EXPECT_EQ(invalid_input_message([&] { make_expansion<2>(kernel, centers, Eigen::VectorXd::Ones(2), alpha); }),
            "RadialBasis: supports = 2: there must be one support or one per centre");
  EXPECT_EQ(invalid_input_message([&] { make_expansion<2>(kernel, centers, 0 * one, alpha); }),
            "RadialBasis: supports = not positive or not finite: every support must be positive and finite");
  EXPECT_EQ(invalid_input_message([&] { make_expansion<2>(kernel, centers * std::nan(""), one, alpha); }),
            "RadialBasis: centers = NaN or infinity: every coordinate must be finite");
  EXPECT_EQ(invalid_input_message([&] {
              make_expansion<2>(kernel, centers, one, alpha, {}, {{Matrix<2>::Zero()}, {0, 0}});
            }),
            "RadialBasis: transforms = singular or not finite: every transform must be invertible");
  EXPECT_EQ(invalid_input_message([&] {
              make_expansion<2>(Kernel("gaussian", 2), centers, one, alpha, {}, {{}, {1, 0}});
            }),
            "RadialBasis: kernel = gaussian: periodic axes need a compactly supported kernel; choose wendland-c2 or "
            "another one");
  EXPECT_EQ(invalid_input_message([&] {
              make_expansion<2>(kernel, centers, one, alpha, {0, {0, 0}, 1, {}});
            }),
            "Expansion: tail.coefficients = 0: there must be one per monomial of the degree");
  EXPECT_EQ(invalid_input_message(
                [&] { make_expansion<2>(Kernel("gaussian", 2), centers, one, alpha)->basis().matrix(centers).sum(); }),
            "RadialBasis: kernel = gaussian: a sparse matrix needs a compactly supported kernel");
}

}  // namespace
}  // namespace csrbf::expansion_test
