#pragma once

#include "csrbf/io/models/archive.hpp"
#include "csrbf/levelset/lattice/lattice_field.hpp"

namespace csrbf {

/// The kind of archives of level sets on a lattice.
inline constexpr const char* lattice_kind = "lattice";

template <int Dim>
Archive to_archive(const LatticeField<Dim>& field);

/// The field gives the same values, bit for bit. Throws IoError, or InvalidInput, for missing or
/// inconsistent entries.
template <int Dim>
std::shared_ptr<const LatticeField<Dim>> lattice_field_from(const Archive& archive);

}  // namespace csrbf
