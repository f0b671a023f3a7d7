#include "csrbf/surface/surface_method.hpp"

#include "csrbf/surface/medial_axis.hpp"

#include <algorithm>

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
  static const std::vector<SurfaceMethod> methods = {
      {"medial-axis", "quadrics and CSRBFs with supports adapted to the medial axis (Gelas 2006)", medial_axis},
  };
  return methods;
}

const SurfaceMethod* find_surface_method(std::string_view name) {
  const std::vector<SurfaceMethod>& all = surface_methods();
  const auto found = std::find_if(all.begin(), all.end(), [&](const SurfaceMethod& m) { return m.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace csrbf
