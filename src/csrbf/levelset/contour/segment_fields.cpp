#include "csrbf/levelset/contour/segment_fields.hpp"

#include "csrbf/levelset/lattice/lattice_field.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

// Sum over the voxels within an edge of the contour of 1, or of |grad f|.
template <int Dim>
double sum_at_contour(const Lattice<Dim>& lattice, const std::vector<float>& coefficients, bool slopes) {
  const auto edge = static_cast<float>(lattice.spacing().template head<Dim>().minCoeff());
  return lattice.sweep(
      coefficients.data(), true,
      [&](const LatticeRow& row) {
        double sum = 0;
        for (Index i = 0; i < row.count; ++i) {
          float squares = 0;
          for (std::size_t a = 0; a < Dim; ++a) squares += row.gradient[a][i] * row.gradient[a][i];
          if (squares > 0 && row.value[i] * row.value[i] < edge * edge * squares)
            sum += slopes ? std::sqrt(static_cast<double>(squares)) : 1.0;
        }
        return sum;
      },
      nullptr);
}

}  // namespace

template <int Dim>
void LargestField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const Derivatives derivatives = out.derivatives();
  fields_[k_]->evaluate_block(x, out);
  Jet<Dim> most(x.cols(), derivatives), other(x.cols(), derivatives);
  bool first = true;
  for (std::size_t l = 0; l < fields_.size(); ++l) {
    if (l == k_) continue;
    fields_[l]->evaluate_block(x, {other.value.data(), other.gradient.data(), other.hessian.data()});
    for (Index i = 0; i < x.cols(); ++i) {
      if (!first && other.value[i] <= most.value[i]) continue;
      most.value[i] = other.value[i];
      if (derivatives >= Derivatives::gradient) most.gradient.col(i) = other.gradient.col(i);
      if (derivatives >= Derivatives::hessian) most.hessian.col(i) = other.hessian.col(i);
    }
    first = false;
  }
  const Index n = x.cols();
  Eigen::Map<Eigen::VectorXd>(out.value, n) -= most.value;
  if (derivatives >= Derivatives::gradient) Eigen::Map<Eigen::MatrixXd>(out.gradient, Dim, n) -= most.gradient;
  if (derivatives >= Derivatives::hessian)
    Eigen::Map<Eigen::MatrixXd>(out.hessian, symmetric_size<Dim>, n) -= most.hessian;
}

template <int Dim>
double contour_slope(const Lattice<Dim>& lattice, const std::vector<float>& coefficients) {
  const double voxels = sum_at_contour(lattice, coefficients, false);
  return voxels > 0 ? sum_at_contour(lattice, coefficients, true) / voxels : 0;
}

template <int Dim>
std::shared_ptr<const Field<Dim>> lattice_field(const Lattice<Dim>& lattice, const std::vector<float>& coefficients,
                                                const Grid& grid, double slope) {
  typename LatticeField<Dim>::Data data;
  data.kernel = lattice.kernel().name();
  data.support = lattice.support();
  const Point<Dim> first = lattice.first_node(), step = lattice.node_step();
  Eigen::Transform<double, Dim, Eigen::Affine> nodes = Eigen::Transform<double, Dim, Eigen::Affine>::Identity();
  nodes.linear() = step.cwiseInverse().asDiagonal();
  nodes.translation() = -first.cwiseQuotient(step);
  data.to_lattice = nodes * grid.template to_voxel<Dim>();
  data.step = step.cwiseProduct(grid.spacing.template head<Dim>()).cwiseProduct(lattice.stretch().template head<Dim>());
  std::array<Index, 3> size{1, 1, 1};
  for (int a = 0; a < Dim; ++a) size[a] = lattice.nodes(a);
  std::copy_n(size.begin(), Dim, data.size.begin());

  const double factor = lattice.scale() / slope;
  data.coefficients.reserve(lattice.nodes());
  std::array<Index, 3> k{};
  for (k[2] = 0; k[2] < size[2]; ++k[2])
    for (k[1] = 0; k[1] < size[1]; ++k[1])
      for (k[0] = 0; k[0] < size[0]; ++k[0])
        data.coefficients.push_back(factor * static_cast<double>(coefficients[lattice.coefficient(k)]));
  data.bounds = image_box<Dim>(grid);
  return std::make_shared<LatticeField<Dim>>(std::move(data));
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> level_set_fields(const Lattice<Dim>& lattice,
                                                                const std::vector<std::vector<float>>& coefficients,
                                                                const Grid& grid) {
  std::vector<std::shared_ptr<const Field<Dim>>> single, fields;
  // One factor for all, so that the largest stays the largest.
  double slope = 0;
  for (const std::vector<float>& values : coefficients)
    slope += contour_slope(lattice, values) / static_cast<double>(coefficients.size());
  for (const std::vector<float>& values : coefficients)
    single.push_back(lattice_field(lattice, values, grid, slope > 0 ? slope : 1));
  if (single.size() == 1) return single;
  for (std::size_t k = 0; k < single.size(); ++k) fields.push_back(std::make_shared<LargestField<Dim>>(single, k));
  return fields;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                  \
  template class LargestField<Dim>;                                                                             \
  template std::vector<std::shared_ptr<const Field<Dim>>> level_set_fields<Dim>(                                \
      const Lattice<Dim>&, const std::vector<std::vector<float>>&, const Grid&);                                \
  template double contour_slope<Dim>(const Lattice<Dim>&, const std::vector<float>&);                           \
  template std::shared_ptr<const Field<Dim>> lattice_field<Dim>(const Lattice<Dim>&, const std::vector<float>&, \
                                                                const Grid&, double);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
