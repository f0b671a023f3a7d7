#include "csrbf/approx/images/grid_spline.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/SparseCholesky>

namespace csrbf {
namespace {

constexpr double bending = 1e-10;  // of the first differences, at least: planes are held where nothing else does

// The difference of a few voxels, whose square is paid for.
struct Difference {
  std::array<Index, 4> voxels;
  std::array<double, 4> factors;
  int count;
};

class System {
 public:
  System(const Grid& grid, std::span<const std::uint8_t> unknown, const Eigen::Ref<Eigen::MatrixXd>& values)
      : grid_(grid), number_(unknown.size(), -1), values_(values) {
    for (std::size_t i = 0; i < unknown.size(); ++i)
      if (unknown[i] != 0) number_[i] = unknowns_++;
    right_ = Eigen::MatrixXd::Zero(unknowns_, values.cols());
  }

  // All differences that an unknown voxel takes part in.
  void add(double tension) {
    double shortest = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a)
      if (grid_.size[a] > 1) shortest = std::min(shortest, grid_.spacing[a]);
    const std::array<Index, 3> stride{1, grid_.size[0], grid_.size[0] * grid_.size[1]};
    std::array<double, 3> along{};
    for (std::size_t a = 0; a < 3; ++a) along[a] = shortest / grid_.spacing[static_cast<Index>(a)];
    for (Index i = 0; i < std::ssize(number_); ++i) {
      const auto after = [&](std::size_t a) { return i / stride[a] % grid_.size[a] + 1 < grid_.size[a]; };
      const auto before = [&](std::size_t a) { return i / stride[a] % grid_.size[a] > 0; };
      for (std::size_t a = 0; a < 3; ++a) {
        if (!after(a)) continue;
        const Index next = i + stride[a];
        const double first = std::sqrt(std::max(tension, bending)) * along[a];
        add(Difference{{i, next}, {-first, first}, 2});
        const double second = along[a] * along[a];
        if (before(a)) add(Difference{{i - stride[a], i, next}, {second, -2 * second, second}, 3});
        for (std::size_t b = a + 1; b < 3; ++b) {
          if (!after(b)) continue;
          const double mixed = std::sqrt(2.0) * along[a] * along[b];
          add(Difference{{i, next, i + stride[b], next + stride[b]}, {mixed, -mixed, -mixed, mixed}, 4});
        }
      }
    }
  }

  Eigen::MatrixXd solve() {
    Eigen::SparseMatrix<double> left(unknowns_, unknowns_);
    left.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(left);
    if (factor.info() != Eigen::Success)
      throw SolverFailure("fill_by_grid_spline: the system of " + std::to_string(unknowns_) +
                          " unknown voxels cannot be factorised");
    return factor.solve(right_);
  }

  [[nodiscard]] Index number(std::size_t voxel) const { return number_[voxel]; }

 private:
  void add(const Difference& d) {
    for (int i = 0; i < d.count; ++i) {
      const Index row = number_[d.voxels[i]];
      if (row < 0) continue;
      for (int j = 0; j < d.count; ++j) {
        const Index column = number_[d.voxels[j]];
        const double product = d.factors[i] * d.factors[j];
        if (column >= 0)
          entries_.emplace_back(row, column, product);
        else
          right_.row(row) -= product * values_.row(d.voxels[j]);
      }
    }
  }

  const Grid& grid_;
  std::vector<Index> number_;  // of the unknown voxels; -1: known
  const Eigen::Ref<Eigen::MatrixXd>& values_;
  Index unknowns_ = 0;
  std::vector<Eigen::Triplet<double, Index>> entries_;
  Eigen::MatrixXd right_;
};

}  // namespace

void fill_by_grid_spline(const Grid& grid, std::span<const std::uint8_t> unknown, double tension,
                         Eigen::Ref<Eigen::MatrixXd> values) {
  System system(grid, unknown, values);
  system.add(tension);
  const Eigen::MatrixXd found = system.solve();
  for (std::size_t i = 0; i < unknown.size(); ++i)
    if (system.number(i) >= 0) values.row(static_cast<Index>(i)) = found.row(system.number(i));
}

}  // namespace csrbf
