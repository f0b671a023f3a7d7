#include "csrbf/linalg/toeplitz_system.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/simd.hpp"

#include <algorithm>
#include <complex>
#include <numeric>
#include <string>
#include <unsupported/Eigen/FFT>

namespace csrbf {
namespace {

using Complex = std::complex<double>;

constexpr Index chunk = 1 << 13;  // numbers that are worth a thread

CSRBF_SIMD_CLONES
void add_run(const double* x, const double* weights, Index count, Index n, double* y) {
  for (Index k = 0; k < count; ++k)
    for (Index i = 0; i < n; ++i) y[i] += weights[k] * x[i + k];
}

double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  std::vector<double> sums(static_cast<std::size_t>((a.size() + chunk - 1) / chunk), 0.0);
  parallel_for(a.size(), chunk, [&](Index begin, Index end) {
    sums[static_cast<std::size_t>(begin / chunk)] = a.segment(begin, end - begin).dot(b.segment(begin, end - begin));
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

// a += t b
void add(double t, const Eigen::VectorXd& b, Eigen::VectorXd& a) {
  parallel_for(a.size(), chunk,
               [&](Index begin, Index end) { a.segment(begin, end - begin) += t * b.segment(begin, end - begin); });
}

// The next number without prime factors above 5, which the transform takes fast.
Index smooth_size(Index n) {
  for (;; ++n) {
    Index m = n;
    for (const Index p : {2, 3, 5})
      while (m % p == 0) m /= p;
    if (m == 1) return n;
  }
}

template <int Dim>
Index product(const std::array<Index, Dim>& size) {
  return std::accumulate(size.begin(), size.end(), Index{1}, std::multiplies<>());
}

// Fourier transform along all axes, in place.
template <int Dim>
void transform(const std::array<Index, Dim>& size, bool inverse, std::vector<Complex>& data) {
  Index stride = 1;
  for (std::size_t a = 0; a < Dim; stride *= size[a], ++a) {
    const Index n = size[a], lines = static_cast<Index>(data.size()) / n;
    parallel_for(lines, std::max<Index>(1, chunk / n), [&](Index begin, Index end) {
      Eigen::FFT<double> fft;
      std::vector<Complex> in(static_cast<std::size_t>(n)), out(static_cast<std::size_t>(n));
      for (Index line = begin; line < end; ++line) {
        Complex* first = data.data() + line % stride + line / stride * stride * n;
        for (Index i = 0; i < n; ++i) in[static_cast<std::size_t>(i)] = first[i * stride];
        if (inverse)
          fft.inv(out.data(), in.data(), n);
        else
          fft.fwd(out.data(), in.data(), n);
        for (Index i = 0; i < n; ++i) first[i * stride] = out[static_cast<std::size_t>(i)];
      }
    });
  }
}

// Calls body(row of the lattice, first entry of its copy on the torus).
template <int Dim, class Body>
void for_each_row(const std::array<Index, Dim>& size, const std::array<Index, Dim>& torus, const Body& body) {
  const Index rows = product<Dim>(size) / size[0];
  for (Index row = 0; row < rows; ++row) {
    Index rest = row, at = 0, stride = torus[0];
    for (std::size_t a = 1; a < Dim; ++a) {
      at += rest % size[a] * stride;
      rest /= size[a];
      stride *= torus[a];
    }
    body(row, at);
  }
}

}  // namespace

template <int Dim>
ToeplitzSystem<Dim>::ToeplitzSystem(const std::array<Index, Dim>& size, const std::vector<ToeplitzTap<Dim>>& taps,
                                    const ToeplitzOptions& options)
    : size_(size), points_(product<Dim>(size)), options_(options) {
  for (const Index n : size) require(n > 0, "ToeplitzSystem", "size", n, "must be positive");
  require(!taps.empty(), "ToeplitzSystem", "number of taps", taps.size(), "must be positive");
  for (const ToeplitzTap<Dim>& tap : taps)
    for (std::size_t a = 0; a < Dim; ++a) reach_[a] = std::max(reach_[a], std::abs(tap.offset[a]));
  make_runs(taps);
  make_symbol(taps);
}

template <int Dim>
void ToeplitzSystem<Dim>::make_runs(std::vector<ToeplitzTap<Dim>> taps) {
  std::sort(taps.begin(), taps.end(), [](const ToeplitzTap<Dim>& a, const ToeplitzTap<Dim>& b) {
    return std::lexicographical_compare(a.offset.rbegin(), a.offset.rend(), b.offset.rbegin(), b.offset.rend());
  });
  std::array<Index, Dim> next{};
  for (const ToeplitzTap<Dim>& tap : taps) {
    if (runs_.empty() || tap.offset != next) runs_.push_back({tap.offset, {}});
    runs_.back().weights.push_back(tap.weight);
    next = tap.offset;
    ++next[0];
  }
}

template <int Dim>
void ToeplitzSystem<Dim>::make_symbol(const std::vector<ToeplitzTap<Dim>>& taps) {
  constexpr double rounding = 1e-15;  // of the transform: smaller values may be negative
  for (std::size_t a = 0; a < Dim; ++a) torus_[a] = smooth_size(size_[a] + reach_[a]);
  std::vector<Complex> symbol(static_cast<std::size_t>(product<Dim>(torus_)), 0.0);
  for (const ToeplitzTap<Dim>& tap : taps) {
    Index at = 0;
    for (std::size_t a = Dim; a-- > 0;) at = at * torus_[a] + (tap.offset[a] % torus_[a] + torus_[a]) % torus_[a];
    symbol[static_cast<std::size_t>(at)] += tap.weight;
  }
  transform<Dim>(torus_, false, symbol);
  double largest = 0, smallest = std::numeric_limits<double>::infinity();
  for (const Complex& value : symbol) largest = std::max(largest, value.real());
  for (const Complex& value : symbol) smallest = std::min(smallest, std::max(value.real(), rounding * largest));
  condition_ = largest / smallest;
  if (condition_ < options_.precondition_from) return;
  inverse_symbol_.resize(symbol.size());
  std::transform(symbol.begin(), symbol.end(), inverse_symbol_.begin(),
                 [&](const Complex& value) { return 1 / std::max(value.real(), rounding * largest); });
}

template <int Dim>
Eigen::VectorXd ToeplitzSystem<Dim>::multiply(const Eigen::VectorXd& x) const {
  const Index n = size_[0], pad = reach_[0], length = n + 2 * pad, rows = points_ / n;
  std::vector<double> padded(static_cast<std::size_t>(rows * length), 0.0);
  for (Index row = 0; row < rows; ++row) std::copy_n(x.data() + row * n, n, padded.data() + row * length + pad);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(points_);
  parallel_for(rows, std::max<Index>(1, chunk / n), [&](Index begin, Index end) {
    for (Index row = begin; row < end; ++row)
      for (const Run& run : runs_) {
        Index rest = row, from = 0, stride = 1;
        bool inside = true;
        for (std::size_t a = 1; a < Dim && inside; ++a) {
          const Index at = rest % size_[a] + run.offset[a];
          inside = at >= 0 && at < size_[a];
          from += at * stride;
          rest /= size_[a];
          stride *= size_[a];
        }
        if (inside)
          add_run(padded.data() + from * length + pad + run.offset[0], run.weights.data(),
                  static_cast<Index>(run.weights.size()), n, y.data() + row * n);
      }
  });
  return y;
}

template <int Dim>
Eigen::VectorXd ToeplitzSystem<Dim>::precondition(const Eigen::VectorXd& r) const {
  if (inverse_symbol_.empty()) return r;
  std::vector<Complex> data(inverse_symbol_.size(), 0.0);
  for_each_row<Dim>(size_, torus_,
                    [&](Index row, Index at) { std::copy_n(r.data() + row * size_[0], size_[0], data.data() + at); });
  transform<Dim>(torus_, false, data);
  parallel_for(static_cast<Index>(data.size()), chunk, [&](Index begin, Index end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      data[i] *= inverse_symbol_[i];
  });
  transform<Dim>(torus_, true, data);
  Eigen::VectorXd z(points_);
  for_each_row<Dim>(size_, torus_, [&](Index row, Index at) {
    for (Index i = 0; i < size_[0]; ++i) z[row * size_[0] + i] = data[static_cast<std::size_t>(at + i)].real();
  });
  return z;
}

// Hestenes and Stiefel 1952.
template <int Dim>
Eigen::VectorXd ToeplitzSystem<Dim>::solve(const Eigen::VectorXd& b) const {
  require(b.size() == points_, "ToeplitzSystem::solve", "size of b", b.size(), "must be the number of points");
  Eigen::VectorXd x = Eigen::VectorXd::Zero(points_), residual = b;
  const double bb = dot(b, b);
  const double goal = options_.tolerance * options_.tolerance * bb;
  double rr = bb;
  Eigen::VectorXd direction = precondition(residual);
  double rz = dot(residual, direction);
  Index iteration = 0;
  while (rr > goal && iteration < options_.max_iterations) {
    const Eigen::VectorXd image = multiply(direction);
    const double curvature = dot(direction, image);
    if (!(curvature > 0)) break;
    ++iteration;
    add(rz / curvature, direction, x);
    add(-rz / curvature, image, residual);
    rr = dot(residual, residual);
    Eigen::VectorXd z = precondition(residual);
    const double next = dot(residual, z);
    add(next / rz, direction, z);
    direction.swap(z);
    rz = next;
  }
  iterations_ += iteration;
  if (!(rr <= options_.tolerance * bb))
    throw SolverFailure("ToeplitzSystem: no convergence after " + std::to_string(iteration) +
                        " iterations; use smaller supports");
  return x;
}

template class ToeplitzSystem<1>;
template class ToeplitzSystem<2>;
template class ToeplitzSystem<3>;

}  // namespace csrbf
