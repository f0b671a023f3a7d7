#include "csrbf/levelset/disturbances/fringes.hpp"

#include "csrbf/core/percentile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace csrbf {
namespace {

using Complex = std::complex<float>;

constexpr double fewest_waves = 4;  // across the longest side; by hand: less is light
constexpr double far_above = 60;    // times the median power close by; by hand: of 1e6 of noise, one has 20
constexpr double above_ridge = 10;  // times that of the frequencies along an axis; by hand
constexpr Index reach = 9;          // frequencies that are close by
constexpr std::size_t most_waves = 64;
constexpr int rounds = 3;         // weak waves are seen once strong ones are gone
constexpr Index least_side = 32;  // voxels

// The next number that has no prime factor but 2, 3 and 5.
Index smooth_size(Index n) {
  for (;; ++n) {
    Index left = n;
    for (const Index factor : {2, 3, 5})
      while (left % factor == 0) left /= factor;
    if (left == 1) return n;
  }
}

std::vector<double> hann(Index n) {
  std::vector<double> result(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i)
    result[i] = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(n));
  return result;
}

struct Wave {
  double x, y;  // radians per voxel
  double power;
};

class FringeFinder {
 public:
  FringeFinder(std::span<const float> values, const Grid& grid, std::span<const std::uint8_t> mask)
      : values_(values.begin(), values.end()),
        mask_(mask),
        nx_(grid.size[0]),
        ny_(grid.size[1]),
        mx_(smooth_size(nx_)),
        my_(smooth_size(ny_)),
        hann_x_(hann(nx_)),
        hann_y_(hann(ny_)) {}

  std::optional<Fringes> find() {
    std::size_t count = 0;
    for (int round = 0; round < rounds; ++round) {
      const std::vector<Wave> waves = peaks(most_waves - count);
      for (const Wave& wave : waves) remove(wave);
      count += waves.size();
      if (waves.empty() || count == most_waves) break;
    }
    if (count == 0) return std::nullopt;
    return Fringes{std::move(values_), static_cast<Index>(count)};
  }

 private:
  [[nodiscard]] bool inside(Index i) const { return mask_.empty() || mask_[i] != 0; }
  [[nodiscard]] double weight(Index x, Index y) const { return hann_x_[x] * hann_y_[y]; }

  [[nodiscard]] double mean() const {
    double sum = 0, weights = 0;
    for (Index y = 0; y < ny_; ++y)
      for (Index x = 0; x < nx_; ++x)
        if (inside(y * nx_ + x)) {
          sum += weight(x, y) * static_cast<double>(values_[y * nx_ + x]);
          weights += weight(x, y);
        }
    return sum / weights;
  }

  // Logarithms of the power of frequencies u along x, from 0 to half, and v along y.
  [[nodiscard]] std::vector<float> spectrum() const {
    const double level = mean();
    const Index half = mx_ / 2 + 1;
    std::vector<Complex> all(static_cast<std::size_t>(half * my_));
    Eigen::FFT<float> fft;
    std::vector<Complex> row(mx_), of_row, column(my_), of_column;
    for (Index y = 0; y < ny_; ++y) {
      std::fill(row.begin(), row.end(), Complex(0));
      for (Index x = 0; x < nx_; ++x)
        if (inside(y * nx_ + x))
          row[x] = static_cast<float>(weight(x, y) * (static_cast<double>(values_[y * nx_ + x]) - level));
      fft.fwd(of_row, row);
      std::copy_n(of_row.begin(), half, all.begin() + y * half);
    }
    std::vector<float> power(all.size());
    for (Index u = 0; u < half; ++u) {
      for (Index v = 0; v < my_; ++v) column[v] = all[v * half + u];
      fft.fwd(of_column, column);
      for (Index v = 0; v < my_; ++v) power[v * half + u] = std::log(std::norm(of_column[v]) + 1e-30F);
    }
    return power;
  }

