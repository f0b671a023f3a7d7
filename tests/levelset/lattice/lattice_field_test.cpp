#include "csrbf/levelset/lattice/lattice_field.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <random>

namespace csrbf::lattice_field_test {
namespace {

// A lattice that is turned, stretched and moved in space, with random coefficients.
template <int Dim>
typename LatticeField<Dim>::Data random_lattice(const std::string& kernel) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  typename LatticeField<Dim>::Data data;
  data.kernel = kernel;
  data.support = 2.3;
  Eigen::Matrix<double, Dim, Dim> turn = Eigen::Matrix<double, Dim, Dim>::Identity();
  turn.template topLeftCorner<2, 2>() = Eigen::Rotation2Dd(0.4).toRotationMatrix();
  Index nodes = 1;
  for (int a = 0; a < Dim; ++a) {
    data.step[a] = 0.8 + 0.3 * a;
    data.size[a] = 7 + a;
    nodes *= 7 + a;
  }
  Eigen::Transform<double, Dim, Eigen::Affine> to_physical;
  to_physical.linear() = turn * data.step.asDiagonal();
  to_physical.translation().setConstant(-3);
  data.to_lattice = to_physical.inverse();
  for (Index i = 0; i < nodes; ++i) data.coefficients.push_back(uniform(random));
  for (int corner = 0; corner < 1 << Dim; ++corner) {
    Point<Dim> p;
    for (int a = 0; a < Dim; ++a) p[a] = (corner >> a & 1) != 0 ? static_cast<double>(data.size[a] - 1) : 0;
    data.bounds.add(to_physical * p);
  }
  return data;
}

// Points in the bounds and around them, some on nodes.
template <int Dim>
Points<Dim> probes(const typename LatticeField<Dim>::Data& data) {
  std::mt19937_64 random(4);
  const Box<Dim> box = data.bounds.inflated(3);
  Points<Dim> x(Dim, 400);
  for (double& c : x.reshaped()) c = std::uniform_real_distribution<double>(0, 1)(random);
  x = (x.array().colwise() * box.extent().array()).colwise() + box.lo.array();
  for (Index i = 0; i < 5; ++i) x.col(i) = data.to_lattice.inverse() * Point<Dim>::Constant(static_cast<double>(i));
  return x;
}

// Sum over all nodes, from the formulas of Kernel, without what is added outside.
template <int Dim>
Jet<Dim> brute_force(const typename LatticeField<Dim>::Data& data, const Points<Dim>& x) {
  const Kernel kernel(data.kernel, Dim);
  const double sigma2 = data.support * data.support;
  const auto to_physical = data.to_lattice.inverse();
  Jet<Dim> jet(x.cols(), Derivatives::hessian);
  for (Index i = 0; i < x.cols(); ++i) {
    double value = 0;
    Point<Dim> gradient = Point<Dim>::Zero();
    Eigen::Matrix<double, Dim, Dim> hessian = Eigen::Matrix<double, Dim, Dim>::Zero();
    for (std::size_t n = 0; n < data.coefficients.size(); ++n) {
      Point<Dim> node;
      auto rest = static_cast<Index>(n);
      for (int a = 0; a < Dim; ++a) {
        node[a] = static_cast<double>(rest % data.size[a]);
        rest /= data.size[a];
      }
      const Point<Dim> d = x.col(i) - to_physical * node;
      const double r = d.norm() / data.support, c = data.coefficients[n];
      value += c * kernel.value(r);
      gradient += c * kernel.g(r) / sigma2 * d;
      hessian += c / sigma2 *
                 (kernel.g(r) * Eigen::Matrix<double, Dim, Dim>::Identity() + kernel.h(r) / sigma2 * d * d.transpose());
    }
    jet.value[i] = value;
    jet.gradient.col(i) = gradient;
    for (Index a = 0, entry = 0; a < Dim; ++a)
      for (Index b = a; b < Dim; ++b, ++entry) jet.hessian(entry, i) = hessian(a, b);
  }
  return jet;
}

// Beyond the nodes: the box of this image, which is turned, reaches farther.
template <int Dim>
bool is_outside(const typename LatticeField<Dim>::Data& data, const Point<Dim>& x) {
  const Point<Dim> at = data.to_lattice * x;
  for (int a = 0; a < Dim; ++a)
    if (at[a] < 0 || at[a] > static_cast<double>(data.size[a] - 1)) return true;
  return false;
}

template <int Dim>
void expect_brute_force(const std::string& kernel) {
  SCOPED_TRACE(kernel + " in " + std::to_string(Dim) + "D");
  constexpr double rounding = 1e-12;  // sums of at most 100 terms of order 10
  const auto data = random_lattice<Dim>(kernel);
  const LatticeField<Dim> field(data);
  const Points<Dim> x = probes<Dim>(data);
  const Jet<Dim> expected = brute_force<Dim>(data, x), found = field.evaluate(x, Derivatives::hessian);
  Index outside = 0;
  for (Index i = 0; i < x.cols(); ++i) {
    if (is_outside<Dim>(data, x.col(i))) {
      EXPECT_LT(found.value[i], expected.value[i]);
      ++outside;
      continue;
    }
    EXPECT_NEAR(found.value[i], expected.value[i], rounding);
    EXPECT_LT((found.gradient.col(i) - expected.gradient.col(i)).cwiseAbs().maxCoeff(), rounding);
    EXPECT_LT((found.hessian.col(i) - expected.hessian.col(i)).cwiseAbs().maxCoeff(), rounding);
  }
  EXPECT_GT(outside, x.cols() / 4);
  EXPECT_LT(outside, 9 * x.cols() / 10);
  EXPECT_GT(expected.hessian.cwiseAbs().maxCoeff(), 1);
}

TEST(LatticeField, IsTheSumOverAllNodes) {
  for (const char* kernel : {"wendland-c2", "wendland-c4", "wu-c2"}) {
    expect_brute_force<2>(kernel);
    expect_brute_force<3>(kernel);
  }
}

// Zero is inside: a region that the border of the image cuts would be joined to everything outside.
TEST(LatticeField, IsNegativeBeyondTheImageWithDerivativesOfItsOwn) {
  auto data = random_lattice<3>("wendland-c4");
  for (double& c : data.coefficients) c = std::abs(c) + 0.1;
  const LatticeField<3> field(data);
  const Points<3> x = probes<3>(data);
  constexpr double h = 1e-5, error = 1e-6;
  Index outside = 0;
  for (Index i = 0; i < x.cols(); ++i) {
    const Point<3> p = x.col(i);
    if (!is_outside<3>(data, p)) {
      EXPECT_GT(field(p), 0);
      continue;
    }
    ++outside;
    const Jet<3> jet = field.evaluate(p, Derivatives::hessian);
    const double size = jet.hessian.cwiseAbs().maxCoeff() + jet.gradient.cwiseAbs().maxCoeff() + 1;
    for (Index a = 0; a < 3; ++a) {
      const Point<3> step = h * Point<3>::Unit(a);
      const Jet<3> after = field.evaluate(Point<3>(p + step), Derivatives::gradient),
                   before = field.evaluate(Point<3>(p - step), Derivatives::gradient);
      EXPECT_NEAR((after.value[0] - before.value[0]) / (2 * h), jet.gradient(a, 0), error * size);
      EXPECT_LT(((after.gradient - before.gradient) / (2 * h) - jet.hessian_matrix(0).col(a)).cwiseAbs().maxCoeff(),
                error * size);
    }
  }
  EXPECT_GT(outside, 100);
  const double far = field(Point<3>(1e6, 0, 0));
  EXPECT_LT(far, -1);
  EXPECT_NEAR(field(Point<3>(1e300, -1e300, 0)), far, 1e-6);
  for (int a = 0; a < 3; ++a) {
    Point<3> beside = Point<3>::Constant(2);
    beside[a] = -data.support / data.step[a];
    EXPECT_LT(field(data.to_lattice.inverse() * beside), 0);
  }
}

TEST(LatticeField, IsZeroWhereThePointIsNone) {
  EXPECT_EQ(LatticeField<2>(random_lattice<2>("wendland-c2"))(Point<2>(std::nan(""), 0)), 0);
}

// The row beside the point is reached at node coordinates that no integer holds.
TEST(LatticeField, IsNegativeBesideNodesThatAreOutOfProportion) {
  LatticeField<2>::Data data;
  data.to_lattice.setIdentity();
  data.step << 1e-306, 1;
  data.size = {2, 2};
  data.coefficients = {1, 2, 3, 4};
  data.bounds = {Point<2>::Zero(), Point<2>::Ones()};
  const LatticeField<2> field(data);
  EXPECT_LT(field(Point<2>(9e305, .5)), 0);
  EXPECT_EQ(field(Point<2>(-9e305, .5)), field(Point<2>(9e305, .5)));
  EXPECT_GT(field(Point<2>(9e305, 0)), field(Point<2>(9e305, .5)));
}

TEST(LatticeField, HasSeedsBetweenNodesOnDifferentSides) {
  const auto data = random_lattice<3>("wendland-c2");
  const LatticeField<3> field(data);
  const Points<3> seeds = field.seeds();
  ASSERT_GT(seeds.cols(), 50);
  const auto to_physical = data.to_lattice.inverse();
  for (Index i = 0; i < seeds.cols(); ++i) {
    EXPECT_TRUE(data.bounds.contains(seeds.col(i)));
    const Point<3> at = data.to_lattice * Point<3>(seeds.col(i));
    Index axis = 0;
    (at - at.array().round().matrix()).cwiseAbs().maxCoeff(&axis);
    Point<3> lo = at.array().round(), hi = lo;
    lo[axis] = std::floor(at[axis]);
    hi[axis] = lo[axis] + 1;
    EXPECT_NE(field(to_physical * lo) > 0, field(to_physical * hi) > 0) << at.transpose();
  }
}

TEST(LatticeField, RefusesWhatDoesNotFit) {
  auto data = random_lattice<2>("wendland-c2");
  data.coefficients.pop_back();
  EXPECT_THROW(LatticeField<2>{data}, InvalidInput);
  data = random_lattice<2>("wendland-c2");
  data.support = 0;
  EXPECT_THROW(LatticeField<2>{data}, InvalidInput);
  data = random_lattice<2>("wendland-c2");
  data.step[1] = -1;
  EXPECT_THROW(LatticeField<2>{data}, InvalidInput);
  data = random_lattice<2>("gaussian");
  EXPECT_THROW(LatticeField<2>{data}, InvalidInput);
}

}  // namespace
}  // namespace csrbf::lattice_field_test
