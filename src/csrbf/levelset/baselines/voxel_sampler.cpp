#include "csrbf/levelset/baselines/voxel_sampler.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/kernels/kernel.hpp"

#include <Eigen/Geometry>

#include <numbers>

namespace csrbf {
namespace {

// Entries that a row of VoxelSampler's matrix has on average.
template <int Dim>
double mean_entries(const RadialBasis<Dim>& basis, const Points<Dim>& voxels) {
  const double sigma = basis.support(0);
  const double ball = Dim == 2 ? std::numbers::pi * sigma * sigma : 4.0 / 3 * std::numbers::pi * std::pow(sigma, 3);
  const double share = ball / bounding_box<Dim>(voxels).extent().prod();
  return static_cast<double>(basis.size()) * std::min(1.0, share);
}

// Sparse matrix from rows of (column, weight).
template <class Scalar>
Eigen::SparseMatrix<Scalar, Eigen::RowMajor> from_rows(const std::vector<std::vector<std::pair<Index, double>>>& rows,
                                                       Index columns) {
  Eigen::SparseMatrix<Scalar, Eigen::RowMajor> matrix(std::ssize(rows), columns);
  matrix.reserve(std::accumulate(rows.begin(), rows.end(), Index{0},
                                 [](Index sum, const auto& row) { return sum + std::ssize(row); }));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    matrix.startVec(static_cast<Index>(i));
    for (const auto& [column, weight] : rows[i])
      matrix.insertBack(static_cast<Index>(i), column) = static_cast<Scalar>(weight);
  }
  matrix.finalize();
  return matrix;
}

// Calls body(voxel index, offset of the voxel from `at`) for the voxels of the box at -+ reach, in voxel coordinates.
template <int Dim, class Body>
void for_each_voxel(const Grid& grid, const Point<Dim>& at, const Point<Dim>& reach, const Body& body) {
  std::array<Index, Dim> lo, hi, k;
  for (Index a = 0; a < Dim; ++a) {
    lo[a] = std::max<Index>(0, static_cast<Index>(std::ceil(at[a] - reach[a])));
    hi[a] = std::min<Index>(grid.size[a] - 1, static_cast<Index>(std::floor(at[a] + reach[a])));
    if (lo[a] > hi[a]) return;
  }
  k = lo;
  for (;;) {
    Point<Dim> offset;
    Index index = 0;
    for (Index a = Dim; a-- > 0;) {
      offset[a] = static_cast<double>(k[a]) - at[a];
      index = index * grid.size[a] + k[a];
    }
    body(index, offset);
    Index a = 0;
    for (; a < Dim && ++k[a] > hi[a]; ++a) k[a] = lo[a];
    if (a == Dim) return;
  }
}

template <int Dim>
Point<Dim> clamped(const Grid& grid, Point<Dim> voxel) {
  for (Index a = 0; a < Dim; ++a) voxel[a] = std::clamp(voxel[a], 0.0, static_cast<double>(grid.size[a] - 1));
  return voxel;
}

}  // namespace

template <int Dim>
VoxelSampler<Dim>::VoxelSampler(const RadialBasis<Dim>& basis, Points<Dim> voxels) : voxels_(std::move(voxels)) {
  constexpr double most_entries = 3e7;  // of 12 bytes
  const double entries = static_cast<double>(voxels_.cols()) * mean_entries<Dim>(basis, voxels_);
  if (!basis.kernel().compact() || entries > most_entries) return;
  matrix_ = basis.matrix(voxels_);
  voxels_.resize(Dim, 0);
}

template <int Dim>
Index VoxelSampler<Dim>::labels(const NodeSystem<Dim>& system, const Eigen::VectorXd& mu, unsigned char* labels) const {
  constexpr Index grain = 1 << 13;  // voxels per task
  const bool sparse = matrix_.rows() > 0;
  const Index n = sparse ? matrix_.rows() : voxels_.cols();
  const Eigen::VectorXd value = sparse ? Eigen::VectorXd(n) : system.expansion(mu)->evaluate(voxels_).value;
  std::vector<Index> changed((n + grain - 1) / grain, 0);
  parallel_for(n, grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      double f = 0;
      if (sparse)
        for (typename decltype(matrix_)::InnerIterator it(matrix_, i); it; ++it) f += it.value() * mu[it.col()];
      else
        f = value[i];
      const unsigned char now = f > 0 ? 1 : 0;
      changed[begin / grain] += now != labels[i] ? 1 : 0;
      labels[i] = now;
    }
  });
  return std::accumulate(changed.begin(), changed.end(), Index{0});
}

template <int Dim>
Eigen::SparseMatrix<float, Eigen::RowMajor> velocity_weights(const Grid& grid, const Points<Dim>& points,
                                                             double radius) {
  const Kernel kernel("wendland-c2", Dim);
  const auto to_voxel = grid.to_voxel<Dim>();
  const Eigen::Matrix<double, Dim, Dim> linear = grid.to_physical<Dim>().linear();
  const Point<Dim> reach = radius * to_voxel.linear().rowwise().norm();
  std::vector<std::vector<std::pair<Index, double>>> rows(points.cols());
  parallel_for(points.cols(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      auto& row = rows[i];
      const Point<Dim> at = to_voxel * Point<Dim>(points.col(i));
      double sum = 0;
      for_each_voxel<Dim>(grid, at, reach, [&](Index voxel, const Point<Dim>& offset) {
        const double r = radius > 0 ? (linear * offset).norm() / radius : 1;
        if (r >= 1) return;
        row.emplace_back(voxel, kernel.value(r));
        sum += row.back().second;
      });
      for (auto& [voxel, weight] : row) weight /= sum;
      if (!row.empty()) continue;
      const Point<Dim> near = clamped<Dim>(grid, at);
      Index index = 0;
      for (Index a = Dim; a-- > 0;) index = index * grid.size[a] + std::lround(near[a]);
      row.emplace_back(index, 1.0);
    }
  });
  return from_rows<float>(rows, grid.voxels());
}

template <int Dim>
Eigen::SparseMatrix<double, Eigen::RowMajor> linear_weights(const Grid& grid, const Points<Dim>& points) {
  const auto to_voxel = grid.to_voxel<Dim>();
  std::vector<std::vector<std::pair<Index, double>>> rows(points.cols());
  parallel_for(points.cols(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      for_each_voxel<Dim>(grid, clamped<Dim>(grid, to_voxel * Point<Dim>(points.col(i))), Point<Dim>::Ones(),
                          [&](Index voxel, const Point<Dim>& offset) {
                            const double weight = (1 - offset.array().abs()).prod();
                            if (weight > 0) rows[i].emplace_back(voxel, weight);
                          });
  });
  return from_rows<double>(rows, grid.voxels());
}

#define CSRBF_INSTANTIATE(Dim)                                                                                         \
  template class VoxelSampler<Dim>;                                                                                    \
  template Eigen::SparseMatrix<float, Eigen::RowMajor> velocity_weights<Dim>(const Grid&, const Points<Dim>&, double); \
  template Eigen::SparseMatrix<double, Eigen::RowMajor> linear_weights<Dim>(const Grid&, const Points<Dim>&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
