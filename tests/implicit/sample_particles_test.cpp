#include "csrbf/implicit/sample_particles.hpp"

#include "core/error_testing.hpp"
#include "implicit/polygonize_fields.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"

namespace csrbf::sample_particles_test {
namespace {

// Distance of each particle to the nearest other one.
Eigen::ArrayXd gaps(const Particles& particles) {
  const KdTree<3> tree(particles.points);
  Eigen::ArrayXd gap(particles.points.cols());
  for (Index i = 0; i < gap.size(); ++i) {
    std::array<Index, 2> index{};
    std::array<double, 2> squared{};
    (void)tree.nearest(particles.points.col(i), 2, index.data(), squared.data());
    gap[i] = std::sqrt(squared[1]);
  }
  return gap;
}

TEST(SampleParticles, CoversATorusEvenlyFromOneSeed) {
  const Implicit ring = torus(1, 0.4);
  for (const double share : {0.1, 0.05}) {
    const Particles particles = sample_particles(ring, {.spacing = share});
    const double spacing = share * ring.bounds().diagonal(), area = 4 * pi * pi * 0.4;
    EXPECT_TRUE(particles.converged);
    EXPECT_LT(ring.evaluate(particles.points).value.cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_GT(gaps(particles).minCoeff(), 0.5 * spacing);
    EXPECT_LT(gaps(particles).maxCoeff(), 1.1 * spacing);
    const double packed = area / (std::sqrt(0.75) * spacing * spacing);  // triangles with sides of that length
    EXPECT_GT(static_cast<double>(particles.points.cols()), packed);
    EXPECT_LT(static_cast<double>(particles.points.cols()), 1.5 * packed);
    // Nowhere is a hole: every point of a fine mesh has a particle nearby.
    const KdTree<3> tree(particles.points);
    const Mesh mesh = polygonize(ring, {.resolution = 60});
    for (Index v = 0; v < mesh.vertices.cols(); ++v) {
      Index nearest = 0;
      double squared = 0;
      (void)tree.nearest(mesh.vertices.col(v), 1, &nearest, &squared);
      EXPECT_LT(std::sqrt(squared), spacing);
    }
  }
}

TEST(SampleParticles, NormalsPointOutward) {
  const Particles particles = sample_particles(sphere(1), {.spacing = 0.1});
  const Points<3> expected = (particles.points.colwise() - off_center).colwise().normalized();
  EXPECT_LT((particles.normals - expected).colwise().norm().maxCoeff(), 1e-9);
}

TEST(SampleParticles, StaysOnTheComponentOfItsSeeds) {
  const Implicit shell = thin_shell(0.3);
  const Particles outer = sample_particles(shell, {.spacing = 0.08, .seeds = columns({{0, 1, 0}})});
  EXPECT_GT(outer.points.colwise().norm().minCoeff(), 1 - 1e-9);
}

TEST(SampleParticles, SeesTheSheetsOfAThinShellApart) {
  const Particles both = sample_particles(thin_shell(0.05), {.spacing = 0.08});  // 0.28, more than the thickness
  const Particles outer = sample_particles(thin_shell(0.05), {.spacing = 0.08, .seeds = columns({{1, 0, 0}})});
  const Eigen::ArrayXd radii = both.points.colwise().norm();
  const auto on_outer = static_cast<double>((radii > 0.975).count());
  const auto on_inner = static_cast<double>((radii < 0.975).count());
  const double ratio_of_areas = 0.95 * 0.95;
  EXPECT_NEAR(on_outer, static_cast<double>(outer.points.cols()), 0.1 * on_outer);
  EXPECT_NEAR(on_inner, ratio_of_areas * on_outer, 0.1 * on_outer);
}

TEST(SampleParticles, DependsOnTheOptionsOnly) {
  const Particles first = sample_particles(sphere(1), {.spacing = 0.1});
  set_thread_count(1);
  EXPECT_TRUE(sample_particles(sphere(1), {.spacing = 0.1}).points == first.points);
  set_thread_count(0);
  const Particles other = sample_particles(sphere(1), {.spacing = 0.1, .random = 8});
  EXPECT_FALSE(other.points.cols() == first.points.cols() && other.points == first.points);
}

TEST(SampleParticles, RefusesWhatItCannotSample) {
  const auto message = [](const Field<3>& field, const ParticleOptions& options) {
    return invalid_input_message([&] { (void)sample_particles(field, options); });
  };
  const Implicit ball_field = sphere(1);
  EXPECT_EQ(message(ball_field, {.spacing = 0}),
            "sample_particles: spacing = 0: must be between 0.001 and 1 of the diagonal");
  EXPECT_EQ(message(ball_field, {.level = std::nan("")}), "sample_particles: level = nan: must be finite");
  EXPECT_EQ(message(ball_field, {.iterations = 0}), "sample_particles: iterations = 0: must be at least 1");
  EXPECT_NE(message(gyroid(), {}).find("sample_particles: seeds = 0: must be at least one"), std::string::npos);
  const Implicit unbounded([](const Point<3>& p, Point<3>& g) { return ball(p, Point<3>::Zero(), 1, g); }, Box<3>{});
  EXPECT_NE(message(unbounded, {}).find("sample_particles: diagonal of field.bounds() = 0"), std::string::npos);
  EXPECT_THROW((void)sample_particles(ball_field, {.level = 10}), SolverFailure);
}

TEST(SampleParticles, ReportsAndCanBeCancelled) {
  int calls = 0;
  const auto stop = [&](std::string_view stage, double) {
    EXPECT_EQ(stage, "particles");
    return ++calls < 5;
  };
  EXPECT_THROW((void)sample_particles(sphere(1), {.progress = stop}), Cancelled);
}

}  // namespace
}  // namespace csrbf::sample_particles_test
