#include "csrbf/approx/inpaint.hpp"

#include "csrbf/approx/images/grid_spline.hpp"

#include "core/error_testing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace csrbf::inpaint_test {
namespace {

using Mask = std::vector<unsigned char>;

VolumeLayout layout(Index nx, Index ny, Index nz = 1) {
  VolumeLayout layout;
  layout.grid.size = {nx, ny, nz};
  layout.grid.axes = nz > 1 ? 3 : 2;
  return layout;
}

// Values of f at the physical positions along the axes.
template <class Function>
Volume<double> picture_of(const VolumeLayout& layout, const Function& f) {
  Volume<double> image(layout);
  const Grid& grid = image.grid;
  for (Index z = 0; z < grid.size[2]; ++z)
    for (Index y = 0; y < grid.size[1]; ++y)
      for (Index x = 0; x < grid.size[0]; ++x) {
        const Point<3> voxel(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
        image.values[grid.index(x, y, z)] = f(Point<3>(grid.spacing.cwiseProduct(voxel)));
      }
  return image;
}

double smooth(const Point<3>& p) {
  return 100 + 50 * std::sin(.13 * p.x() + .1 * p.z()) * std::cos(.11 * p.y() - .07 * p.z());
}

Mask random_mask(const Grid& grid, double share, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  Mask mask(static_cast<std::size_t>(grid.voxels()));
  for (unsigned char& m : mask) m = uniform(random) < share ? 1 : 0;
  return mask;
}

Mask hole(const Grid& grid, const Point<3>& center, double radius) {
  Mask mask(static_cast<std::size_t>(grid.voxels()), 0);
  for (Index z = 0; z < grid.size[2]; ++z)
    for (Index y = 0; y < grid.size[1]; ++y)
      for (Index x = 0; x < grid.size[0]; ++x)
        if ((Point<3>(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)) - center).norm() < radius)
          mask[grid.index(x, y, z)] = 1;
  return mask;
}

// Spoils the marked values, so that nothing can be read from them.
Volume<double> spoiled(Volume<double> image, const Mask& mask) {
  for (std::size_t i = 0; i < image.values.size(); ++i)
    if (mask[i % mask.size()] != 0) image.values[i] = -1e6;
  return image;
}

double largest_error(const Volume<double>& image, const Volume<double>& truth) {
  double largest = 0;
  for (std::size_t i = 0; i < image.values.size(); ++i)
    largest = std::max(largest, std::abs(image.values[i] - truth.values[i]));
  return largest;
}

TEST(Inpaint, RestoresAConstantAndALinearImage) {
  constexpr double round_off = 1e-7;  // of a system of moderate condition, relative to values of about 100
  for (const double slope : {0.0, 1.0}) {
    const auto f = [&](const Point<3>& p) { return 100 + slope * (p.x() - 2 * p.y()); };
    const Volume<double> truth = picture_of(layout(24, 20), f);
    const Mask mask = random_mask(truth.grid, .3, 1);
    Volume<double> image = spoiled(truth, mask);
    inpaint(image, mask);
    EXPECT_LT(largest_error(image, truth), round_off * 100) << slope;
  }
}

TEST(Inpaint, LeavesKnownValuesAloneAndCountsTheOthers) {
  const Volume<double> truth = picture_of(layout(30, 25), smooth);
  const Mask mask = random_mask(truth.grid, .5, 2);
  Volume<double> image = spoiled(truth, mask);
  const InpaintReport report = inpaint(image, mask);
  Index missing = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == 0)
      EXPECT_EQ(image.values[i], truth.values[i]);
    else
      ++missing;
  }
  EXPECT_EQ(report.missing, missing);
  EXPECT_EQ(report.known, truth.grid.voxels() - missing);
  EXPECT_EQ(report.fit.samples, report.known);
}

TEST(Inpaint, FillsScatteredPixelsOfASmoothImage) {
  const Volume<double> truth = picture_of(layout(120, 90), smooth);
  const Mask mask = random_mask(truth.grid, .7, 3);
  Volume<double> image = spoiled(truth, mask);
  inpaint(image, mask);
  constexpr double tolerance = .5;  // of a range of 100: gaps of a few pixels against a wavelength of 50
  EXPECT_LT(largest_error(image, truth), tolerance);
}

