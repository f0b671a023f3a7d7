#pragma once

#include "bindings.hpp"

#include "csrbf/core/grid.hpp"

namespace csrbf::python {

/// That of the name, as `Image.space`. Throws InvalidInput for others.
Space space_named(const std::string& name);

/// Everything about an image except its values: size and axes, spacing, origin, direction, space, frames, time_step,
/// components and type.
py::dict to_dict(const VolumeLayout& layout);

/// The inverse of to_dict().
VolumeLayout layout_from(const py::dict& given);

/// The image of these values, in the order of Volume. Throws InvalidInput when their number does not match the layout.
template <class Scalar>
Volume<Scalar> volume_from(const py::array_t<Scalar, py::array::c_style | py::array::forcecast>& values,
                           const py::dict& given) {
  Volume<Scalar> volume;
  static_cast<VolumeLayout&>(volume) = layout_from(given);
  require(values.size() == volume.values_per_frame() * volume.frames, "Image", "number of values", values.size(),
          "must be " + std::to_string(volume.values_per_frame() * volume.frames));
  volume.values.assign(values.data(), values.data() + values.size());
  return volume;
}

}  // namespace csrbf::python
