#include "csrbf/surface/composite/composite.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/surface/prepare/prepare.hpp"
#include "surface/surface_testing.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <set>

namespace csrbf::composite_test {
namespace {

// The partition of unity f = S / W and its gradient; W = 0 where no patch reaches.
struct Blend {
  double weight = 0, value = 0;
  Point<3> gradient = Point<3>::Zero();

  [[nodiscard]] double distance() const { return std::abs(value) / gradient.norm(); }
};
Blend blend_at(const Patches& patches, const Point<3>& x) {
  PatchSums sums;
  patches.accumulate(x, Derivatives::gradient, sums);
  Blend result;
  result.weight = sums.W[0][0];
  if (result.weight == 0) return result;
  result.value = sums.S[0][0] / result.weight;
  for (int c = 0; c < 3; ++c) result.gradient[c] = (sums.S[1 + c][0] - result.value * sums.W[1 + c][0]) / result.weight;
  return result;
}

// Root mean square distance and angle (radian) between the fitted and the exact torus, at points between the samples.
struct Errors {
  double distance = 0, normal = 0;
};
Errors errors_of(const Patches& patches, const Torus& torus) {
  const PointCloud probes = torus.cloud(2000, 77);
  Errors errors;
  for (Index i = 0; i < probes.size(); ++i) {
    const Blend f = blend_at(patches, probes.points.col(i));
    EXPECT_GT(f.weight, 0.01);
    errors.distance += f.distance() * f.distance();
    errors.normal += (f.gradient.normalized() + probes.normals.col(i)).squaredNorm();
  }
  const auto n = static_cast<double>(probes.size());
  return {std::sqrt(errors.distance / n), std::sqrt(errors.normal / n)};
}

CompositeFit fit_torus(Index n, const CompositeOptions& options = {}) {
  return fit_composite(oriented(Torus().cloud(n), Torus().area()), options);
}

CompositeOptions quadric_only() {
  CompositeOptions options;
  options.centers_per_patch = 0;
  return options;
}

constexpr std::array<Index, 4> sizes = {2000, 8000, 32000, 128000};  // the spacing is halved each time

double observed_order(double coarsest, double finest) {
  return std::log2(coarsest / finest) / static_cast<double>(sizes.size() - 1);
}

// A stray sample's normal is that of no other nearby: its patch would reach for those far away.
TEST(Composite, ASampleWithAStrangeNormalDoesNotSpoilOthers) {
  const Torus torus;
  const PointCloud clean = torus.cloud(10'000);
  const double clean_error = errors_of(fit_torus(10'000).patches, torus).distance;
  PointCloud cloud = clean;
  cloud.points.conservativeResize(3, clean.size() + 3);
  cloud.normals.conservativeResize(3, clean.size() + 3);
  const double spacing = std::sqrt(torus.area() / 10'000);
  for (Index k = 0; k < 3; ++k) {
    const Point<3> normal = clean.normals.col(1000 * k);
    cloud.points.col(clean.size() + k) = clean.points.col(1000 * k) + 3 * spacing * normal;
    cloud.normals.col(clean.size() + k) = -normal;
  }
  const CompositeFit fit = fit_composite(oriented(cloud, torus.area()), CompositeOptions{});
  EXPECT_LT(errors_of(fit.patches, torus).distance, 2 * clean_error);
}

TEST(Composite, OfAPlaneIsThePlane) {
  PointCloud square{Points<3>(3, 1000), Point<3>::UnitZ().replicate(1, 1000), {}};
  for (Index i = 0; i < 1000; ++i) square.points.col(i) << quasi_random(i, 1), 0.25;
  const CompositeFit fit = fit_composite(oriented(square, 1), {});
  for (Index i = 0; i < 300; ++i) {
    const Point<3> x = Point<3>(0, 0, 0.25 + 0.01 * std::sin(i)) + square.points.col(i).cwiseProduct(Point<3>(1, 1, 0));
    const Blend f = blend_at(fit.patches, x);
    constexpr double rounding = 1e-9;
    EXPECT_NEAR(f.value, 0.25 - x[2], rounding);
    EXPECT_NEAR((f.gradient + Point<3>::UnitZ()).norm(), 0, 1e-6);  // the blend divides rounding by the patch radius
  }
  EXPECT_GE(fit.patches.size(), 125);
  EXPECT_LE(fit.patches.size(), 140);  // some more at the rim
}

TEST(Composite, HasAboutOnePatchPerLeafThatCoverTheSurface) {
  for (const Index leaf_size : {4, 8, 50}) {
    CompositeOptions options;
    options.leaf_size = leaf_size;
    const CompositeFit fit = fit_torus(4000, options);
    EXPECT_NEAR(static_cast<double>(fit.patches.size()), 4000.0 / static_cast<double>(leaf_size),
                0.2 * 4000.0 / static_cast<double>(leaf_size));  // some more over coverage gaps
    EXPECT_LE(fit.patches.centers(), fit.patches.pieces() * options.centers_per_patch);
    const PointCloud probes = Torus().cloud(1000, 5);
    for (Index i = 0; i < probes.size(); ++i) EXPECT_GT(blend_at(fit.patches, probes.points.col(i)).weight, 0.03);
  }
}

TEST(Composite, KnowsTheAreaOfTheSurface) {
  const CompositeFit fit = fit_torus(8000);
  EXPECT_NEAR(fit.areas.sum(), Torus().area(), 0.03 * Torus().area());  // patches are flat discs
  EXPECT_GT(fit.areas.minCoeff(), 0.3 * Torus().area() / 8000);
  EXPECT_LT(fit.areas.maxCoeff(), 3 * Torus().area() / 8000);
}

// One sample in fifty on the upper half of a sphere: those at its rim have many neighbours, and stand for large areas.
TEST(Composite, KnowsTheAreaWhereTheDensityJumps) {
  const PointCloud dense = sphere_cloud(20'000);
  std::vector<Index> kept;
  for (Index i = 0; i < dense.size(); ++i)
    if (dense.points(2, i) < 0 || i % 50 == 0) kept.push_back(i);
  const PreparedCloud prepared =
      prepare({dense.points(Eigen::all, kept), dense.normals(Eigen::all, kept), {}}, Normals::automatic);
  const CompositeFit fit = fit_composite(prepared.cloud, {});
  double upper = 0, lower = 0;
  for (Index i = 0; i < prepared.cloud.size(); ++i)
    (dense.points(2, kept[prepared.source[i]]) < 0 ? lower : upper) += fit.areas[i] * prepared.scale * prepared.scale;
  EXPECT_NEAR(lower, 2 * pi, 0.1 * 2 * pi);
  EXPECT_NEAR(upper, 2 * pi, 0.35 * 2 * pi);  // 0.46 if all samples of a leaf had the same area
}

TEST(Composite, ConvergesWithTheThirdPowerOfTheSpacing) {
  std::array<Errors, 4> quadric, csrbf;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    quadric[i] = errors_of(fit_torus(sizes[i], quadric_only()).patches, Torus());
    csrbf[i] = errors_of(fit_torus(sizes[i]).patches, Torus());
    EXPECT_LT(csrbf[i].distance, 0.5 * quadric[i].distance);
    EXPECT_LT(csrbf[i].normal, 0.5 * quadric[i].normal);
  }
  // A quadric leaves out third-order terms; the CSRBF residual has a fixed shape relative to the patch.
  EXPECT_GE(observed_order(quadric.front().distance, quadric.back().distance), 2.9);
  EXPECT_GE(observed_order(csrbf.front().distance, csrbf.back().distance), 2.9);
  EXPECT_GE(observed_order(quadric.front().normal, quadric.back().normal), 1.9);
  EXPECT_GE(observed_order(csrbf.front().normal, csrbf.back().normal), 1.9);
}

TEST(Composite, TurnsMovesAndScalesWithTheCloud) {
  const OrientedPoints cloud = oriented(Torus().cloud(3000), Torus().area());
  const Patches patches = fit_composite(cloud, {}).patches;
  Similarity map = rotation(2);
  map.scale = 1e-3;
  map.shift << 1, -2, 3;
  const OrientedPoints image{map(cloud.points), map.R * cloud.normals, map.scale * cloud.spacing};
  const Patches mapped = fit_composite(image, {}).patches;
  EXPECT_EQ(mapped.size(), patches.size());
  const PointCloud probes = with_noise(Torus().cloud(500, 9), 0.01);
  for (Index i = 0; i < probes.size(); ++i) {
    const Point<3> x = probes.points.col(i);
    // Coordinates of order 3 hold the shape of size 1e-3 to 4e-13 relative to it; the normal equations with their ridge
    // of 1e-6 have condition numbers up to 1e6.
    EXPECT_NEAR(blend_at(mapped, map(x)).value, map.scale * blend_at(patches, x).value, map.scale * 4e-7);
  }
}

TEST(Composite, DoesNotDependOnTheNumberOfThreads) {
  set_thread_count(1);
  const CompositeFit serial = fit_torus(20000);
  set_thread_count(3);
  const CompositeFit parallel = fit_torus(20000);
  set_thread_count(0);
  EXPECT_EQ(parallel.areas, serial.areas);
  ASSERT_EQ(parallel.patches.size(), serial.patches.size());
  EXPECT_EQ(parallel.patches.alpha(), serial.patches.alpha());
  for (Index i = 0; i < serial.patches.pieces(); ++i)
    EXPECT_EQ(parallel.patches.patch(i).quadric, serial.patches.patch(i).quadric);
}

TEST(Composite, InARegionIsThatOfTheWholeAndHasNoPatchesBesideIt) {
  const OrientedPoints cloud = oriented(Torus().cloud(20000), Torus().area());
  CompositeOptions options;
  const Patches whole = fit_composite(cloud, options).patches;
  const Box<3> all = bounding_box<3>(cloud.points);
  options.region = Box<3>{all.lo, Point<3>(0.25 * all.lo[0] + 0.75 * all.hi[0], all.hi[1], all.hi[2])};
  const Patches part = fit_composite(cloud, options).patches;
  EXPECT_GT(part.pieces(), whole.pieces() / 2);
  for (Index i = 0; i < part.pieces(); ++i) {
    const Patch& patch = part.patch(i);
    const Point<3> nearest = patch.center.cwiseMax(options.region->lo).cwiseMin(options.region->hi);
    EXPECT_LT((patch.center - nearest).norm(), patch.radius);
  }
  const Box<3> deep = options.region->inflated(-0.1);
  for (Index i = 0; i < cloud.size(); i += 7) {
    const Point<3> x = cloud.points.col(i);
    if (x[0] < deep.hi[0]) {
      EXPECT_NEAR(blend_at(part, x).value, blend_at(whole, x).value, 1e-12);
    }
  }
}

TEST(Composite, UsesNoCentresBeyondTheBudget) {
  const OrientedPoints cloud = oriented(Torus().cloud(8000), Torus().area());
  CompositeOptions options;
  options.leaf_size = 200;
  options.centers_per_patch = 64;
  for (Index i = 3; i < cloud.size(); i += 32) options.centers.push_back(i);
  const Patches patches = fit_composite(cloud, options).patches;
  std::set<Index> used;
  for (Index p = 0; p < patches.pieces(); ++p) {
    const auto begin = patches.center_begin()[p], end = patches.center_begin()[static_cast<std::size_t>(p) + 1];
    for (Index j = begin; j < end; ++j) {
      const Eigen::Map<const Point<3>> local(patches.center_coordinates().data() + 3 * j);
      const Point<3> c = patches.patch(p).center + patches.patch(p).T.inverse() * local;
      const auto same = [&](Index i) { return (cloud.points.col(i) - c).norm() < 1e-9; };
      const auto found = std::find_if(options.centers.begin(), options.centers.end(), same);
      ASSERT_NE(found, options.centers.end());
      used.insert(*found);
    }
  }
  EXPECT_GT(used.size(), 200);  // of 250
  options.centers_per_patch = 0;
  EXPECT_LT(errors_of(patches, Torus()).distance,
            0.5 * errors_of(fit_composite(cloud, options).patches, Torus()).distance);
}

TEST(Composite, KeepsTheToleranceOfEverySample) {
  const Torus torus;
  const OrientedPoints clean = oriented(torus.cloud(8000), torus.area());
  CompositeOptions options;
  options.leaf_size = 256;
  Index previous = 0;
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    options.tolerance.setConstant(clean.size(), tolerance);
    const Patches patches = fit_composite(clean, options).patches;
    double largest = 0;
    for (Index i = 0; i < clean.size(); ++i)
      largest = std::max(largest, blend_at(patches, clean.points.col(i)).distance());
    EXPECT_LE(largest, tolerance);
    EXPECT_GT(patches.size(), previous);  // a tighter tolerance costs more patches
    previous = patches.size();
  }
}

TEST(Composite, HalvesLeavesOnlyWhereTheToleranceIsMissed) {
  const Torus torus;
  const OrientedPoints cloud = oriented(torus.cloud(8000), torus.area());
  CompositeOptions options;
  options.leaf_size = 256;
  options.tolerance.resize(cloud.size());
  for (Index i = 0; i < cloud.size(); ++i) options.tolerance[i] = cloud.points(0, i) > 0 ? 1e-4 : 1.0;
  const Patches patches = fit_composite(cloud, options).patches;
  Index left = 0;
  for (const Patch& p : patches.patches()) left += p.join == Join::first && p.center[0] < -0.3 ? 1 : 0;
  EXPECT_LT(left, 30);
  EXPECT_GT(patches.size(), 100);
}

// Noisy samples of a sheet, flat for x < 0 and with waves beyond.
struct HalfWavy {
  static constexpr Index count = 12'000;
  static constexpr double height = 0.02, wave_number = 25;

  static double at(double x) { return x > 0 ? height * (1 - std::cos(wave_number * x)) : 0; }
  static double slope(double x) { return x > 0 ? height * wave_number * std::sin(wave_number * x) : 0; }

  static OrientedPoints cloud() {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> place(-1, 1);
    std::normal_distribution<double> noise(0, 0.005);
    OrientedPoints result{Points<3>(3, count), Points<3>(3, count), {}};
    for (Index i = 0; i < count; ++i) {
      const double x = place(random), y = 0.5 * place(random);
      result.points.col(i) << x, y, at(x) + noise(random);
      result.normals.col(i) = Point<3>(-slope(x) + 20 * noise(random), 20 * noise(random), 1).normalized();
    }
    result.spacing.setConstant(count, std::sqrt(2.0 / count));
    return result;
  }
  // Root mean square error of the height between two values of x.
  static double error_of(const Patches& patches, double begin, double end) {
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> along(begin, end), across(-0.45, 0.45);
    double sum = 0;
    for (int i = 0; i < 2000; ++i) {
      const double x = along(random);
      sum += std::pow(blend_at(patches, {x, across(random), at(x)}).distance(), 2);
    }
    return std::sqrt(sum / 2000);
  }
};

TEST(Composite, ChoosesLeavesPlaceByPlace) {
  const OrientedPoints cloud = HalfWavy::cloud();
  CompositeOptions options;
  options.leaf_size = 24;
  const Patches same = fit_composite(cloud, options).patches;
  options.choose_leaves = true;
  const Patches chosen = fit_composite(cloud, options).patches;
  EXPECT_LT(HalfWavy::error_of(chosen, -0.95, -0.05), 0.8 * HalfWavy::error_of(same, -0.95, -0.05));
  EXPECT_LT(HalfWavy::error_of(chosen, 0.05, 0.95), 1.02 * HalfWavy::error_of(same, 0.05, 0.95));
  const auto flat = std::count_if(chosen.patches().begin(), chosen.patches().end(),
                                  [](const Patch& patch) { return patch.center[0] < 0; });
  EXPECT_LT(flat, 0.85 * static_cast<double>(chosen.size() - flat));
}

TEST(Composite, OfNoisyScrapsKeepsOnlyThoseThatNoOtherPatchCovers) {
  // Single samples beside the sheet, further than a gap from it, where patches reach; six far away from all others.
  PointCloud cloud = Torus().cloud(8000);
  const double spacing = std::sqrt(Torus().area() / 8000);
  for (Index i = 0; i < 8000; i += 400) cloud.points.col(i) += 3 * spacing * cloud.normals.col(i);
  for (Index i = 0; i < 6; ++i) {
    const double angle = pi / 3 * static_cast<double>(i);
    cloud.points.col(i) << spacing * std::cos(angle), spacing * std::sin(angle), 3;
    cloud.normals.col(i) = Point<3>::UnitZ();
  }
  CompositeOptions options;
  options.leaf_size = 50;
  const Patches patches = fit_composite(oriented(cloud, Torus().area()), options).patches;
  EXPECT_GT(blend_at(patches, Point<3>(0, 0, 3)).weight, 0.1);
  EXPECT_LT(patches.size(), fit_composite(oriented(Torus().cloud(8000), Torus().area()), options).patches.size() + 10);
}

TEST(Composite, ReportsProgressAndCanBeCancelled) {
  const OrientedPoints cloud = oriented(Torus().cloud(2000), Torus().area());
  double last = -1;
  const auto watch = [&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "fit");
    EXPECT_GE(fraction, last);
    last = fraction;
    return true;
  };
  fit_composite(cloud, {}, watch);
  EXPECT_EQ(last, 1);
  EXPECT_THROW(fit_composite(cloud, {}, [](std::string_view, double) { return false; }), Cancelled);
}

}  // namespace
}  // namespace csrbf::composite_test