TEST(Inpaint, FillsScatteredVoxelsInThreeDimensions) {
  VolumeLayout thick = layout(24, 22, 12);
  thick.grid.spacing = Point<3>(1, 1, 3);
  const Volume<double> truth = picture_of(thick, smooth);
  const Mask mask = random_mask(truth.grid, .4, 4);
  Volume<double> image = spoiled(truth, mask);
  inpaint(image, mask);
  constexpr double tolerance = 1;
  EXPECT_LT(largest_error(image, truth), tolerance);
}

// A fit to the rims of all holes would fill what is between them, too.
TEST(Inpaint, FillsHolesInSpaceOneByOne) {
  Volume<double> truth = picture_of(layout(56, 40, 36), smooth);
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 2);
  for (double& value : truth.values) value += noise(random);
  Mask mask(truth.values.size(), 0);
  for (const Point<3>& center : {Point<3>(12, 12, 12), Point<3>(40, 20, 18), Point<3>(20, 30, 26)}) {
    const Mask one = hole(truth.grid, center, 4.5);
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] |= one[i];
  }
  Volume<double> image = spoiled(truth, mask);
  const InpaintReport report = inpaint(image, mask);
  EXPECT_EQ(report.fit.method, "grid-spline");
  double squares = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) squares += std::pow(image.values[i] - truth.values[i], 2);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(report.missing)), 1.15 * 2);
}

TEST(Inpaint, TakesAPlanThatIsGiven) {
  const Volume<double> truth = picture_of(layout(60, 50), smooth);
  const Mask mask = hole(truth.grid, Point<3>(30, 25, 0), 3);
  Volume<double> first = spoiled(truth, mask), second = first;
  InpaintOptions options;
  options.plan = inpaint(first, mask).plan;
  EXPECT_EQ(inpaint(second, mask, options).plan.kernel, options.plan->kernel);
  EXPECT_EQ(second.values, first.values);
  options.plan = InpaintPlan{.tension = 1e6};
  EXPECT_EQ(inpaint(second, mask, options).fit.method, "grid-spline");
  EXPECT_NE(second.values, first.values);
}

TEST(Inpaint, OfAHoleTakesTheKnownPixelsAroundItOnly) {
  const Volume<double> truth = picture_of(layout(200, 200), smooth);
  const Mask mask = hole(truth.grid, Point<3>(100, 90, 0), 2);
  Volume<double> image = spoiled(truth, mask);
  const InpaintReport report = inpaint(image, mask);
  EXPECT_LT(report.fit.samples, 1500);
  constexpr double tolerance = 1;
  EXPECT_LT(largest_error(image, truth), tolerance);

  // What lies far away has no influence at all.
  Volume<double> other = spoiled(truth, mask);
  for (Index x = 0; x < 200; ++x) other.values[other.grid.index(x, 5)] = 1e9;
  inpaint(other, mask);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] != 0) {
      EXPECT_EQ(other.values[i], image.values[i]);
    }
  }
}

// What is in a hole wider than the waves of a texture cannot be known: no guess errs much less than the mean.
TEST(Inpaint, DoesNotOvershootInHolesOfTextures) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::Array<double, 40, 3> waves;  // direction times frequency, phase
  for (auto wave : waves.rowwise()) {
    const double angle = 6.3 * uniform(random), frequency = .7 + .7 * uniform(random);
    wave << frequency * std::cos(angle), frequency * std::sin(angle), 6.3 * uniform(random);
  }
  const auto texture = [&](const Point<3>& p) {
    return 100 + 10 * (waves.col(0) * p.x() + waves.col(1) * p.y() + waves.col(2)).sin().sum();
  };
  const Volume<double> truth = picture_of(layout(80, 60), texture);
  Mask scratch(80 * 60, 0);
  for (std::size_t i = 0; i < scratch.size(); ++i) scratch[i] = i % 80 >= 34 && i % 80 < 46 ? 1 : 0;
  Volume<double> image = spoiled(truth, scratch);
  inpaint(image, scratch);
  double errors = 0, variance = 0;
  for (std::size_t i = 0; i < scratch.size(); ++i) {
    if (scratch[i] == 0) continue;
    errors += std::pow(image.values[i] - truth.values[i], 2);
    variance += std::pow(truth.values[i] - 100, 2);
  }
  EXPECT_LE(errors, 2 * variance);
}

