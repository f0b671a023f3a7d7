#include "csrbf/implicit/sample_particles.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/mesh/sample_surface.hpp"
#include "csrbf/spatial/kd_tree.hpp"

namespace csrbf {
namespace {

// Constants of Witkin and Heckbert, in units of the desired radius; neighbours come to rest at about two radii.
constexpr double energy_scale = 6;                     // alpha
constexpr double desired_energy = 0.8 * energy_scale;  // E^
constexpr double feedback = 15;                        // phi and rho
constexpr double stiffness = 10;                       // beta, keeps lone particles from growing too fast
constexpr double time_step = 0.03;                     // Delta t
constexpr double rest_speed = 4;                       // gamma, radii per unit of time: slow enough to split or die
constexpr double split_energy = 0.2;  // nu: share of the desired energy above which a large particle splits
constexpr double death_radius = 0.7;  // delta: radius below which a particle may die
// Not from the paper; chosen by hand.
constexpr double largest_radius = 1.5;                   // above, a particle splits whatever its energy
constexpr double least_radius = 0.1, most_radius = 1.8;  // range of radii: keeps neighbourhoods small
constexpr double reach = 3;           // largest radii within which particles interact: energies beyond are about 1 %
constexpr double longest_move = 0.5;  // of a radius in one step, for stability
constexpr double rest_step = 0.02;    // largest step of particles at rest
constexpr int projections = 8;        // Newton steps onto the surface
constexpr Index grain = 64;           // particles per task

struct Particle {
  Point<3> p = Point<3>::Zero();  // in units of the desired radius
  double radius = 1;
  double energy = 0;
  double radius_rate = 0;
  Point<3> velocity = Point<3>::Zero();
};

class Population {
 public:
  Population(const Field<3>& field, double level, const Point<3>& center, double unit, std::uint64_t random)
      : field_(field), level_(level), center_(center), unit_(unit), random_(random) {}

  void seed(const Points<3>& seeds) {
    for (Index i = 0; i < seeds.cols(); ++i) particles_.push_back({(seeds.col(i) - center_) / unit_});
    project();
  }

  // Moves all particles by a step, then lets them split and die. Returns whether all are at rest.
  bool step(int iteration) {
    const Jet<3> jet = evaluate();
    push_apart(jet.gradient);
    constrain(jet);
    double fastest = 0;
    for (Particle& particle : particles_) {
      const double share = std::min(1.0, longest_move * particle.radius / (time_step * particle.velocity.norm()));
      particle.p += share * time_step * particle.velocity;
      const double radius = std::clamp(particle.radius + time_step * particle.radius_rate, least_radius, most_radius);
      fastest = std::max({fastest, time_step * particle.velocity.norm(), std::abs(radius - particle.radius)});
      particle.radius = radius;
    }
    return !split_and_die(iteration, jet.gradient) && fastest < rest_step;
  }

  // Newton steps onto the surface; particles that do not converge are dropped.
  void project() {
    Jet<3> jet;
    for (int i = 0; i < projections; ++i) {
      jet = evaluate();
      for (Index k = 0; k < std::ssize(particles_); ++k) particles_[k].p += newton(jet, k);
    }
    jet = evaluate();
    Index kept = 0;
    for (Index k = 0; k < std::ssize(particles_); ++k)
      if (newton(jet, k).norm() < 1e-3) particles_[kept++] = particles_[k];
    particles_.resize(kept);
  }

  [[nodiscard]] bool empty() const { return particles_.empty(); }

  [[nodiscard]] Particles result() const {
    Particles found;
    found.points = points();
    const Jet<3> jet = evaluate();
    found.normals = -jet.gradient.colwise().normalized();
    return found;
  }

 private:
  [[nodiscard]] Points<3> points() const {
    Points<3> all(3, std::ssize(particles_));
    for (Index k = 0; k < all.cols(); ++k) all.col(k) = center_ + unit_ * particles_[k].p;
    return all;
  }

  // f - level and its gradient per desired radius.
  [[nodiscard]] Jet<3> evaluate() const {
    Jet<3> jet = field_.evaluate(points(), Derivatives::gradient);
    jet.value.array() -= level_;
    jet.gradient *= unit_;
    return jet;
  }

  static Point<3> newton(const Jet<3>& jet, Index i) {
    const Point<3> gradient = jet.gradient.col(i);
    const double slope = gradient.norm(), step = -jet.value[i] / slope;
    if (!std::isfinite(step)) return Point<3>::Constant(std::numeric_limits<double>::infinity());
    return std::clamp(step, -1.0, 1.0) * gradient / slope;
  }

