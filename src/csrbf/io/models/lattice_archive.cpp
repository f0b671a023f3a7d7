#include "csrbf/io/models/lattice_archive.hpp"

#include "csrbf/io/models/field_parts.hpp"

#include <Eigen/LU>

namespace csrbf {

template <int Dim>
Archive to_archive(const LatticeField<Dim>& field) {
  const typename LatticeField<Dim>::Data& data = field.data();
  Archive archive;
  archive.kind = lattice_kind;
  archive.set("kernel", data.kernel);
  archive.set("support", data.support);
  archive.set("to_lattice", data.to_lattice.matrix().template topRows<Dim>());
  archive.set("step", data.step);
  archive.set("size", Eigen::Map<const Eigen::Matrix<Index, Dim, 1>>(data.size.data()).template cast<std::int64_t>());
  archive.set("coefficients", data.coefficients);
  set_box(archive, data.bounds);
  return archive;
}

template <int Dim>
std::shared_ptr<const LatticeField<Dim>> lattice_field_from(const Archive& archive) {
  typename LatticeField<Dim>::Data data;
  data.kernel = archive.text("kernel");
  data.support = positive_number(archive, "support");
  data.to_lattice.setIdentity();
  data.to_lattice.matrix().template topRows<Dim>() = archive.numbers("to_lattice", Dim, Dim + 1);
  data.step = archive.numbers("step", Dim, 1);
  const auto& size = archive.array<std::int64_t>("size", Dim, 1);
  std::copy_n(size.data(), Dim, data.size.begin());
  data.coefficients = archive.column("coefficients");
  data.bounds = box_of<Dim>(archive);
  if (data.bounds.empty() || !data.bounds.extent().allFinite()) archive.fail("the box of the lattice is damaged");
  if (data.to_lattice.linear().determinant() == 0) archive.fail("the axes of the lattice are damaged");
  return std::make_shared<const LatticeField<Dim>>(std::move(data));
}

#define CSRBF_INSTANTIATE(Dim)                                \
  template Archive to_archive<Dim>(const LatticeField<Dim>&); \
  template std::shared_ptr<const LatticeField<Dim>> lattice_field_from<Dim>(const Archive&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
