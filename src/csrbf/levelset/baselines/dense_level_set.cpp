#include "csrbf/levelset/baselines/dense_level_set.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"

#include <utility>

namespace csrbf {
namespace {

constexpr Index grain = 1 << 12;  // voxels per task: stencils are costly
constexpr double tiny = 1e-8;     // a gradient of length 0 has no direction

double square(double x) {
  return x * x;
}

// |grad f| as it is where the front moves outwards (f rises) or inwards (Osher and Sethian 1988): differences are taken
// from the side that the front comes from.
double godunov(double backward, double forward, bool rising) {
  return rising ? std::max(square(std::min(backward, 0.0)), square(std::max(forward, 0.0)))
                : std::max(square(std::max(backward, 0.0)), square(std::min(forward, 0.0)));
}

}  // namespace

template <int Dim>
struct DenseLevelSet<Dim>::Stencil {
  std::array<std::array<Index, 2>, Dim> neighbor;  // below and above along each axis; itself at the border
  std::array<double, Dim> backward, forward, central, second, edge;
  std::array<std::array<double, Dim>, Dim> mixed;  // f_ab, a < b
  std::array<Index, Dim> at;
  double f;

  [[nodiscard]] double upwind_norm(bool rising) const {
    double sum = 0;
    for (Index a = 0; a < Dim; ++a) sum += godunov(backward[a], forward[a], rising);
    return std::sqrt(sum);
  }
  // |grad f| div(grad f / |grad f|)
  [[nodiscard]] double bending() const {
    double norm2 = square(tiny), laplacian = 0, along = 0;
    for (Index a = 0; a < Dim; ++a) {
      norm2 += square(central[a]);
      laplacian += second[a];
      along += square(central[a]) * second[a];
      for (std::size_t b = a + 1; b < Dim; ++b) along += 2 * central[a] * central[b] * mixed[a][b];
    }
    return laplacian - along / norm2;
  }
};

template <int Dim>
DenseLevelSet<Dim>::DenseLevelSet(const Grid& grid, std::vector<float> values, double band)
    : grid_(grid), values_(std::move(values)), band_(band) {
  require(grid.dimension() <= Dim, "DenseLevelSet", "dimension of the image", grid.dimension(),
          "must be that of the level set");
  require(std::ssize(values_) == grid.voxels(), "DenseLevelSet", "number of values", values_.size(),
          "must be one per voxel");
  require(band > 0, "DenseLevelSet", "band", band, "must be positive");
  find_band();
  widen_band(1);
}

template <int Dim>
void DenseLevelSet<Dim>::find_band() {
  active_.clear();
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const auto limit = static_cast<float>(band_);
    values_[i] = std::clamp(values_[i], -limit, limit);
    if (std::abs(values_[i]) < limit) active_.push_back(static_cast<Index>(i));
  }
}

// By face neighbours, so many times.
template <int Dim>
void DenseLevelSet<Dim>::widen_band(int voxels) {
  if (std::ssize(active_) == grid_.voxels()) return;
  std::vector<std::uint8_t> inside(values_.size(), 0);
  for (const Index i : active_) inside[i] = 1;
  std::size_t first = 0;
  for (int k = 0; k < voxels; ++k) {
    const std::size_t last = active_.size();
    for (; first < last; ++first) {
      Index rest = active_[first], stride = 1;
      const Index voxel = rest;
      for (Index a = 0; a < Dim; ++a) {
        const Index at = rest % grid_.size[a];
        for (const Index side : {-1, 1}) {
          if (at + side < 0 || at + side >= grid_.size[a]) continue;
          const Index next = voxel + side * stride;
          if (std::exchange(inside[next], std::uint8_t{1}) == 0) active_.push_back(next);
        }
        rest /= grid_.size[a];
        stride *= grid_.size[a];
      }
    }
  }
  std::sort(active_.begin(), active_.end());
}

template <int Dim>
typename DenseLevelSet<Dim>::Stencil DenseLevelSet<Dim>::stencil(const std::vector<float>& f, Index voxel) const {
  const auto value = [&f](Index i) { return static_cast<double>(f[i]); };
  Stencil s;
  s.f = value(voxel);
  Index rest = voxel, stride = 1;
  for (Index a = 0; a < Dim; ++a) {
    const double h = grid_.spacing[a];
    s.at[a] = rest % grid_.size[a];
    rest /= grid_.size[a];
    s.edge[a] = h;
    s.neighbor[a] = {s.at[a] > 0 ? voxel - stride : voxel, s.at[a] + 1 < grid_.size[a] ? voxel + stride : voxel};
    stride *= grid_.size[a];
    const double below = value(s.neighbor[a][0]), above = value(s.neighbor[a][1]);
    s.backward[a] = (s.f - below) / h;
    s.forward[a] = (above - s.f) / h;
    s.central[a] = (above - below) / (2 * h);
    s.second[a] = (above - 2 * s.f + below) / (h * h);
  }
  for (Index a = 0; a < Dim; ++a)
    for (std::size_t b = a + 1; b < Dim; ++b) {
      const Index down = s.neighbor[b][0] - voxel, up = s.neighbor[b][1] - voxel;
      s.mixed[a][b] = (value(s.neighbor[a][1] + up) - value(s.neighbor[a][1] + down) - value(s.neighbor[a][0] + up) +
                       value(s.neighbor[a][0] + down)) /
                      (4 * s.edge[a] * s.edge[b]);
    }
  return s;
}

