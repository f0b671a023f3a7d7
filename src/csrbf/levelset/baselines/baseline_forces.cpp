#include "csrbf/levelset/baselines/baseline_forces.hpp"

#include <cmath>

namespace csrbf {

ForceUpdate baseline_forces(ForceSource& source, std::size_t voxels, std::vector<double>& energy) {
  return [&source, voxels, &energy](const unsigned char* labels, float* force) {
    source.fit({labels, voxels});
    double sum = source.force(1, 1, {force, voxels}), size = 0;
    for (std::size_t i = 0; i < voxels; ++i) {
      size += static_cast<double>(std::abs(force[i]));
      if (labels[i] != 0) sum += static_cast<double>(force[i]);
    }
    energy.push_back(sum / (size > 0 ? size : 1));
  };
}

}  // namespace csrbf
