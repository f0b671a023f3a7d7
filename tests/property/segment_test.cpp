#include "csrbf/levelset/segment.hpp"

#include "property/property_testing.hpp"

#include <array>
#include <limits>

namespace csrbf::segment_test {
namespace {

// Small images of all kinds: noise, two levels, outliers, huge, tiny and negative values, a ramp, a checkerboard,
// constant; some are one voxel thick, some have voxels of very different edges.
Volume<float> random_image(Random& random, int dim) {
  VolumeLayout layout;
  layout.grid.axes = dim;
  const int most = dim == 2 ? 40 : 12;
  const int least = random.one_in(6) ? 1 : 2;
  layout.grid.size = {random.whole(least, most), random.whole(least, most), dim == 3 ? random.whole(least, most) : 1};
  for (int a = 0; a < 3; ++a) layout.grid.spacing[a] = 0.1 * random.whole(1, 30);
  if (random.one_in(8)) layout.grid.spacing[0] *= 100;
  if (random.one_in(5)) layout.grid.spacing *= random.magnitude(-9, 9);
  Volume<float> image(layout);
  const int kind = random.whole(0, 7);
  const auto size = layout.grid.size;
  for (Index i = 0; i < layout.grid.voxels(); ++i) {
    const auto x = static_cast<float>(random.unit());
    const Index parity = (i + i / size[0] + i / size[0] / size[1]) % 2;
    const std::array<float, 8> values{x,           x > 0.5F ? 1.0F : 0.0F, i % 7 == 0 ? 1e6F + x : x,  1e20F * x,
                                      -1e-20F * x, static_cast<float>(i),  static_cast<float>(parity), 7};
    image.values[i] = values[kind];
  }
  if (random.one_in(20)) image.values.front() = std::numeric_limits<float>::quiet_NaN();
  return image;
}

std::vector<std::uint8_t> random_bits(Random& random, std::size_t n, int one_in) {
  std::vector<std::uint8_t> bits(n);
  for (std::uint8_t& bit : bits) bit = random.one_in(one_in) ? 1 : 0;
  return bits;
}

SegmentOptions random_options(Random& random, Volume<float>& image) {
  const std::size_t n = image.values.size();
  SegmentOptions options;
  options.energy = static_cast<SegmentEnergy>(random.whole(0, 5));
  options.mode = static_cast<SegmentMode>(random.whole(0, 1));
  options.method = random.one_in(4) ? static_cast<SegmentMethod>(random.whole(1, 2)) : SegmentMethod::variational;
  options.regions = random.one_in(4) ? random.whole(2, 5) : 2;
  if (random.one_in(2)) options.center_spacing = 1 + 0.1 * random.whole(0, 100);
  if (random.one_in(2)) options.support = 1.1 + 0.1 * random.whole(0, 30);
  if (random.one_in(2)) options.smoothness = 0.1 * random.whole(0, 50);
  if (random.one_in(2)) options.window = random.whole(0, 9);
  options.shading = static_cast<Shading>(random.whole(0, 3));
  options.balloon = 0.1 * random.whole(-10, 10);
  options.iterations = random.whole(1, 8);
  if (random.one_in(3)) options.kernel = "wendland-c4";
  if (random.one_in(2)) options.seed = random_bits(random, n, 4);
  if (random.one_in(3)) {
    options.mask = random_bits(random, n, 4);
    for (std::size_t i = 0; i < n; ++i) {
      options.mask[i] = 1 - options.mask[i];
      if (options.mask[i] == 0 && random.one_in(4)) image.values[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  if (random.one_in(4)) options.start = random_bits(random, n, 2);
  if (random.one_in(4)) {
    options.prior.resize(n);
    for (float& cost : options.prior) cost = static_cast<float>(2 * random.unit() - 1);
  }
  return options;
}

template <int Dim>
void expect_sound(const Volume<float>& image, const SegmentOptions& options) {
  const Segmentation<Dim> result = segment<Dim>(image, options);
  ASSERT_EQ(result.labels.size(), image.values.size());
  for (std::size_t i = 0; i < result.labels.size(); ++i) {
    ASSERT_LT(result.labels[i], options.regions);
    ASSERT_TRUE(options.mask.empty() || options.mask[i] != 0 || result.labels[i] == 0);
  }
  ASSERT_FALSE(result.report.energy.empty());
  for (std::size_t i = 0; i < result.report.energy.size(); ++i) {
    ASSERT_TRUE(std::isfinite(result.report.energy[i]));
    if (i > 0 && options.method == SegmentMethod::variational) {
      ASSERT_LE(result.report.energy[i], result.report.energy[i - 1]);
    }
  }
  const Points<Dim> centers = image.grid.centers<Dim>();
  ASSERT_EQ(result.fields.size(), options.regions == 2 ? 1U : static_cast<std::size_t>(options.regions));
  for (const auto& field : result.fields) {
    const Jet<Dim> jet = field->evaluate(centers, Derivatives::hessian);
    ASSERT_TRUE(jet.value.allFinite() && jet.gradient.allFinite() && jet.hessian.allFinite());
  }
}

TEST(SegmentProperties, AnyImageIsPartedSoundlyOrAnErrorSaysWhyNot) {
  for_each_case(75, 4, [](Random& random) {
    const int dim = random.whole(2, 3);
    Volume<float> image = random_image(random, dim);
    const SegmentOptions options = random_options(random, image);
    if (dim == 2)
      expect_sound<2>(image, options);
    else
      expect_sound<3>(image, options);
  });
}

}  // namespace
}  // namespace csrbf::segment_test