// Waves of all lengths and directions, whose amplitudes are their lengths: between few pixels neither blocks nor a thin
// plate are best.
TEST(Inpaint, OfFewRoughPixelsTakesAMeanWithAThinPlate) {
  double squares = 0, squares_of_plate = 0;
  for (const unsigned seed : {1U, 2U, 3U}) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<std::array<double, 3>> waves;
    for (int k = 0; k < 300; ++k) {
      const double length = 3 * std::pow(30, uniform(random)), angle = 6.3 * uniform(random);
      waves.push_back({std::cos(angle) / length, std::sin(angle) / length, uniform(random)});
    }
    const Volume<double> truth = picture_of(layout(96, 96), [&](const Point<3>& p) {
      double sum = 0;
      for (const auto& [x, y, phase] : waves)
        sum += std::sin(6.283185307179586 * (x * p.x() + y * p.y() + phase)) / std::hypot(x, y);
      return sum;
    });
    const Mask mask = random_mask(truth.grid, .9, seed);
    Volume<double> filled = spoiled(truth, mask);
    inpaint(filled, mask);
    Eigen::MatrixXd plate = Eigen::Map<const Eigen::VectorXd>(truth.values.data(), std::ssize(truth.values));
    fill_by_grid_spline(truth.grid, mask, 0, plate);
    for (std::size_t i = 0; i < mask.size(); ++i) {
      squares += std::pow(filled.values[i] - truth.values[i], 2);
      squares_of_plate += std::pow(plate(static_cast<Index>(i), 0) - truth.values[i], 2);
    }
  }
  EXPECT_LT(std::sqrt(squares / squares_of_plate), 0.995);
}

TEST(Inpaint, WithoutBlocksIsNoMeanEither) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Volume<double> image = picture_of(layout(64, 64), [&](const Point<3>& p) { return smooth(p) + 30 * normal(random); });
  const Mask mask = random_mask(image.grid, .9, 1);
  Volume<double> other = image;
  EXPECT_GT(inpaint(image, mask).plan.thin_plate, 0);
  EXPECT_EQ(inpaint(other, mask, InpaintOptions{{}, 0}).plan.thin_plate, 0);
  EXPECT_NE(image.values, other.values);
}

TEST(Inpaint, TakesNaNForMissing) {
  const Volume<double> truth = picture_of(layout(40, 30), smooth);
  const Mask mask = random_mask(truth.grid, .2, 5);
  Volume<double> marked = spoiled(truth, mask), holes = truth;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i] != 0) holes.values[i] = std::nan("");
  inpaint(marked, mask);
  const InpaintReport report = inpaint(holes, Mask(mask.size(), 0));
  EXPECT_GT(report.missing, 0);
  EXPECT_EQ(holes.values, marked.values);
}

