#pragma once

#include "csrbf/core/mesh.hpp"

#include <optional>

namespace csrbf {

/// Points on the faces of a mesh, with the normals of the faces and the properties of the vertices nearby, if the
/// vertices alone do not tell the surface; else nothing. They do not where, on more than a tenth of the area, a quarter
/// of the twelve nearest vertices have other normals than the face (by 45 degrees): vertices of CAD models lie on edges
/// and far apart along them, those of decimated meshes are as far apart as walls are thick. Of scanned and remeshed
/// surfaces at most 9 % of the area were such, of CAD models 20 to 100 %. As many points as vertices, at least 20,000,
/// stratified by area; then vertices on no face, with their normals, if any (else zero). Nothing, too, where faces
/// contradict each other.
///
/// Throws InvalidInput for corrupt meshes. O((v + t) log v).
std::optional<PointCloud> samples_of_coarse_faces(const Mesh& mesh);

}  // namespace csrbf
