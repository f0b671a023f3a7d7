#include "csrbf/levelset/partition/region_moments.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/simd.hpp"
#include "csrbf/linalg/decompositions.hpp"

namespace csrbf {
namespace {

constexpr int lanes = 8;

double coordinate(Index i, Index n) {
  return n > 1 ? 2 * static_cast<double>(i) / static_cast<double>(n - 1) - 1 : 0;
}

// Sums of x^0 to x^4, of v x^0 to v x^2 and of v^2 over the voxels of a row with that label.
struct RowSums {
  double powers[5] = {}, values[3] = {}, squares = 0, count = 0;
};

CSRBF_ALWAYS_INLINE void sum_row(const float* values, const float* weights, const std::uint8_t* labels,
                                 std::uint8_t label, const double* xs, Index n, RowSums& to) {
  double sums[10][lanes] = {};
  float last_values[lanes] = {}, last_weights[lanes] = {}, ones[lanes];
  std::fill_n(ones, lanes, 1.0F);
  std::uint8_t last_labels[lanes];
  double last_xs[lanes] = {};
  for (Index i = 0; i < n; i += lanes) {
    const float* f = values + i;
    const std::uint8_t* k = labels + i;
    const double* x = xs + i;
    const float* w = weights != nullptr ? weights + i : ones;
    if (i + lanes > n) {
      for (Index l = 0; l < lanes; ++l) last_labels[l] = static_cast<std::uint8_t>(label + 1);
      std::copy(f, values + n, last_values);
      std::copy(k, labels + n, last_labels);
      std::copy(x, xs + n, last_xs);
      if (weights != nullptr) {
        std::copy(w, weights + n, last_weights);
        w = last_weights;
      }
      f = last_values;
      k = last_labels;
      x = last_xs;
    }
    for (Index l = 0; l < lanes; ++l) {
      const double here = k[l] == label ? 1.0 : 0.0, in = here * static_cast<double>(w[l]),
                   v = static_cast<double>(f[l]);
      const double x1 = in * x[l], x2 = x1 * x[l], x3 = x2 * x[l];
      const double f0 = in * v, f1 = f0 * x[l];
      sums[0][l] += in;
      sums[1][l] += x1;
      sums[2][l] += x2;
      sums[3][l] += x3;
      sums[4][l] += x3 * x[l];
      sums[5][l] += f0;
      sums[6][l] += f1;
      sums[7][l] += f1 * x[l];
      sums[8][l] += f0 * v;
      sums[9][l] += here;
    }
  }
  const auto total = [&](int k) {
    double sum = 0;
    for (const double part : sums[k]) sum += part;
    return sum;
  };
  for (int a = 0; a < 5; ++a) to.powers[a] = total(a);
  for (int a = 0; a < 3; ++a) to.values[a] = total(5 + a);
  to.squares = total(8);
  to.count = total(9);
}

void add_row(const RowSums& row, double y, double z, RegionMoments& to) {
  double of_y = 1;
  for (int b = 0; b < 5; ++b, of_y *= y) {
    double of_yz = of_y;
    for (int c = 0; b + c < 5; ++c, of_yz *= z) {
      for (int a = 0; a + b + c < 5; ++a) to.powers[a][b][c] += row.powers[a] * of_yz;
      for (int a = 0; a + b + c < 3; ++a) to.values[a][b][c] += row.values[a] * of_yz;
    }
  }
  to.squares += row.squares;
  to.voxels += row.count;
}

}  // namespace

void RegionMoments::add(const RegionMoments& other, double times) {
  for (int a = 0; a < 5; ++a)
    for (int b = 0; a + b < 5; ++b)
      for (int c = 0; a + b + c < 5; ++c) {
        powers[a][b][c] += times * other.powers[a][b][c];
        if (a + b + c < 3) values[a][b][c] += times * other.values[a][b][c];
      }
  squares += times * other.squares;
  voxels += times * other.voxels;
}

RegionMoments region_moments(std::span<const float> values, std::span<const std::uint8_t> labels, std::uint8_t label,
                             const Grid& grid, std::span<const float> weights) {
  const Index nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  std::vector<double> xs;
  for (Index x = 0; x < nx; ++x) xs.push_back(coordinate(x, nx));
  const Index rows = ny * nz, grain = std::max<Index>(1, (1 << 14) / nx), tasks = (rows + grain - 1) / grain;
  std::vector<RegionMoments> parts(tasks);
  parallel_for(rows, grain, [&](Index begin, Index end) {
    for (Index row = begin; row < end; ++row) {
      RowSums sums;
      simd<sum_row>(values.data() + row * nx, weights.empty() ? nullptr : weights.data() + row * nx,
                    labels.data() + row * nx, label, xs.data(), nx, sums);
      if (sums.count > 0) add_row(sums, coordinate(row % ny, ny), coordinate(row / ny, nz), parts[begin / grain]);
    }
  });
  for (Index task = 1; task < tasks; ++task) parts[0].add(parts[task]);
  return parts[0];
}

MeanPolynomial::MeanPolynomial(const RegionMoments& region, int degree, const Grid& grid) : grid_(grid) {
  for (int total = 0; total <= degree; ++total)
    for (int a = total; a >= 0; --a)
      for (int b = total - a; b >= 0; --b) {
        const std::array<int, 3> e{a, b, total - a - b};
        if ((e[1] == 0 || grid.size[1] > 1) && (e[2] == 0 || grid.size[2] > 1)) exponents_.push_back(e);
      }
  const Index n = std::ssize(exponents_);
  Eigen::MatrixXd left(n, n);
  Eigen::VectorXd right(n);
  const double mean = region.mean();
  for (Index i = 0; i < n; ++i) {
    const std::array<int, 3>& p = exponents_[i];
    for (Index j = 0; j < n; ++j) {
      const std::array<int, 3>& q = exponents_[j];
      left(i, j) = region.powers[p[0] + q[0]][p[1] + q[1]][p[2] + q[2]];
    }
    right[i] = region.values[p[0]][p[1]][p[2]] - mean * left(i, 0);
  }
  constexpr double ridge = 1e-6;  // of the voxels, for regions within a row
  left.diagonal().array() += ridge * (left(0, 0) + 1);
  const Eigen::VectorXd c = solve(Eigen::LDLT<Eigen::MatrixXd>(left), right);
  c_.assign(c.begin(), c.end());
  c_[0] += mean;
}

double MeanPolynomial::residual(const RegionMoments& region) const {
  double sum = region.squares;
  for (std::size_t i = 0; i < c_.size(); ++i) {
    const std::array<int, 3>& p = exponents_[i];
    sum -= 2 * c_[i] * region.values[p[0]][p[1]][p[2]];
    for (std::size_t j = 0; j < c_.size(); ++j) {
      const std::array<int, 3>& q = exponents_[j];
      sum += c_[i] * c_[j] * region.powers[p[0] + q[0]][p[1] + q[1]][p[2] + q[2]];
    }
  }
  return std::max(0.0, sum);
}

void MeanPolynomial::fill_row(Index row, std::span<float> to) const {
  const auto [nx, ny, nz] = grid_.size;
  const double y = coordinate(row % ny, ny), z = coordinate(row / ny, nz);
  std::array<double, 3> in_x{0, 0, 0};
  for (std::size_t i = 0; i < c_.size(); ++i) {
    const std::array<int, 3>& e = exponents_[i];
    in_x[static_cast<std::size_t>(e[0])] += c_[i] * std::pow(y, e[1]) * std::pow(z, e[2]);
  }
  for (Index i = 0; i < nx; ++i) {
    const double x = coordinate(i, nx);
    to[i] = static_cast<float>(in_x[0] + x * (in_x[1] + x * in_x[2]));
  }
}

}  // namespace csrbf
