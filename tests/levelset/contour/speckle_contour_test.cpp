#include "csrbf/levelset/contour/speckle_contour.hpp"

#include "csrbf/levelset/contour/contour_energy.hpp"
#include "levelset/speckle_testing.hpp"

namespace csrbf::speckle_contour_test {
namespace {

constexpr std::array<double, 3> grain{1.6, 1.1, 0};

SpeckleModel logarithms(double dark) {
  return {.exponent = 0.01, .mean = 180, .black = 180 - 8000, .power = {1, dark}, .grain = grain};
}

TEST(SpeckleContour, HasTheDerivativesOfItsEnergy) {
  const Phantom phantom = make_speckle(
      64, [](double x, double y) { return 20 - std::hypot(x, y); }, 0.1, 0, grain);
  const Grid& grid = phantom.image.grid;
  const Lattice<2> lattice(grid.size, grid.spacing, {5, 2.5, "wendland-c2"});
  std::vector<std::uint8_t> mask(phantom.truth.size(), 1);
  std::fill_n(mask.begin(), 300, std::uint8_t{0});
  std::vector<float> prior(mask.size(), 0.3F);
  const std::vector<float> start = coefficients_of_labels<2>(lattice, phantom.truth);
  SpeckleContour<2> contour(lattice, logarithms(0.1), phantom.image.values, mask, prior, start);
  std::vector<float> at = start, direction(start.size()), derivatives(start.size());
  std::mt19937 generator(3);
  for (std::size_t i = 0; i < at.size(); ++i) {
    at[i] += std::uniform_real_distribution<float>(-0.2F, 0.2F)(generator);
    direction[i] = std::uniform_real_distribution<float>(-1, 1)(generator);
  }
  contour.energy(at.data(), derivatives.data());
  double slope = 0;
  for (Index i = 0; i < lattice.coefficients(); ++i) slope += static_cast<double>(derivatives[i] * direction[i]);
  constexpr float h = 2e-3F;  // between the rounding of floats and the curvature of E
  const auto moved = [&](float t) {
    std::vector<float> there = at;
    for (std::size_t i = 0; i < there.size(); ++i) there[i] += t * direction[i];
    return contour.energy(there.data(), nullptr);
  };
  EXPECT_NEAR((moved(h) - moved(-h)) / (2 * static_cast<double>(h)), slope, 1e-2 * std::abs(slope));
}

// Started at the contour of half the way between the greys, which lies 1.6 voxels inside.
TEST(SpeckleContour, MovesToTheBorderOfTheCavity) {
  double radius_found = 0;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const auto disc = [](double radius) { return [=](double x, double y) { return radius - std::hypot(x, y); }; };
    const Phantom phantom = make_speckle(160, disc(45), 0.02, 0, grain, seed);
    const Grid& grid = phantom.image.grid;
    const Lattice<2> lattice(grid.size, grid.spacing, {8, 2.5, "wendland-c2"});
    std::vector<std::uint8_t> labels = make_phantom(160, disc(43.4), 1, 0).truth;
    const auto model = find_speckle<2>(phantom.image.values, grid, labels);
    ASSERT_TRUE(model);
    const std::vector<float> start = coefficients_of_labels<2>(lattice, labels);
    SpeckleContour<2> contour(lattice, *model, phantom.image.values, {}, {}, start);
    std::vector<double> energies;
    const std::vector<float> found = contour.descend(energies);
    ASSERT_GT(energies.size(), 2U);
    for (std::size_t i = 1; i < energies.size(); ++i) EXPECT_LE(energies[i], energies[i - 1]);
    update_labels(lattice, found, labels.data());
    double area = 0;
    for (const std::uint8_t label : labels) area += label;
    radius_found += std::sqrt(area / std::numbers::pi) / 3;
    EXPECT_GT(dice(labels, phantom.truth), 0.99);  // 0.45 voxels off on average
  }
  EXPECT_NEAR(radius_found, 45, 0.3);  // without the point spread it stays at 43.4
}

}  // namespace
}  // namespace csrbf::speckle_contour_test