TEST(Inpaint, FillsComponentsAsIfTheyStoodAlone) {
  const Volume<double> gray = picture_of(layout(40, 30), smooth);
  const Mask mask = random_mask(gray.grid, .3, 6);
  VolumeLayout color = gray;
  color.components = 3;
  Volume<double> image(color);
  for (std::size_t i = 0; i < gray.values.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      image.values[3 * i + c] = mask[i] != 0 ? 0 : static_cast<double>(c + 1) * gray.values[i];
  const FitOptions options{.method = "partition-of-unity", .smoothing = 0};
  const InpaintReport report = inpaint(image, mask, options);
  Volume<double> alone = spoiled(gray, mask);
  EXPECT_EQ(report.missing, 3 * inpaint(alone, mask, options).missing);
  constexpr double tolerance = 1;  // other local options may be chosen
  for (std::size_t i = 0; i < gray.values.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(image.values[3 * i + c], static_cast<double>(c + 1) * alone.values[i], tolerance);
}

TEST(Inpaint, FillsComponentsThatMissDifferentPixels) {
  const Volume<double> gray = picture_of(layout(30, 30), smooth);
  VolumeLayout pair = gray;
  pair.components = 2;
  Volume<double> image(pair);
  for (std::size_t i = 0; i < gray.values.size(); ++i) image.values[2 * i] = image.values[2 * i + 1] = gray.values[i];
  image.values[2 * 200] = image.values[2 * 500 + 1] = std::nan("");
  const InpaintReport report = inpaint(image, Mask(gray.values.size(), 0));
  EXPECT_EQ(report.missing, 2);
  constexpr double tolerance = .1;  // one pixel among known ones
  EXPECT_NEAR(image.values[2 * 200], gray.values[200], tolerance);
  EXPECT_NEAR(image.values[2 * 500 + 1], gray.values[500], tolerance);
}

TEST(Inpaint, FillsEveryFrameByItselfWithACommonOrItsOwnMask) {
  VolumeLayout two = layout(30, 20);
  two.frames = 2;
  Volume<double> truth(two);
  const Volume<double> one = picture_of(layout(30, 20), smooth);
  for (std::size_t i = 0; i < one.values.size(); ++i) {
    truth.values[i] = one.values[i];
    truth.values[one.values.size() + i] = -3 * one.values[i];
  }
  const Mask mask = random_mask(truth.grid, .3, 7);
  Mask both = mask;
  both.insert(both.end(), mask.begin(), mask.end());
  Volume<double> common = spoiled(truth, mask), own = common;
  std::vector<double> fractions;
  const FitOptions options{.method = "partition-of-unity", .progress = [&](std::string_view, double fraction) {
                             fractions.push_back(fraction);
                             return true;
                           }};
  const InpaintReport report = inpaint(common, mask, options);
  inpaint(own, both, options);
  EXPECT_EQ(common.values, own.values);
  EXPECT_EQ(report.missing, 2 * static_cast<Index>(std::count(mask.begin(), mask.end(), 1)));
  constexpr double tolerance = 1;
  EXPECT_LT(largest_error(common, truth), 3 * tolerance);
  EXPECT_LE(*std::max_element(fractions.begin(), fractions.end()), 1);
}

TEST(Inpaint, SeesASliceOfAVolumeAsThePlaneThatItIs) {
  VolumeLayout flat = layout(30, 25), sagittal = layout(1, 30, 25);
  const Volume<double> truth = picture_of(flat, smooth);
  const Mask mask = random_mask(truth.grid, .4, 8);
  Volume<double> image = spoiled(truth, mask), slice(sagittal);
  slice.values = image.values;
  inpaint(image, mask);
  inpaint(slice, mask);
  EXPECT_EQ(slice.values, image.values);
}

TEST(Inpaint, DoesNotDependOnTheUnitOfLength) {
  const Volume<double> truth = picture_of(layout(40, 30), smooth);
  const Mask mask = random_mask(truth.grid, .4, 9);
  const FitOptions options{.method = "partition-of-unity"};
  Volume<double> image = spoiled(truth, mask), small = image;
  small.grid.spacing *= 0x1p-20;
  inpaint(image, mask, options);
  inpaint(small, mask, options);
  constexpr double round_off = 1e-6;
  EXPECT_LT(largest_error(small, image), round_off);
}

TEST(Inpaint, FillsALineAndAnImageOfOneKnownPixel) {
  Volume<double> line(layout(50, 1));
  for (std::size_t i = 0; i < 50; ++i) line.values[i] = static_cast<double>(i);
  line.values[20] = line.values[21] = std::nan("");
  inpaint(line, Mask(50, 0));
  constexpr double tolerance = 1e-3;
  EXPECT_NEAR(line.values[20], 20, tolerance);

  Volume<double> lonely(layout(4, 4), std::nan(""));
  lonely.values[5] = 7;
  inpaint(lonely, Mask(16, 0));
  EXPECT_EQ(lonely.values, std::vector<double>(16, 7.0));
}

TEST(Inpaint, WithoutMissingValuesDoesNothing) {
  Volume<float> image(layout(4, 4), 3.F);
  const InpaintReport report = inpaint(image, Mask(16, 0));
  EXPECT_EQ(report.missing, 0);
  EXPECT_EQ(report.known, 16);
  EXPECT_EQ(image.values, std::vector<float>(16, 3.F));
}

TEST(Inpaint, RefusesMasksOfAnotherSizeAndImagesOfWhichNothingIsKnown) {
  Volume<double> image(layout(4, 3), 1.0);
  EXPECT_EQ(invalid_input_message([&] { inpaint(image, Mask(11, 0)); }),
            "inpaint: entries of the mask = 11: there must be one per voxel (12) or per voxel of every frame");
  EXPECT_EQ(invalid_input_message([&] { inpaint(image, Mask(12, 1)); }),
            "inpaint: known voxels = 0: frame 1 has no known value");
  Mask one(12, 0);
  one[3] = 1;
  EXPECT_NE(invalid_input_message([&] { inpaint(image, one, {.method = "magic"}); }).find("method = magic"),
            std::string::npos);
  image.values.pop_back();
  EXPECT_NE(invalid_input_message([&] { inpaint(image, Mask(12, 0)); }).find("values of the image = 11"),
            std::string::npos);
}

}  // namespace
}  // namespace csrbf::inpaint_test
