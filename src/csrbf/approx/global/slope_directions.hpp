#pragma once

#include "csrbf/approx/samples/samples.hpp"

#include <optional>

namespace csrbf {

/// The directions, columns of a rotation, along which values change fastest, slowest and between: the principal axes of
/// the mean square slope M, from differences of neighbours, (v_i - v_j)^2 = c + (x_i - x_j)^T M (x_i - x_j), where c is
/// noise. From at most some thousand samples. None where the axes of the coordinates do nearly as well: where the
/// volume of the ellipsoid of M is not far below that of the one with the same slopes along them (Hadamard's
/// inequality).
template <int Dim>
std::optional<Eigen::Matrix<double, Dim, Dim>> slope_directions(const Samples<Dim>& samples);

}  // namespace csrbf