  // Energies, unconstrained velocities and the rates of the radii. Particles with opposite normals are on two sheets
  // and do not interact.
  void push_apart(const Points<3>& gradient) {
    const auto n = std::ssize(particles_);
    Points<3> p(3, n);
    for (Index i = 0; i < n; ++i) p.col(i) = particles_[i].p;
    const KdTree<3> tree(p);
    parallel_for(n, grain, [&](Index begin, Index end) {
      std::vector<Index> near;
      for (Index i = begin; i < end; ++i) {
        Particle& self = particles_[i];
        tree.within(p.col(i), reach * largest_radius, near);
        self.energy = 0;
        self.velocity.setZero();
        double growth = 0;  // of the energy with the radius
        for (const Index j : near) {
          if (j == i || gradient.col(i).dot(gradient.col(j)) < 0) continue;
          const Point<3> r = p.col(i) - p.col(j);
          const double other = particles_[j].radius, r2 = r.squaredNorm();
          const double e = energy_scale * std::exp(-r2 / (2 * self.radius * self.radius));
          const double e_other = energy_scale * std::exp(-r2 / (2 * other * other));
          self.energy += e;
          growth += r2 * e / std::pow(self.radius, 3);
          self.velocity +=
              self.radius * self.radius * (r * e / (self.radius * self.radius) + r * e_other / (other * other));
        }
        self.radius_rate = feedback * (desired_energy - self.energy) / (growth + stiffness);
      }
    });
  }

  // Removes the normal component of the velocities, and adds the feedback towards the surface.
  void constrain(const Jet<3>& jet) {
    for (Index i = 0; i < std::ssize(particles_); ++i) {
      const Point<3> gradient = jet.gradient.col(i);
      const double along = gradient.dot(particles_[i].velocity) + feedback * jet.value[i];
      const Point<3> correction = gradient * (along / gradient.squaredNorm());
      if (correction.allFinite()) particles_[i].velocity -= correction;
    }
  }

  bool split_and_die(int iteration, const Points<3>& gradient) {
    std::vector<Particle> next;
    bool changed = false;
    for (std::size_t k = 0; k < particles_.size(); ++k) {
      Particle particle = particles_[k];
      const auto draw = [&](std::uint64_t i) {
        return hash_uniform(random_ + static_cast<std::uint64_t>(iteration), k, i);
      };
      const bool slow = particle.velocity.norm() < rest_speed * particle.radius;
      const bool large =
          particle.radius > largest_radius || (particle.energy > split_energy * desired_energy && particle.radius > 1);
      if (slow && particle.radius < death_radius && draw(0) > particle.radius / death_radius) {
        changed = true;
        continue;
      }
      if (slow && large) {
        changed = true;
        const Point<3> normal = gradient.col(k).stableNormalized();
        Point<3> direction(draw(1) - 0.5, draw(2) - 0.5, draw(3) - 0.5);
        direction = (direction - normal.dot(direction) * normal).stableNormalized();  // stays on its sheet
        particle.radius /= std::sqrt(2.0);
        Particle twin = particle;
        particle.p += 0.5 * particle.radius * direction;
        twin.p -= 0.5 * particle.radius * direction;
        next.push_back(twin);
      }
      next.push_back(particle);
    }
    particles_.swap(next);
    return changed;
  }

  const Field<3>& field_;
  double level_;
  Point<3> center_;
  double unit_;
  std::uint64_t random_;
  std::vector<Particle> particles_;
};

}  // namespace

Particles sample_particles(const Field<3>& field, const ParticleOptions& options) {
  const Box<3> box = field.bounds();
  const double diagonal = box.diagonal();
  require(diagonal > 0 && std::isfinite(diagonal), "sample_particles", "diagonal of field.bounds()", diagonal,
          "must be positive and finite");
  require(options.spacing >= 1e-3 && options.spacing <= 1, "sample_particles", "spacing", options.spacing,
          "must be between 0.001 and 1 of the diagonal");
  require(std::isfinite(options.level), "sample_particles", "level", options.level, "must be finite");
  require(options.iterations >= 1, "sample_particles", "iterations", options.iterations, "must be at least 1");
  const Points<3> seeds = options.seeds.cols() > 0 ? options.seeds : field.seeds();
  require(seeds.cols() > 0 && seeds.allFinite(), "sample_particles", "seeds", seeds.cols(),
          "must be at least one finite point; the field has none of its own");

  Population population(field, options.level, box.center(), 0.5 * options.spacing * diagonal, options.random);
  population.seed(seeds);
  if (population.empty()) throw SolverFailure("sample_particles: no seed reaches the surface; start closer to it");
  int iterations = 0;
  bool converged = false;
  while (iterations < options.iterations && !converged) {
    report(options.progress, "particles", static_cast<double>(iterations) / options.iterations);
    converged = population.step(iterations++);
  }
  population.project();
  report(options.progress, "particles", 1);
  Particles found = population.result();
  found.iterations = iterations;
  found.converged = converged;
  return found;
}

}  // namespace csrbf
