#include "csrbf/surface/composite/patches.hpp"

#include "csrbf/kernels/kernel.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <array>
#include <random>

namespace csrbf::patches_test {
namespace {

constexpr double rounding = 1e-12;  // sums of some hundred terms of order one

using std::mt19937_64;

double uniform(mt19937_64& random, double lo = -1, double hi = 1) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}

Point<3> random_point(mt19937_64& random, double half = 1) {
  return Point<3>::NullaryExpr([&] { return uniform(random, -half, half); });
}

struct Model {
  Patch patch;
  Points<3> centers;
  Eigen::VectorXd alpha;
};

Model random_model(mt19937_64& random, Index centers) {
  Model model;
  Patch& p = model.patch;
  p.center = random_point(random);
  p.radius = uniform(random, 0.3, 0.8);
  p.flatness = uniform(random, 1, 1.25);
  const Point<3> axis = random_point(random).normalized();
  p.T = Eigen::AngleAxisd(uniform(random, 0, 3), axis).toRotationMatrix() / p.radius;
  p.quadric = p.quadric.NullaryExpr([&] { return uniform(random); });
  model.centers = Points<3>::NullaryExpr(3, centers, [&] { return uniform(random); });
  model.alpha = Eigen::VectorXd::NullaryExpr(centers, [&] { return uniform(random); });
  return model;
}

std::vector<Model> random_models(Index count, unsigned seed) {
  mt19937_64 random(seed);
  std::vector<Model> models;
  for (Index i = 0; i < count; ++i) models.push_back(random_model(random, i % 5));
  return models;
}

Patches patches_of(const std::vector<Model>& models) {
  Patches patches;
  for (const Model& m : models) patches.add(m.patch, m.centers, m.alpha);
  patches.build();
  return patches;
}

// Value, gradient and Hessian of one sum at one point.
struct Term {
  double value = 0;
  Point<3> gradient = Point<3>::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();