// div((1 - 1 / |grad f|) grad f) by the flows through the faces of the voxel.
template <int Dim>
double DenseLevelSet<Dim>::penalty_rate(const Stencil& s) const {
  double sum = 0;
  for (Index a = 0; a < Dim; ++a)
    for (std::size_t side = 0; side < 2; ++side) {
      const double across = side == 0 ? s.backward[a] : s.forward[a];
      const Stencil next = stencil(values_, s.neighbor[a][side]);
      double norm2 = square(across) + square(tiny);
      for (Index b = 0; b < Dim; ++b)
        if (b != a) norm2 += square(0.5 * (s.central[b] + next.central[b]));
      sum += (side == 0 ? -1 : 1) * (1 - 1 / std::sqrt(norm2)) * across / s.edge[a];
    }
  return sum;
}

template <int Dim>
double DenseLevelSet<Dim>::stable_step(double largest_speed, const DenseMotion& motion) const {
  constexpr double safety = 0.9;  // conventional share of the largest stable step
  double waves = 0, decay = 0;
  for (Index a = 0; a < Dim; ++a) {
    waves += largest_speed / grid_.spacing[a];
    decay += (2 * motion.curvature + 4 * motion.penalty) / square(grid_.spacing[a]);
  }
  return safety / (waves + decay);
}

template <int Dim>
std::vector<float> DenseLevelSet<Dim>::rate(const DenseMotion& motion) const {
  std::vector<float> rate(active_.size());
  parallel_for(std::ssize(active_), grain, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      const Index i = active_[k];
      const auto voxel = static_cast<std::size_t>(i);
      const Stencil s = stencil(values_, i);
      double sum = 0;
      if (motion.speed != nullptr && motion.speed[voxel] != 0)
        sum += static_cast<double>(motion.speed[voxel]) * s.upwind_norm(motion.speed[voxel] > 0);
      if (motion.curvature > 0) sum += motion.curvature * s.bending();
      if (motion.penalty > 0) sum += motion.penalty * penalty_rate(s);
      rate[k] = static_cast<float>(sum);
    }
  });
  return rate;
}

template <int Dim>
void DenseLevelSet<Dim>::step(const DenseMotion& motion, double tau) {
  const std::vector<float> change = rate(motion);
  const auto limit = static_cast<float>(band_);
  for (std::size_t k = 0; k < active_.size(); ++k) {
    float& f = values_[active_[k]];
    f = std::clamp(f + static_cast<float>(tau) * change[k], -limit, limit);
  }
}

// Signed distances of the voxels next to the zero set; NaN elsewhere.
template <int Dim>
std::vector<float> DenseLevelSet<Dim>::anchors() const {
  std::vector<float> anchors(active_.size());
  parallel_for(std::ssize(active_), grain, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      const Stencil s = stencil(values_, active_[k]);
      double norm2 = 0;
      bool next_to = false;
      for (Index a = 0; a < Dim; ++a) {
        const double below = s.f - s.backward[a] * s.edge[a], above = s.f + s.forward[a] * s.edge[a];
        const bool crosses_below = (below > 0) != (s.f > 0), crosses_above = (above > 0) != (s.f > 0);
        next_to = next_to || crosses_below || crosses_above;
        // The slope at the zero; from both sides unless f has a kink there.
        double slope = std::abs(s.central[a]);
        if (crosses_below) slope = std::max(slope, std::abs(s.backward[a]));
        if (crosses_above) slope = std::max(slope, std::abs(s.forward[a]));
        norm2 += square(slope);
      }
      anchors[k] =
          next_to ? static_cast<float>(s.f / std::sqrt(norm2 + square(tiny))) : std::numeric_limits<float>::quiet_NaN();
    }
  });
  return anchors;
}

template <int Dim>
void DenseLevelSet<Dim>::reinitialize(int steps, int moved) {
  widen_band(moved);
  const std::vector<float> anchor = anchors();
  const double tau = 0.5 * grid_.spacing.template head<Dim>().minCoeff();
  const auto limit = static_cast<float>(band_);
  std::vector<float> next(active_.size());
  for (int step = 0; step < steps; ++step) {
    parallel_for(std::ssize(active_), grain, [&](Index begin, Index end) {
      for (Index k = begin; k < end; ++k) {
        next[k] = anchor[k];
        if (!std::isnan(anchor[k])) continue;
        const Stencil s = stencil(values_, active_[k]);
        const double sign = s.f > 0 ? 1 : -1;
        const double after = s.f + tau * sign * (1 - s.upwind_norm(sign < 0));
        next[k] = std::clamp(static_cast<float>(sign * std::max(sign * after, 0.0)), -limit, limit);
      }
    });
    for (std::size_t k = 0; k < active_.size(); ++k) values_[active_[k]] = next[k];
  }
  if (std::isfinite(band_)) {
    find_band();
    widen_band(1);
  }
}

template class DenseLevelSet<2>;
template class DenseLevelSet<3>;

}  // namespace csrbf
