#include "csrbf/linalg/toeplitz_system.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/parallel_sum.hpp"
#include "csrbf/core/simd.hpp"

#include <complex>
#include <numeric>
#include <string>
#include <unsupported/Eigen/FFT>

namespace csrbf {
namespace {

using Complex = std::complex<double>;

constexpr Index chunk = 1 << 15;       // numbers per task, chosen by hand: fewer are not worth a thread
constexpr Index chunk_taps = 1 << 18;  // multiplications per task, likewise

CSRBF_ALWAYS_INLINE
void add_run(const double* x, const double* weights, Index count, Index n, double* y) {
  Index k = 0;
  for (; k + 4 <= count; k += 4)
    for (Index i = 0; i < n; ++i)
      y[i] += weights[k] * x[i + k] + weights[k + 1] * x[i + k + 1] + weights[k + 2] * x[i + k + 2] +
              weights[k + 3] * x[i + k + 3];
  for (; k < count; ++k)
    for (Index i = 0; i < n; ++i) y[i] += weights[k] * x[i + k];
}

// Sum of what body(begin, size) returns for all chunks of n numbers.
template <class Body>
double sum_over(Index n, const Body& body) {
  return parallel_sum(n, chunk, [&](Index begin, Index end) { return body(begin, end - begin); });
}

double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return sum_over(a.size(), [&](Index first, Index n) { return a.segment(first, n).dot(b.segment(first, n)); });
}

// The next multiple of `unit` without prime factors above 5, for which the transform is fast.
Index smooth_size(Index n, Index unit) {
  for (n = (n + unit - 1) / unit;; ++n) {
    Index m = n;
    for (const Index p : {2, 3, 5})
      while (m % p == 0) m /= p;
    if (m == 1) return unit * n;
  }
}

template <int Dim>
Index product(const std::array<Index, Dim>& size) {
  return std::accumulate(size.begin(), size.end(), Index{1}, std::multiplies<>());
}

// Fourier transform along all axes but the first, in place.
template <int Dim>
void transform(const std::array<Index, Dim>& size, bool inverse, std::vector<Complex>& data) {
  Index stride = size[0];
  for (std::size_t a = 1; a < Dim; stride *= size[a], ++a) {
    const Index n = size[a], lines = std::ssize(data) / n;
    parallel_for(lines, std::max<Index>(1, chunk / n), [&](Index begin, Index end) {
      Eigen::FFT<double> fft;
      std::vector<Complex> in(n), out(static_cast<std::size_t>(n));
      for (Index line = begin; line < end; ++line) {
        Complex* first = data.data() + line % stride + line / stride * stride * n;
        for (Index i = 0; i < n; ++i) in[i] = first[i * stride];
        if (inverse)
          fft.inv(out.data(), in.data(), n);
        else
          fft.fwd(out.data(), in.data(), n);
        for (Index i = 0; i < n; ++i) first[i * stride] = out[i];
      }
    });
  }
}

// The index on the torus of row `row` of a lattice.
template <int Dim>
Index torus_row(const std::array<Index, Dim>& size, const std::array<Index, Dim>& torus, Index row) {
  Index at = 0, stride = 1;
  for (std::size_t a = 1; a < Dim; ++a) {
    at += row % size[a] * stride;
    row /= size[a];
    stride *= torus[a];
  }
  return at;
}

// The spectrum (half of it along x, as values are real) of values on a lattice, continued by 0 to a torus.
template <int Dim>
std::vector<Complex> spectrum(const std::array<Index, Dim>& size, const std::array<Index, Dim>& torus,
                              const double* values) {
  std::array<Index, Dim> half = torus;
  half[0] = torus[0] / 2 + 1;
  std::vector<Complex> data(product<Dim>(half), 0.0);
  const Index n = size[0], rows = product<Dim>(size) / n;
  parallel_for(rows, std::max<Index>(1, chunk / torus[0]), [&](Index begin, Index end) {
    Eigen::FFT<double> fft;
    fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
    std::vector<double> line(torus[0], 0.0);
    for (Index row = begin; row < end; ++row) {
      std::copy_n(values + row * n, n, line.data());
      fft.fwd(data.data() + torus_row<Dim>(size, torus, row) * half[0], line.data(), torus[0]);
    }
  });
  transform<Dim>(half, false, data);
  return data;
}

// The values on the lattice from a spectrum. Overwrites `data`.
template <int Dim>
void from_spectrum(const std::array<Index, Dim>& size, const std::array<Index, Dim>& torus, std::vector<Complex>& data,
                   double* values) {
  std::array<Index, Dim> half = torus;
  half[0] = torus[0] / 2 + 1;
  transform<Dim>(half, true, data);
  const Index n = size[0], rows = product<Dim>(size) / n;
  parallel_for(rows, std::max<Index>(1, chunk / torus[0]), [&](Index begin, Index end) {
    Eigen::FFT<double> fft;
    fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
    std::vector<double> line(torus[0]);
    for (Index row = begin; row < end; ++row) {
      fft.inv(line.data(), data.data() + torus_row<Dim>(size, torus, row) * half[0], torus[0]);
      std::copy_n(line.data(), n, values + row * n);
    }
  });
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
  taps_ = std::ssize(taps);
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
  constexpr double rounding = 1e-15;  // of the transform, relative: smaller values may be negative
  for (std::size_t a = 0; a < Dim; ++a) torus_[a] = smooth_size(size_[a] + reach_[a], a == 0 ? 4 : 1);
  std::vector<double> circulant(product<Dim>(torus_), 0.0);
  for (const ToeplitzTap<Dim>& tap : taps) {
    Index at = 0;
    for (std::size_t a = Dim; a-- > 0;) at = at * torus_[a] + (tap.offset[a] % torus_[a] + torus_[a]) % torus_[a];
    circulant[at] += tap.weight;
  }
  const std::vector<Complex> symbol = spectrum<Dim>(torus_, torus_, circulant.data());
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
  const Index n = size_[0], pad = reach_[0], rows = points_ / n;
  std::vector<double> padded(rows * (n + 2 * pad), 0.0);
  for (Index row = 0; row < rows; ++row) std::copy_n(x.data() + row * n, n, padded.data() + row * (n + 2 * pad) + pad);
  Eigen::VectorXd y(points_);
  multiply_padded(padded, y);
  return y;
}

// `padded`: rows with as many zeros at both ends as the taps reach.
template <int Dim>
void ToeplitzSystem<Dim>::multiply_padded(const std::vector<double>& padded, Eigen::VectorXd& y) const {
  const Index n = size_[0], pad = reach_[0], length = n + 2 * pad, rows = points_ / n;
  parallel_for(rows, std::max<Index>(1, chunk_taps / (n * taps_)), [&](Index begin, Index end) {
    y.segment(begin * n, (end - begin) * n).setZero();
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
          simd<add_run>(padded.data() + from * length + pad + run.offset[0], run.weights.data(),
                        std::ssize(run.weights), n, y.data() + row * n);
      }
  });
}

