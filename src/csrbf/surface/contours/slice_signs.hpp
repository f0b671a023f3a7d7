#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/surface/contours/slices.hpp"

namespace csrbf {

/// A slice as part of a stack, the slices with about the same normal.
struct StackedSlice {
  Index slice = 0;
  double spacing = 0;  ///< distance to the nearest slice of the stack, or the size of the contours if there is none
  Box<2> box;          ///< of the contours of the stack, in the coordinates of the slice
  double beyond = 0;   ///< at an end of the stack without contours beyond it: one spacing along the normal of the
                       ///< slice, signed; else 0
};

struct SliceStacks {
  std::vector<StackedSlice> slices;
  std::optional<Point<3>> common_normal;  ///< of a single stack
  double largest_spacing = 0;             ///< between neighbours in a stack
};

SliceStacks find_stacks(const Points<3>& points, const Slices& slices);

/// Points where the sign of a fit was wrong, with values to impose there.
struct SignSamples {
  std::vector<Point<3>> places;
  std::vector<double> values;
};

/// Compares the signs of a field with those known in the planes of the slices and adds samples where they differ;
/// returns whether there were any.
bool add_wrong_signs(const Field<3>& field, const Slices& slices, const SliceStacks& stacks, SignSamples& samples);

/// A plane that cuts off a solid.
struct Cap {
  Point<3> position;
  Point<3> outward;
  double height = 0;  ///< above the last slice
};

/// Lids for the ends of stacks at which the surface is still open one spacing beyond the last slice: half a spacing
/// beyond it where the cross-section does not shrink, a whole one where it nearly vanishes.
std::vector<Cap> find_caps(const Field<3>& field, const Slices& slices, const SliceStacks& stacks);

}  // namespace csrbf
