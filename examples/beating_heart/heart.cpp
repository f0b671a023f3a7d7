#include "heart.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace {

using csrbf::Index;
using csrbf::Point;
using std::numbers::pi;

// mm, at the end of diastole
constexpr double short_radius = 25, long_radius = 42, wall = 9;
constexpr double ovalness = 0.08, contraction = 0.28, shortening = 0.18, thickening = 4;
constexpr double border = 0.8;  // width of the edges of the image
constexpr float blood = 190, muscle = 80, tissue = 95;

// How far the heart has contracted: fast out, slowly back.
double contracted(double phase) {
  constexpr double systole = 0.36;
  return phase < systole ? 0.5 * (1 - std::cos(pi * phase / systole))
                         : 0.5 * (1 + std::cos(pi * (phase - systole) / (1 - systole)));
}

Point<3> center(const Heart& heart, double phase) {
  const double half = 0.5 * static_cast<double>(heart.size - 1) * heart.voxel;
  return {half + 3 * contracted(phase), half - 2 * contracted(phase), heart.dimension == 3 ? half : 0.0};
}

struct Radii {
  double x, y, z;
};

Radii radii(double phase) {
  const double s = contracted(phase), r = short_radius * (1 - contraction * s);
  return {r * (1 + ovalness), r * (1 - ovalness), long_radius * (1 - shortening * s)};
}

// About the distance to an ellipsoid with these radii, positive inside; in the plane to the ellipse.
double ellipsoid_depth(const Heart& heart, const Point<3>& q, const Radii& r, double grow) {
  const Point<3> by(q.x() / (r.x + grow), q.y() / (r.y + grow), heart.dimension == 3 ? q.z() / (r.z + grow) : 0);
  const Point<3> slope(by.x() / (r.x + grow), by.y() / (r.y + grow), heart.dimension == 3 ? by.z() / (r.z + grow) : 0);
  const double length = by.norm();
  if (length < 1e-9) return r.y + grow;
  return (1 - length) * length / slope.norm();
}

double papillary_depth(const Heart& heart, const Point<3>& q, const Radii& r) {
  double depth = -1e9;
  for (const double angle : {0.6, 2.3}) {
    const double radius = 2.6;
    const Point<3> at(0.4 * r.x * std::cos(angle), 0.4 * r.y * std::sin(angle), 0);
    Point<3> off = q - at;
    if (heart.dimension == 3) off.z() /= 4;  // they run along the axis
    depth = std::max(depth, radius - off.norm());
  }
  return depth;
}

// Share of a voxel that is inside something of this depth.
float cover(double depth) {
  return static_cast<float>(0.5 * (1 + std::erf(depth / border)));
}

double phase_of(const Heart& heart, Index frame) {
  return static_cast<double>(frame) / static_cast<double>(heart.frames);
}

template <class Use>
void for_voxels(const Heart& heart, const Use& use) {
  const Index depth = heart.dimension == 3 ? heart.size : 1;
  Index i = 0;
  for (Index z = 0; z < depth; ++z)
    for (Index y = 0; y < heart.size; ++y)
      for (Index x = 0; x < heart.size; ++x, ++i)
        use(i,
            Point<3>(heart.voxel * Point<3>(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z))));
}

}  // namespace

double cavity_depth(const Heart& heart, const Point<3>& p, double phase) {
  return ellipsoid_depth(heart, p - center(heart, phase), radii(phase), 0);
}

double cavity_volume(const Heart& heart, double phase) {
  const Radii r = radii(phase);
  return heart.dimension == 2 ? pi * r.x * r.y : 4.0 / 3 * pi * r.x * r.y * r.z;
}

csrbf::Volume<float> make_sequence(const Heart& heart) {
  csrbf::VolumeLayout layout;
  layout.grid.axes = heart.dimension;
  layout.grid.size = {heart.size, heart.size, heart.dimension == 3 ? heart.size : 1};
  layout.grid.spacing.setConstant(heart.voxel);
  layout.frames = heart.frames;
  layout.time_step = 1.0 / static_cast<double>(heart.frames);
  csrbf::Volume<float> sequence(layout);
  for (Index t = 0; t < heart.frames; ++t) {
    const double phase = phase_of(heart, t);
    const Radii r = radii(phase);
    const Point<3> middle = center(heart, phase);
    const double grow = wall + thickening * contracted(phase);
    float* values = sequence.values.data() + t * sequence.values_per_frame();
    for_voxels(heart, [&](Index i, const Point<3>& p) {
      const Point<3> q = p - middle;
      float value = tissue + (muscle - tissue) * cover(ellipsoid_depth(heart, q, r, grow));
      const float cavity = cover(ellipsoid_depth(heart, q, r, 0)) * (1 - cover(papillary_depth(heart, q, r)));
      values[i] = value + (blood - value) * cavity;
    });
  }
  // The variance of the first frame says how strong the noise is.
  const auto first = sequence.frame(0);
  const double mean = static_cast<double>(first.mean());
  const double variance = (first.cast<double>().array() - mean).square().mean();
  const double sd = std::sqrt(variance / std::pow(10, heart.decibels / 10));
  std::mt19937 random(heart.seed);
  std::normal_distribution<double> normal;
  for (float& value : sequence.values) {
    const double draw = normal(random);
    if (heart.noise == Noise::gaussian) {
      value += static_cast<float>(sd * draw);
    } else {  // grows with the brightness
      value = std::max(0.0F, value * (1 + static_cast<float>(sd / mean * draw)));
    }
  }
  return sequence;
}

std::vector<std::uint8_t> true_labels(const Heart& heart, Index frame) {
  std::vector<std::uint8_t> labels;
  for_voxels(heart, [&](Index, const Point<3>& p) {
    labels.push_back(cavity_depth(heart, p, phase_of(heart, frame)) > 0 ? 1 : 0);
  });
  return labels;
}
