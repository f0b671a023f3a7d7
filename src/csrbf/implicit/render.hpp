#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/image.hpp"
#include "csrbf/implicit/render_options.hpp"

namespace csrbf {

/// Makes a ray-traced picture of a mesh. It depends on the mesh and the options only and is invariant under a common
/// similarity of mesh, frame and reference. Curvature colours come from the vertex properties mean_curvature and
/// gaussian_curvature. O(t log t + pixels * samples^2 * log t). Throws InvalidInput if the mesh has no surface or is
/// corrupt, a property is missing or an option is out of range; Cancelled.
RgbImage render(const Mesh& mesh, const RenderOptions& options = {});

/// Makes a ray-traced picture of the zero set of a field. Camera rays hit the zero set itself, exactly up to rounding;
/// shadows are those of a polygonization. Both use `field_resolution` cells along the longest side of the bounds of the
/// field, and parts thinner than a cell may be missed. Cost: that of polygonize(), one Hessian for each of its
/// vertices, and about five gradients for every ray that comes near the surface. Throws InvalidInput for options out of
/// range; as polygonize(): SolverFailure if there is no surface; Cancelled.
RgbImage render(const Field<3>& field, const RenderOptions& options = {});

}  // namespace csrbf
