#pragma once

/// The whole library. The headers listed here are its public ones, and the only ones that are installed: CMake reads
/// this list. Everything else under src/ is internal.

// One sentence instead of the errors that an older standard would cause in the headers below.
#if !defined(_MSVC_LANG) && __cplusplus < 202002L
#error "csrbf needs C++20: compile with -std=c++20 or later"
#else

#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/fit_options.hpp"
#include "csrbf/approx/function.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/inpaint.hpp"
#include "csrbf/approx/levels/error_bounded.hpp"
#include "csrbf/approx/levels/fixed_budget.hpp"
#include "csrbf/approx/levels/least_squares.hpp"
#include "csrbf/approx/levels/level_fit.hpp"
#include "csrbf/approx/levels/multilevel.hpp"
#include "csrbf/approx/levels/pca_multiresolution.hpp"
#include "csrbf/approx/moving/moving_least_squares.hpp"
#include "csrbf/approx/rbf_interpolator.hpp"
#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"
#include "csrbf/core/image.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/core/mesh.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"
#include "csrbf/implicit/combine.hpp"
#include "csrbf/implicit/compare.hpp"
#include "csrbf/implicit/contour_lines.hpp"
#include "csrbf/implicit/curvature.hpp"
#include "csrbf/implicit/draw_contour.hpp"
#include "csrbf/implicit/mesh/mesh_distance.hpp"
#include "csrbf/implicit/mesh/optimize_mesh.hpp"
#include "csrbf/implicit/plane_section.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/preview.hpp"
#include "csrbf/implicit/raycast.hpp"
#include "csrbf/implicit/render.hpp"
#include "csrbf/implicit/render_options.hpp"
#include "csrbf/implicit/ridges.hpp"
#include "csrbf/implicit/sample_particles.hpp"
#include "csrbf/io/contour_lines.hpp"
#include "csrbf/io/image.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/polylines.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"
#include "csrbf/kernels/kernel.hpp"
#include "csrbf/levelset/baselines/collocation.hpp"
#include "csrbf/levelset/baselines/finite_difference.hpp"
#include "csrbf/levelset/baselines/flow.hpp"
#include "csrbf/levelset/baselines/nodes.hpp"
#include "csrbf/levelset/compare_labels.hpp"
#include "csrbf/levelset/image_contour.hpp"
#include "csrbf/levelset/objects.hpp"
#include "csrbf/levelset/seed.hpp"
#include "csrbf/levelset/segment.hpp"
#include "csrbf/levelset/segment_options.hpp"
#include "csrbf/levelset/track.hpp"
#include "csrbf/linalg/ridge.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/surface/estimate_normals.hpp"
#include "csrbf/surface/normals/orient_normals.hpp"
#include "csrbf/surface/prepare/transfer_properties.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/surface/reconstruct_contours.hpp"
#include "csrbf/surface/reconstruct_options.hpp"
#include "csrbf/surface/surface_method.hpp"
#include "csrbf/surface/trim.hpp"
#include "csrbf/tiles/fit_tiles.hpp"
#include "csrbf/tiles/reconstruct_tiles.hpp"
#include "csrbf/tiles/tile_share.hpp"
#include "csrbf/version.hpp"

namespace csrbf {

/// The library may allocate a matrix that a program frees, and the other way round. So both must align matrices alike:
/// to 16 bytes, with AVX to 32, with AVX-512 to 64, as chosen by -march=native. The library defines this function for
/// its own alignment only, so a program with another one does not link; otherwise it would crash. The remedy is in the
/// name: compile the library with the same flags, as by `cmake -DCMAKE_CXX_FLAGS=-march=native`.
int compile_csrbf_with_the_same_march(std::integral_constant<int, EIGEN_DEFAULT_ALIGN_BYTES> alignment);

/// Makes every program refer to it.
#ifdef __GNUC__
[[gnu::used]]
#endif
inline int (*const same_march_is_needed)(std::integral_constant<int, EIGEN_DEFAULT_ALIGN_BYTES>) =
    &compile_csrbf_with_the_same_march;

}  // namespace csrbf

#endif