template <int Dim>
void ToeplitzSystem<Dim>::precondition(const Eigen::VectorXd& r, Eigen::VectorXd& z) const {
  if (inverse_symbol_.empty()) {
    z = r;
    return;
  }
  std::vector<Complex> data = spectrum<Dim>(size_, torus_, r.data());
  parallel_for(std::ssize(data), chunk, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) data[i] *= inverse_symbol_[i];
  });
  from_spectrum<Dim>(size_, torus_, data, z.data());
}

// Hestenes and Stiefel 1952. The direction is kept in padded rows, as multiply_padded() needs it.
template <int Dim>
Eigen::VectorXd ToeplitzSystem<Dim>::solve(const Eigen::VectorXd& b) const {
  require(b.size() == points_, "ToeplitzSystem::solve", "size of b", b.size(), "must be the number of points");
  const Index n = size_[0], pad = reach_[0], length = n + 2 * pad, rows = points_ / n;
  const Index grain = std::max<Index>(1, chunk / n);
  std::vector<double> padded(rows * length, 0.0);
  const auto direction = [&](Index row) { return Eigen::Map<Eigen::VectorXd>(padded.data() + row * length + pad, n); };
  Eigen::VectorXd x = Eigen::VectorXd::Zero(points_), residual = b, z(points_), image(points_);
  std::vector<double> sums((rows + grain - 1) / grain);
  // The sum of body(row) over all rows.
  const auto for_rows = [&](const auto& body) {
    parallel_for(rows, grain, [&](Index begin, Index end) {
      double sum = 0;
      for (Index row = begin; row < end; ++row) sum += body(row);
      sums[begin / grain] = sum;
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
  };
  const double bb = dot(b, b), goal = options_.tolerance * options_.tolerance * bb;
  double rr = bb, rz = 0;
  Index iteration = 0;
  while (rr > goal && iteration < options_.max_iterations) {
    precondition(residual, z);
    const double next = inverse_symbol_.empty() ? rr : dot(residual, z);
    const double beta = iteration > 0 ? next / rz : 0;
    rz = next;
    for_rows([&](Index row) {
      direction(row) = z.segment(row * n, n) + beta * direction(row);
      return 0.0;
    });
    multiply_padded(padded, image);
    const double curvature = for_rows([&](Index row) { return direction(row).dot(image.segment(row * n, n)); });
    if (!(curvature > 0)) break;
    ++iteration;
    const double step = rz / curvature;
    rr = for_rows([&](Index row) {
      x.segment(row * n, n) += step * direction(row);
      residual.segment(row * n, n) -= step * image.segment(row * n, n);
      return residual.segment(row * n, n).squaredNorm();
    });
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
