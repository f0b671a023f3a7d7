#include "phantoms.hpp"

#include "csrbf/core/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace csrbf::thesis {
namespace {

constexpr double dark = 40, contrast = 170;

Volume<float> empty_image(Index width, Index height, Index depth = 1) {
  VolumeLayout layout;
  layout.grid.axes = depth > 1 ? 3 : 2;
  layout.grid.size = {width, height, depth};
  return Volume<float>(layout);
}

// Convolution with a Gaussian along one axis; the image goes on mirrored beyond its border.
void blur(std::vector<float>& values, const Grid& grid, std::size_t axis, double deviation) {
  const auto reach = static_cast<Index>(std::ceil(4 * deviation));
  std::vector<double> weights(reach + 1);
  double sum = 0;
  for (Index k = 0; k <= reach; ++k) {
    const double t = static_cast<double>(k) / deviation;
    weights[k] = std::exp(-0.5 * t * t);
    sum += (k == 0 ? 1 : 2) * weights[k];
  }
  const Index n = grid.size[axis];
  const Index stride = axis == 0 ? 1 : axis == 1 ? grid.size[0] : grid.size[0] * grid.size[1];
  const Index lines = grid.voxels() / n;
  parallel_for(lines, 64, [&](Index begin, Index end) {
    std::vector<float> line(n);
    for (Index l = begin; l < end; ++l) {
      const Index first = (l / stride) * stride * n + l % stride;
      for (Index i = 0; i < n; ++i) line[i] = values[first + i * stride];
      for (Index i = 0; i < n; ++i) {
        double value = 0;
        for (Index k = -reach; k <= reach; ++k) {
          const Index turned = (((i + k) % (2 * n)) + 2 * n) % (2 * n);
          const Index at = turned < n ? turned : 2 * n - 1 - turned;
          value += weights[std::abs(k)] * static_cast<double>(line[at]);
        }
        values[first + i * stride] = static_cast<float>(value / sum);
      }
    }
  });
}

// A square picture whose pixels hold the share of themselves with inside(x, y) > 0, coordinates from the middle.
Phantom covered(Index n, double edge, const std::function<double(double, double)>& inside) {
  constexpr int parts = 4;
  Phantom phantom{empty_image(n, n), {}};
  const double middle = 0.5 * static_cast<double>(n - 1);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) {
      int count = 0;
      for (int j = 0; j < parts; ++j)
        for (int i = 0; i < parts; ++i)
          count += inside(static_cast<double>(x) + (i + 0.5) / parts - 0.5 - middle,
                          static_cast<double>(y) + (j + 0.5) / parts - 0.5 - middle) > 0
                       ? 1
                       : 0;
      const double share = static_cast<double>(count) / (parts * parts);
      phantom.image.values[x + n * y] = static_cast<float>(share);
      phantom.truth.push_back(share >= 0.5 ? 1 : 0);
    }
  for (std::size_t axis = 0; axis < 2; ++axis) blur(phantom.image.values, phantom.image.grid, axis, edge);
  for (float& value : phantom.image.values) value = static_cast<float>(dark + contrast * static_cast<double>(value));
  return phantom;
}

// Complex Gaussian reflections, weaker in the object, seen through a Gaussian pulse; 50 dB of the envelope as 0..255.
Phantom speckled(Index width, Index height, unsigned seed, const std::function<bool(double, double)>& inside) {
  constexpr double weak = 0.12, decibels = 50;
  constexpr double along = 1.0, across = 1.8;  // of the beam, which runs along y
  Phantom phantom{empty_image(width, height), {}};
  std::vector<float>& real = phantom.image.values;
  std::vector<float> imaginary(real.size());
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 1);
  for (Index y = 0; y < height; ++y)
    for (Index x = 0; x < width; ++x) {
      const bool object = inside(static_cast<double>(x), static_cast<double>(y));
      const auto i = static_cast<std::size_t>(x + width * y);
      phantom.truth.push_back(object ? 1 : 0);
      real[i] = static_cast<float>((object ? weak : 1) * normal(random));
      imaginary[i] = static_cast<float>((object ? weak : 1) * normal(random));
    }
  for (std::vector<float>* part : {&real, &imaginary}) {
    blur(*part, phantom.image.grid, 0, across);
    blur(*part, phantom.image.grid, 1, along);
  }
  float largest = 0;
  for (std::size_t i = 0; i < real.size(); ++i)
    largest = std::max(largest, real[i] = std::hypot(real[i], imaginary[i]));
  for (float& value : real) {
    const double level = 20 * std::log10(std::max(static_cast<double>(value / largest), 1e-9));
    value = static_cast<float>(std::clamp((level + decibels) / decibels * 255, 0.0, 255.0));
  }
  return phantom;
}

}  // namespace

