#pragma once

#include <cmath>
#include <vector>

namespace csrbf {

/// What the voxels on the wrong side would save by changing sides, sum |force| over them, as a share of sum |force|: 0
/// when every voxel is where its force wants it.
inline double label_gap(const std::vector<unsigned char>& labels, const std::vector<float>& force) {
  double wrong = 0, all = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double size = std::abs(static_cast<double>(force[i]));
    all += size;
    if ((force[i] > 0) == (labels[i] != 0)) wrong += size;
  }
  return all > 0 ? wrong / all : 0;
}

}  // namespace csrbf
