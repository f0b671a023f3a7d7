#include "csrbf/surface/winding/dipole_sums.hpp"

#include "surface/oriented_shapes.hpp"

namespace csrbf::winding::dipole_sums_test {
namespace {

using Vectors = DipoleSums::Vectors;

constexpr Index count = 1500;
// Of groups that act as one: root mean square and largest, relative to the largest sum.
constexpr double usual = 0.08, largest = 0.15;

template <class Found, class Expected>
void expect_close(const Found& found, const Expected& expected) {
  const auto difference = (found.template cast<double>() - expected).eval();
  const double scale = expected.cwiseAbs().maxCoeff();
  EXPECT_LT(std::sqrt(difference.squaredNorm() / static_cast<double>(difference.size())), usual * scale);
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), largest * scale);
}

class DipoleSumsTest : public ::testing::Test {
 protected:
  DipoleSumsTest() {
    for (Index i = 0; i < count; ++i) eps[i] = (0.5 + 0.3 * shape.normals(0, i)) * shape.spacing();
    sums.set_smoothing(eps);
    for (Index i = 0; i < count; ++i) dipoles.col(i) = shape.area / count * shape.normals.col(sums.order()[i]);
  }

  // Calls term(i, j, p_j - p_i, D) for all pairs, in the order of the sums.
  template <class Term>
  void for_pairs(const Term& term) const {
    for (Index i = 0; i < count; ++i)
      for (Index j = 0; j < count; ++j) {
        const Index a = sums.order()[i], b = sums.order()[j];
        const Point<3> r = shape.points.col(b) - shape.points.col(a);
        term(i, j, r, r.squaredNorm() + 0.5 * (eps[a] * eps[a] + eps[b] * eps[b]));
      }
  }

  Shape shape = random_torus(count, 5);
  Eigen::VectorXd eps{count};
  DipoleSums sums{shape.points};
  Points<3> dipoles{3, count};
};

TEST_F(DipoleSumsTest, AreThoseOfAllPairs) {
  Eigen::VectorXd w = Eigen::VectorXd::Zero(count);
  Points<3> outward = Points<3>::Zero(3, count);
  for_pairs([&](Index i, Index j, const Point<3>& r, double D) {
    const Point<3> m = dipoles.col(j) / (4 * std::numbers::pi);
    w[i] += m.dot(r) / std::pow(D, 1.5);
    outward.col(i) += (m - 3 * m.dot(r) / D * r) / std::pow(D, 1.5);
  });
  EXPECT_NEAR(w.mean(), 0.5, 0.1);
  expect_close(sums.winding(dipoles.cast<float>()), w);
  expect_close(sums.outward(dipoles.cast<float>()), outward);
}

TEST_F(DipoleSumsTest, TheAdjointIsThatOfAllPairs) {
  const Eigen::VectorXd r = Eigen::VectorXd::Random(count);
  Points<3> expected = Points<3>::Zero(3, count);
  for_pairs([&](Index i, Index j, const Point<3>& d, double D) {
    expected.col(j) += r[i] / (4 * std::numbers::pi) / std::pow(D, 1.5) * d;
  });
  expect_close(sums.adjoint(r.cast<float>()), expected);
}

TEST(DipoleSums, OfFewPointsAreExact) {
  const Points<3> points = (Points<3>(3, 2) << 0, 2, 0, 0, 0, 0).finished();
  DipoleSums sums(points);
  sums.set_smoothing(Eigen::VectorXd::Zero(2).array() + 1e-3);
  Vectors m = Vectors::Zero(3, 2);
  for (Index i = 0; i < 2; ++i) m(0, i) = sums.order()[i] == 1 ? 1 : 0;  // a dipole along x at x = 2
  const Eigen::VectorXf w = sums.winding(m);
  for (Index i = 0; i < 2; ++i)
    EXPECT_NEAR(w[i], sums.order()[i] == 1 ? 0 : 1 / (16 * std::numbers::pi), 1e-6);  // 2 / (4 pi 2^3)
}

}  // namespace
}  // namespace csrbf::winding::dipole_sums_test