  // The strongest first. The spectrum goes on beyond its ends.
  [[nodiscard]] std::vector<Wave> peaks(std::size_t most) const {
    const std::vector<float> power = spectrum();
    const Index half = mx_ / 2 + 1;
    const auto at = [&](Index u, Index v) {
      if (u < 0 || u > mx_ / 2) {
        u = ((mx_ - u) % mx_ + mx_) % mx_;
        v = -v;
        if (u >= half) u = mx_ - u, v = -v;
      }
      v = ((v % my_) + my_) % my_;
      return power[v * half + u];
    };
    const double least = fewest_waves / static_cast<double>(std::max(nx_, ny_));
    std::vector<Wave> found;
    std::vector<float> around;
    std::vector<float> sorted = power;
    const float typical = percentile(sorted, 0.5);
    for (Index v = 0; v < my_; ++v)
      for (Index u = 0; u < half; ++u) {
        const float here = at(u, v);
        if (here < typical + std::log(static_cast<float>(far_above))) continue;
        const double fx = static_cast<double>(u) / static_cast<double>(mx_);
        const double fy = static_cast<double>(v > my_ / 2 ? v - my_ : v) / static_cast<double>(my_);
        if (std::hypot(fx, fy) < least || ((u == 0 || 2 * u == mx_) && fy < 0)) continue;
        bool top = true;
        for (Index j = -2; j <= 2 && top; ++j)
          for (Index i = -2; i <= 2 && top; ++i) top = (i == 0 && j == 0) || at(u + i, v + j) <= here;
        if (!top) continue;
        around.clear();
        for (Index j = -reach; j <= reach; ++j)
          for (Index i = -reach; i <= reach; ++i)
            if (std::max(std::abs(i), std::abs(j)) > 3) around.push_back(at(u + i, v + j));
        if (here < percentile(around, 0.5) + std::log(static_cast<float>(far_above))) continue;
        // Rows or columns of any offsets have all frequencies along an axis.
        std::array<std::vector<float>, 2> along;
        for (Index i = 4; i <= 2 * reach; ++i)
          for (const Index k : {-i, i}) {
            along[0].push_back(at(u + k, v));
            along[1].push_back(at(u, v + k));
          }
        const float ridge = std::max(percentile(along[0], 0.5), percentile(along[1], 0.5));
        if (here < ridge + std::log(static_cast<float>(above_ridge))) continue;
        const double du = top_of(at(u - 1, v), here, at(u + 1, v)), dv = top_of(at(u, v - 1), here, at(u, v + 1));
        constexpr double turn = 2 * std::numbers::pi;
        found.push_back({turn * (fx + du / static_cast<double>(mx_)), turn * (fy + dv / static_cast<double>(my_)),
                         static_cast<double>(here)});
      }
    std::sort(found.begin(), found.end(), [](const Wave& a, const Wave& b) { return a.power > b.power; });
    if (found.size() > most) found.resize(most);
    return found;
  }

  // Of the parabola through three values.
  static double top_of(float before, float here, float after) {
    const double curvature = static_cast<double>(before) - 2 * static_cast<double>(here) + static_cast<double>(after);
    return curvature < 0 ? std::clamp(0.5 * static_cast<double>(before - after) / curvature, -0.5, 0.5) : 0;
  }

  // By least squares with the weights of the window.
  void remove(const Wave& wave) {
    std::vector<std::complex<double>> along(static_cast<std::size_t>(nx_));
    for (Index x = 0; x < nx_; ++x) along[x] = std::polar(1.0, wave.x * static_cast<double>(x));
    const double level = mean();
    double cc = 0, cs = 0, ss = 0, cv = 0, sv = 0;
    for (Index y = 0; y < ny_; ++y) {
      const std::complex<double> start = std::polar(1.0, wave.y * static_cast<double>(y));
      for (Index x = 0; x < nx_; ++x) {
        if (!inside(y * nx_ + x)) continue;
        const std::complex<double> here = start * along[x];
        const double w = weight(x, y), v = static_cast<double>(values_[y * nx_ + x]) - level;
        cc += w * here.real() * here.real();
        cs += w * here.real() * here.imag();
        ss += w * here.imag() * here.imag();
        cv += w * v * here.real();
        sv += w * v * here.imag();
      }
    }
    const double ridge = 1e-6 * (cc + ss), determinant = (cc + ridge) * (ss + ridge) - cs * cs;
    const double c = (cv * (ss + ridge) - sv * cs) / determinant, s = (sv * (cc + ridge) - cv * cs) / determinant;
    for (Index y = 0; y < ny_; ++y) {
      const std::complex<double> start = std::polar(1.0, wave.y * static_cast<double>(y));
      for (Index x = 0; x < nx_; ++x) {
        const std::complex<double> here = start * along[x];
        if (inside(y * nx_ + x)) values_[y * nx_ + x] -= static_cast<float>(c * here.real() + s * here.imag());
      }
    }
  }

  std::vector<float> values_;
  std::span<const std::uint8_t> mask_;
  Index nx_, ny_, mx_, my_;  // m: of the spectrum
  std::vector<double> hann_x_, hann_y_;
};

}  // namespace

std::optional<Fringes> find_fringes(std::span<const float> values, const Grid& grid,
                                    std::span<const std::uint8_t> mask) {
  if (grid.dimension() != 2 || std::min(grid.size[0], grid.size[1]) < least_side) return std::nullopt;
  return FringeFinder(values, grid, mask).find();
}

}  // namespace csrbf