  void add(const Term& other, double factor = 1) {
    value += factor * other.value;
    gradient += factor * other.gradient;
    hessian += factor * other.hessian;
  }
};

Term product(const Term& a, const Term& b) {
  return {a.value * b.value, a.value * b.gradient + b.value * a.gradient,
          a.value * b.hessian + b.value * a.hessian + a.gradient * b.gradient.transpose() +
              b.gradient * a.gradient.transpose()};
}

// Local function from local to world coordinates.
Term pulled_back(const Eigen::Matrix3d& T, const Term& local) {
  return {local.value, T.transpose() * local.gradient, T.transpose() * local.hessian * T};
}

// The model of a patch, divided by its radius, and its weight, straight from their definitions.
struct Reference {
  Term f, w;
};
Reference reference(const Model& model, const Point<3>& x) {
  static const Kernel kernel("wendland-c4", 3);
  const Patch& p = model.patch;
  const Point<3> q = p.T * (x - p.center);
  Eigen::Matrix3d A;
  A << p.quadric[4], p.quadric[5] / 2, p.quadric[6] / 2,  //
      p.quadric[5] / 2, p.quadric[7], p.quadric[8] / 2,   //
      p.quadric[6] / 2, p.quadric[8] / 2, p.quadric[9];
  const Point<3> b = p.quadric.segment<3>(1);
  Term f{p.quadric[0] + b.dot(q) + q.dot(A * q), b + 2 * A * q, 2 * A};
  for (Index j = 0; j < model.alpha.size(); ++j) {
    const Point<3> d = q - model.centers.col(j);
    const double s = Patches::support, r = d.norm() / s;
    f.add({kernel.value(r), kernel.g(r) * d / (s * s),
           kernel.g(r) * Eigen::Matrix3d::Identity() / (s * s) + kernel.h(r) * d * d.transpose() / (s * s * s * s)},
          model.alpha[j]);
  }
  const Point<3> D(1, 1, p.flatness * p.flatness);
  const double t = 1 - q.dot(D.asDiagonal() * q);
  Term w;
  if (t > 0) {
    const Point<3> Dq = D.cwiseProduct(q);
    w = {std::pow(t, 4), -8 * std::pow(t, 3) * Dq,
         -8 * std::pow(t, 3) * Eigen::Matrix3d(D.asDiagonal()) + 48 * t * t * Dq * Dq.transpose()};
  }
  return {pulled_back(p.T, f), pulled_back(p.T, w)};
}

struct ReferenceSums {
  Term W, S, A, Q;
};
ReferenceSums reference_sums(const std::vector<Model>& models, const Point<3>& x, bool sharp) {
  ReferenceSums sums;
  for (const Model& model : models) {
    const Reference r = reference(model, x);
    const Term w = sharp ? product(r.w, product(r.w, r.w)) : r.w;
    sums.W.add(w);
    sums.S.add(product(w, r.f), model.patch.radius);
    sums.A.add(product(w, r.f));
    sums.Q.add(product(w, product(r.f, r.f)));
  }
  return sums;
}

Term lane_of(const PatchSums& sums, const double (*terms)[PatchSums::lanes], int lane) {
  Term t{terms[0][lane]};
  if (sums.derivatives >= Derivatives::gradient)
    for (int c = 0; c < 3; ++c) t.gradient[c] = terms[1 + c][lane];
  if (sums.derivatives >= Derivatives::hessian)
    for (int c = 0, term = 4; c < 3; ++c)
      for (int d = c; d < 3; ++d, ++term) t.hessian(c, d) = t.hessian(d, c) = terms[term][lane];
  return t;
}

PatchSums sums_at(const Patches& patches, const PointsRef<3>& x, Derivatives derivatives, bool sharp = false) {
  PatchSums sums;
  sums.sharp = sharp;
  patches.accumulate(x, derivatives, sums);
  return sums;
}

// The blend f = S / W with its derivatives (quotient rule).
Term blend(const Term& S, const Term& W) {
  const double f = S.value / W.value;
  const Point<3> gradient = (S.gradient - f * W.gradient) / W.value;
  return {
      f, gradient,
      (S.hessian - f * W.hessian - gradient * W.gradient.transpose() - W.gradient * gradient.transpose()) / W.value};
}

Term blend_at(const Patches& patches, const Point<3>& x) {
  const PatchSums sums = sums_at(patches, x, Derivatives::hessian);
  return blend(lane_of(sums, sums.S, 0), lane_of(sums, sums.W, 0));
}

void expect_near(const Term& found, const Term& expected, double tolerance) {
  EXPECT_NEAR(found.value, expected.value, tolerance);
  EXPECT_NEAR((found.gradient - expected.gradient).norm(), 0, tolerance);
  EXPECT_NEAR((found.hessian - expected.hessian).norm(), 0, tolerance);
}

TEST(Patches, OfAConstantAreThatConstantEverywhere) {
  std::vector<Model> models = random_models(60, 1);
  for (Model& m : models) {
    m.alpha.setZero();
    m.patch.quadric.setZero();
    m.patch.quadric[0] = 0.7 / m.patch.radius;
  }
  const Patches patches = patches_of(models);
  mt19937_64 random(2);
  for (int i = 0; i < 200; ++i) {
    const Point<3> x = random_point(random);
    const PatchSums sums = sums_at(patches, x, Derivatives::hessian);
    if (sums.W[0][0] < 0.1) continue;
    // Derivatives of W are of order 1e3; they cancel.
    expect_near(blend(lane_of(sums, sums.S, 0), lane_of(sums, sums.W, 0)), {.value = 0.7}, 1e-8);
  }
}

TEST(Patches, WeighTheirCentreWithOneAndTheRimWithZero) {
  const std::vector<Model> models = random_models(1, 3);
  const Patches patches = patches_of(models);
  const Patch& p = models[0].patch;
  EXPECT_NEAR(sums_at(patches, p.center, Derivatives::none).W[0][0], 1, rounding);
  const Eigen::Matrix3d axes = p.T.transpose() * (p.radius * p.radius);
  const double tangential = 0.5, t = 1 - tangential * tangential;
  EXPECT_NEAR(sums_at(patches, p.center + tangential * axes.col(0), Derivatives::none).W[0][0], t * t * t * t,
              rounding);
  const Point<3> half_up = p.center + tangential / p.flatness * axes.col(2);
  EXPECT_NEAR(sums_at(patches, half_up, Derivatives::none).W[0][0], t * t * t * t, rounding);
  for (int axis = 0; axis < 3; ++axis) {
    const Point<3> rim = axes.col(axis) / (axis == 2 ? p.flatness : 1);
    EXPECT_EQ(sums_at(patches, p.center + 1.0000001 * rim, Derivatives::none).W[0][0], 0);
    EXPECT_GT(sums_at(patches, p.center + 0.999 * rim, Derivatives::none).W[0][0], 0);
  }
}

TEST(Patches, HaveWeightsWhoseDerivativesVanishAtTheRim) {
  const std::vector<Model> models = random_models(1, 4);
  const Patches patches = patches_of(models);
  const Patch& p = models[0].patch;
  mt19937_64 random(5);
  for (int i = 0; i < 50; ++i) {
    Point<3> q = random_point(random).normalized();
    q[2] /= p.flatness;
    const auto weight = [&](double d) {
      const PatchSums sums = sums_at(patches, p.center + p.T.inverse() * (d * q), Derivatives::hessian);
      return lane_of(sums, sums.W, 0);
    };
    constexpr double near =
        1e-4;  // s = 1 - d^2 = 2e-4: w = s^4, first s^3, second s^2, with factors 8 and 48 over r, r^2
    const Term inside = weight(1 - near), outside = weight(1 + near);
    EXPECT_LT(inside.value, 2e-15);
    EXPECT_LT(inside.gradient.norm(), 8.1 * 8e-12 * p.flatness / p.radius);
    EXPECT_LT(inside.hessian.norm(), 48.1 * 4e-8 * p.flatness * p.flatness / (p.radius * p.radius));
    EXPECT_TRUE(outside.hessian.isZero(0) && outside.gradient.isZero(0) && outside.value == 0);
  }
}

TEST(Patches, AgreeWithTheDefinition) {
  const std::vector<Model> models = random_models(100, 6);
  const Patches patches = patches_of(models);
  mt19937_64 random(7);
  double covered = 0;
  for (int i = 0; i < 100; ++i) {
    const Point<3> x = random_point(random, 1.3);
    const bool sharp = i % 2 == 1;
    const ReferenceSums expected = reference_sums(models, x, sharp);
    const PatchSums sums = sums_at(patches, x, Derivatives::hessian, sharp);
    constexpr double tolerance = 1e-9;  // second derivatives are up to 1e3 times larger than values
    expect_near(lane_of(sums, sums.W, 0), expected.W, tolerance);
    expect_near(lane_of(sums, sums.S, 0), expected.S, tolerance);
    expect_near(lane_of(sums, sums.A, 0), expected.A, tolerance);
    expect_near(lane_of(sums, sums.Q, 0), expected.Q, tolerance);
    EXPECT_NEAR(sums.W[0][0], expected.W.value, rounding);
    covered += expected.W.value > 0 ? 1 : 0;
  }
  EXPECT_GT(covered, 50);
}

TEST(Patches, GiveTheSameSumsWithFewerDerivatives) {
  const Patches patches = patches_of(random_models(50, 8));
  mt19937_64 random(9);
  for (int i = 0; i < 50; ++i) {
    const Point<3> x = random_point(random);
    const PatchSums values = sums_at(patches, x, Derivatives::none);
    const PatchSums gradients = sums_at(patches, x, Derivatives::gradient);
    const PatchSums jets = sums_at(patches, x, Derivatives::hessian);
    EXPECT_EQ(values.derivatives, Derivatives::none);
    EXPECT_EQ(jets.derivatives, Derivatives::hessian);
    for (const auto sum : {&PatchSums::W, &PatchSums::S, &PatchSums::A, &PatchSums::Q}) {
      EXPECT_NEAR((values.*sum)[0][0], (jets.*sum)[0][0], rounding);
      for (int t = 0; t < 4; ++t)
        EXPECT_NEAR((gradients.*sum)[t][0], (jets.*sum)[t][0], rounding * (1 + std::abs((jets.*sum)[t][0])));
    }
  }
}

TEST(Patches, GiveTheSameWeightsAlone) {
  const Patches patches = patches_of(random_models(60, 9));
  mt19937_64 random(10);
  const Points<3> x = Points<3>::NullaryExpr(3, 13, [&] { return uniform(random); });
  const PatchSums sums = sums_at(patches, x, Derivatives::none);
  std::array<double, 13> W;
  patches.weights(x, W.data());
  for (std::size_t i = 0; i < W.size(); ++i) EXPECT_NEAR(W[i], sums.W[0][i], rounding);
}

TEST(Patches, GiveWeightsUntilAllAreEnough) {
  const Patches patches = patches_of(random_models(60, 9));
  mt19937_64 random(10);
  for (int i = 0; i < 100; ++i) {
    const Points<3> x = Points<3>::NullaryExpr(3, 5, [&] { return uniform(random); });
    std::array<double, 5> all, W;
    patches.weights(x, all.data());
    patches.weights(x, W.data(), 0.1);
    for (std::size_t k = 0; k < W.size(); ++k) {
      EXPECT_LE(W[k], all[k]);
      EXPECT_EQ(W[k] < 0.1, all[k] < 0.1);
    }
  }
}

TEST(Patches, BlendWithDerivativesOfSecondOrderAccurateDifferences) {
  const Patches patches = patches_of(random_models(100, 10));
  mt19937_64 random(11);
  const auto error = [&](const Point<3>& x, const Term& f, double h) {
    Eigen::Vector2d worst = Eigen::Vector2d::Zero();
    for (int a = 0; a < 3; ++a) {
      const Term after = blend_at(patches, x + h * Point<3>::Unit(a));
      const Term before = blend_at(patches, x - h * Point<3>::Unit(a));
      worst[0] = std::max(worst[0], std::abs((after.value - before.value) / (2 * h) - f.gradient[a]));
      worst[1] = std::max(worst[1], ((after.gradient - before.gradient) / (2 * h) - f.hessian.col(a)).norm());
    }
    return worst;
  };
  Eigen::Vector2d coarse = Eigen::Vector2d::Zero(), fine = Eigen::Vector2d::Zero();
  for (int i = 0; i < 100; ++i) {
    const Point<3> x = random_point(random, 0.7);
    const Term f = blend_at(patches, x);
    coarse += error(x, f, 1e-3);
    fine += error(x, f, 1e-3 / 4);
    EXPECT_NEAR((f.hessian - f.hessian.transpose()).norm(), 0, 1e-9);
  }
  for (int d = 0; d < 2; ++d) {
    const double order = std::log2(coarse[d] / fine[d]) / 2;
    EXPECT_GE(order, 1.9);
    EXPECT_LE(order, 2.1);
  }
}

TEST(Patches, GiveSumsThatDoNotDependOnTheOtherPointsOfAChunk) {
  const Patches patches = patches_of(random_models(80, 12));
  mt19937_64 random(13);
  const Points<3> x = Points<3>::NullaryExpr(3, PatchSums::lanes, [&] { return uniform(random); });
  for (const Derivatives derivatives : {Derivatives::none, Derivatives::gradient, Derivatives::hessian}) {
    const int terms = derivatives == Derivatives::none ? 1 : derivatives == Derivatives::gradient ? 4 : 10;
    const PatchSums all = sums_at(patches, x, derivatives);
    for (const Index group : {1, 3, 7, 15})
      for (Index begin = 0; begin < x.cols(); begin += group) {
        const Index count = std::min(group, x.cols() - begin);
        const PatchSums some = sums_at(patches, x.middleCols(begin, count), derivatives);
        for (Index i = 0; i < count; ++i)
          for (int t = 0; t < terms; ++t) {
            EXPECT_EQ(some.W[t][i], all.W[t][begin + i]);
            EXPECT_EQ(some.S[t][i], all.S[t][begin + i]);
            EXPECT_EQ(some.A[t][i], all.A[t][begin + i]);
            EXPECT_EQ(some.Q[t][i], all.Q[t][begin + i]);
          }
      }
  }
}

TEST(Patches, AreZeroOutsideTheirBoundsWhichHoldTheSupports) {
  const std::vector<Model> models = random_models(30, 14);
  const Patches patches = patches_of(models);
  const Box<3> box = patches.bounds();
  mt19937_64 random(15);
  for (const Model& m : models)
    for (int i = 0; i < 50; ++i) {
      Point<3> q = random_point(random).normalized();
      q[2] /= m.patch.flatness;
      EXPECT_TRUE(box.inflated(rounding).contains(m.patch.center + m.patch.T.inverse() * q));
    }
  for (int i = 0; i < 500; ++i) {
    const Point<3> x = random_point(random, 4);
    if (box.contains(x)) continue;
    EXPECT_EQ(sums_at(patches, x, Derivatives::none).W[0][0], 0);
  }
  // Tight: the support of one patch touches its box.
  const std::vector<Model> one(models.begin(), models.begin() + 1);
  const Box<3> tight = patches_of(one).bounds();
  Box<3> reached;
  const Patch& p = one[0].patch;
  for (int axis = 0; axis < 3; ++axis) {
    // The farthest point of an ellipsoid M = T^T D T along e is M^-1 e / sqrt(e.M^-1 e).
    const Eigen::Matrix3d M = p.T.transpose() * Point<3>(1, 1, p.flatness * p.flatness).asDiagonal() * p.T;
    const Point<3> v = M.inverse() * Point<3>::Unit(axis);
    reached.add(p.center + v / std::sqrt(v[axis]));
    reached.add(p.center - v / std::sqrt(v[axis]));
  }
  EXPECT_NEAR((tight.lo - reached.lo).norm() + (tight.hi - reached.hi).norm(), 0, rounding);
}

TEST(Patches, KeepWhatWasAdded) {
  const std::vector<Model> models = random_models(7, 16);
  const Patches patches = patches_of(models);
  ASSERT_EQ(patches.size(), 7);
  Index centers = 0;
  for (std::size_t i = 0; i < models.size(); ++i) {
    EXPECT_EQ(patches.patch(static_cast<Index>(i)).quadric, models[i].patch.quadric);
    EXPECT_EQ(patches.center_begin()[i], centers);
    for (Index j = 0; j < models[i].alpha.size(); ++j, ++centers) {
      const auto at = static_cast<std::size_t>(centers);
      EXPECT_EQ(patches.alpha()[at], models[i].alpha[j]);
      EXPECT_EQ(patches.center_coordinates()[3 * at + 2], models[i].centers(2, j));
    }
  }
  EXPECT_EQ(patches.centers(), centers);
}

TEST(Patches, NoneSumToZero) {
  Patches patches;
  patches.build();
  EXPECT_EQ(patches.size(), 0);
  EXPECT_EQ(patches.centers(), 0);
  EXPECT_TRUE(patches.bounds().empty());
  const PatchSums sums = sums_at(patches, Point<3>::Zero(), Derivatives::hessian);
  for (int t = 0; t < PatchSums::max_terms; ++t) EXPECT_EQ(sums.W[t][0], 0);
}

}  // namespace
}  // namespace csrbf::patches_test
