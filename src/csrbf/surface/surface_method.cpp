#include "csrbf/surface/surface_method.hpp"

#include "csrbf/surface/baselines/baselines.hpp"
#include "csrbf/surface/baselines/method_fit.hpp"
#include "csrbf/surface/medial/medial_axis.hpp"

namespace csrbf {
namespace {

MethodFit medial_axis(const PreparedCloud& prepared, const MethodOptions& options) {
  const MedialAxisFit fit =
      fit_medial_axis(prepared.cloud, *prepared.tree,
                      {.centers = options.centers, .smoothing = options.smoothing, .progress = options.progress});
  return {fit.field, fit.scales.size(), fit.smoothing};
}

}  // namespace

const std::vector<SurfaceMethod>& surface_methods() {
  namespace c = baselines;
  static const std::vector<SurfaceMethod> methods = {
      {"medial-axis", "quadrics and CSRBFs with supports adapted to the medial axis (Gelas 2006)", true, true, true,
       medial_axis},
      {"multilevel", "levels of quadrics and CSRBFs (Ohtake 2003)", true, false, false, c::multilevel},
      {"adaptive", "quadrics and CSRBFs with adaptive supports (Ohtake 2004)", true, false, true, c::adaptive},
      {"mpu", "partition of unity over an octree of quadrics (Ohtake 2003)", true, false, false, c::mpu},
      {"tobor", "partition of unity of triharmonic splines (Tobor 2004)", false, true, true, c::tobor},
      {"hoppe", "distance to the nearest tangent plane (Hoppe 1992)", false, false, false, c::hoppe},
      {"adamson-alexa", "moving tangent planes (Adamson and Alexa 2003)", false, false, false, c::adamson_alexa},
      {"projection-mls", "distance to moving polynomials (Levin 1998)", false, false, false, c::projection_mls},
      {"morse", "CSRBFs of one support (Morse 2001)", true, true, true, c::morse},
      {"carr", "biharmonic spline with points off the surface (Carr 2001)", true, true, true, c::carr},
      {"turk-obrien", "triharmonic spline with inner points (Turk and O'Brien 2002)", true, true, true, c::turk_obrien},
      {"savchenko", "triharmonic spline with a carrier (Savchenko 1995)", true, true, true, c::savchenko},
      {"dinh", "radial functions stretched along the surface (Dinh 2001)", true, true, true, c::dinh},
      {"blobby", "sum of Gaussian blobs, split where errors are largest (Muraki 1991)", true, true, true, c::blobby},
      {"3l", "one polynomial, three levels (Blane 2000)", true, false, false, c::three_levels},
      {"gradient-one", "one polynomial, unit gradients (Tasdizen 2000)", true, false, false, c::gradient_one},
      {"min-max", "one polynomial, least worst error (Helzer 2004)", true, false, false, c::min_max},
      {"min-var", "one polynomial, least mean error (Helzer 2004)", true, false, false, c::min_var},
  };
  return methods;
}

const SurfaceMethod* find_surface_method(std::string_view name) {
  const std::vector<SurfaceMethod>& all = surface_methods();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SurfaceMethod& m) { return m.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace csrbf
