#pragma once

#include "csrbf/core/types.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace csrbf {

/// How refine_by_sparse_blocks() goes.
struct SparseBlocks {
  Index width = 8;             ///< of a block along every axis, in voxels; at most what the image has
  Index step = 2;              ///< from one block to the next
  double first_threshold = 0;  ///< of the coefficients that are kept, in the unit of the values
  double last_threshold = 0;
  int rounds = 20;
};

/// Replaces the unknown voxels (not 0 in `unknown`) of an image, x fastest, by what overlapping blocks of the image say
/// when only the large coefficients of their cosine transforms are kept: few of them describe edges and textures, but
/// not the errors of what is in the unknown voxels at the start. Rounds with thresholds that fall geometrically;
/// blocks count more the fewer coefficients they keep (Guleryuz 2006). Known voxels do not change. Of blocks without
/// unknown voxels nothing is computed. O(rounds x voxels near unknown ones x axes x width x (width / step)^axes); the
/// same bits for any number of threads.
void refine_by_sparse_blocks(std::span<float> values, std::span<const std::uint8_t> unknown,
                             const std::array<Index, 3>& size, const SparseBlocks& options);

}  // namespace csrbf
