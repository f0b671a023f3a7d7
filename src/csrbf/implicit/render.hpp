#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/image.hpp"
#include "csrbf/implicit/render_options.hpp"

namespace csrbf {

/// Ray-traced picture of a mesh. The picture depends on the mesh and the options only and is invariant under a common
/// similarity of mesh, frame and reference. Curvature colours are read from the vertex properties mean_curvature and
/// gaussian_curvature. Throws InvalidInput when the mesh has no surface or is corrupt, a property is missing or an
/// option is out of range. O(t log t + pixels * samples^2 * log t).
RgbImage render(const Mesh& mesh, const RenderOptions& options = {});

/// Ray-traced picture of the zero set of a field. Rays of the camera meet the zero set itself, exact up to rounding
/// (RayCaster, with `field_resolution` cells along the longest side of the field's bounds); shadows are those of a
/// polygonization of that resolution. Parts thinner than a cell may be missed. Throws InvalidInput when an option is
/// out of range and whatever `polygonize` throws: SolverFailure when there is no surface. Cost: that of `polygonize`,
/// one Hessian for each of its vertices, and about five gradients for every ray that comes near the surface.
RgbImage render(const Field<3>& field, const RenderOptions& options = {});

}  // namespace csrbf
