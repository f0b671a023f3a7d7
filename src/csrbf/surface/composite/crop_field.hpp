#pragma once

#include "csrbf/surface/composite/composite_field.hpp"

namespace csrbf {

/// A part of space, in the user's coordinates: a box without a smaller one.
struct CropRegion {
  Box<3> box;
  std::optional<Box<3>> hole = {};
};

/// The same field in the region, bit for bit but for the winding number: its samples in the hole, farther than `reach`
/// from its faces, are merged in groups, which changes it by about its usual error. Elsewhere the field is undefined.
CompositeField crop(const CompositeField& field, const CropRegion& region, double reach);

}  // namespace csrbf
