#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/lattice.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// The level set of a lattice in physical coordinates, scaled to about the signed distance at its contour.
template <int Dim>
std::shared_ptr<const Field<Dim>> lattice_field(const Lattice<Dim>& lattice, const std::vector<float>& coefficients,
                                                const Grid& grid);

/// f_k - max of the others: positive where field k is the largest. Has the derivatives of the two that count.
template <int Dim>
std::shared_ptr<const Field<Dim>> largest_field(std::vector<std::shared_ptr<const Field<Dim>>> fields, std::size_t k);

}  // namespace csrbf