Phantom holed_shape() {
  return covered(311, 3, [](double x, double y) {
    const double angle = std::atan2(y, x), radius = std::hypot(x, y);
    const double body = 95 + 18 * std::cos(3 * angle + 0.4) + 8 * std::sin(5 * angle) - radius;
    return std::min({body, std::hypot(x + 35, y + 10) - 24, std::hypot(x - 38, y - 22) - 20});
  });
}

Phantom star() {
  return covered(446, 1,
                 [](double x, double y) { return 120 + 70 * std::cos(11 * std::atan2(y, x)) - std::hypot(x, y); });
}

Phantom speckled_cavities(unsigned seed) {
  return speckled(249, 249, seed, [](double x, double y) {
    return std::hypot((x - 120) / 70, (y - 125) / 88) < 1 || std::hypot((x - 185) / 38, (y - 70) / 40) < 1;
  });
}

Phantom speckled_wall(unsigned seed) {
  return speckled(40, 249, seed, [](double x, double y) {
    const double bend = 6 * std::cos((x - 18) / 9);
    return (y > 38 + bend && y < 128 - 1.5 * bend) || y > 205 + bend;
  });
}

Trabeculae::Trabeculae(Index n) : n_(n), frequency_(6 * std::numbers::pi / static_cast<double>(n)) {}

void Trabeculae::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  constexpr Index diagonal[] = {0, 3, 5}, beside[] = {1, 4, 2};  // xx yy zz, xy yz zx of the upper triangle
  const double w = frequency_;
  for (Index i = 0; i < x.cols(); ++i) {
    const Eigen::Array3d s = (w * x.col(i).array()).sin(), c = (w * x.col(i).array()).cos();
    // sin x cos y + sin y cos z + sin z cos x: b follows a, and a follows d.
    out.value[i] = -(s[0] * c[1] + s[1] * c[2] + s[2] * c[0]) - 0.35;
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3, d = (a + 2) % 3;
      if (out.gradient != nullptr) out.gradient[3 * i + a] = -w * (c[a] * c[b] - s[d] * s[a]);
      if (out.hessian == nullptr) continue;
      out.hessian[6 * i + diagonal[a]] = w * w * (s[a] * c[b] + s[d] * c[a]);
      out.hessian[6 * i + beside[a]] = w * w * c[a] * s[b];
    }
  }
}

Box<3> Trabeculae::bounds() const {
  const double last = static_cast<double>(n_) - 1;
  return {{0, 0, 0}, {last, last, last}};
}

Phantom bone(Index n) {
  Phantom phantom{empty_image(n, n, n), {}};
  const Eigen::VectorXd f = Trabeculae(n).evaluate(phantom.image.grid.centers<3>()).value;
  for (Index i = 0; i < f.size(); ++i) {
    phantom.truth.push_back(f[i] > 0 ? 1 : 0);
    phantom.image.values[i] = f[i] > 0 ? 1 : 0;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) blur(phantom.image.values, phantom.image.grid, axis, 1);
  for (float& value : phantom.image.values) value = static_cast<float>(dark + contrast * static_cast<double>(value));
  return phantom;
}

void add_white_noise(Volume<float>& image, double snr, unsigned seed) {
  const Eigen::Map<const Eigen::VectorXf> values(image.values.data(), static_cast<Index>(image.values.size()));
  const Eigen::VectorXd v = values.cast<double>();
  const double variance = (v.array() - v.mean()).square().mean();
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, std::sqrt(variance / std::pow(10, snr / 10)));
  for (float& value : image.values) value = static_cast<float>(static_cast<double>(value) + noise(random));
}

}  // namespace csrbf::thesis
