#pragma once

#include "csrbf/levelset/segment.hpp"

namespace csrbf {

/// What was found, for reports of the program and the browser: regions, components, noise, the steps, and what only
/// some images have. Json is a type of nlohmann's library, which the library does without.
template <class Json>
Json segment_json(const SegmentReport& r) {
  Json regions = Json::array();
  for (const RegionReport& region : r.regions)
    regions.push_back({{"label", region.label},
                       {"voxels", region.voxels},
                       {"volume", region.volume},
                       {"mean", region.mean},
                       {"sd", region.sd}});
  Json result = {{"iterations", r.iterations}, {"converged", r.converged},   {"energy", r.energy},
                 {"regions", regions},         {"components", r.components}, {"noise", r.noise}};
  if (!r.prices.empty()) {
    Json prices = Json::array();
    for (const EnergyPrice& each : r.prices)
      prices.push_back({{"energy", name_of(each.energy)}, {"shading", name_of(each.shading)}, {"nats", each.nats}});
    result["prices"] = prices;
  }
  if (r.uneven_noise) result["uneven_noise"] = *r.uneven_noise;
  if (r.noise_growth) result["noise_growth"] = *r.noise_growth;
  if (r.grain) result["grain"] = *r.grain;
  if (r.blur) result["blur"] = *r.blur;
  if (r.impulses) result["impulses"] = *r.impulses;
  if (r.missing) result["missing"] = *r.missing;
  if (r.textures) result["textures"] = *r.textures;
  if (r.speckle) result["speckle"] = *r.speckle;
  if (!r.channels.empty()) result["channels"] = r.channels;
  return result;
}

}  // namespace csrbf
