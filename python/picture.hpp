#pragma once

#include "mesh_arrays.hpp"

#include "csrbf/implicit/render.hpp"

#include <optional>

namespace csrbf::python {

/// Options of render() by name, with the mesh that errors are measured to.
class PictureOptions {
 public:
  PictureOptions(const py::dict& given, const std::optional<py::tuple>& reference);

  [[nodiscard]] RenderOptions with(const Progress& progress) const;

 private:
  RenderOptions options_;
  std::optional<Mesh> reference_;
};

/// The pixels, (height, width, 3) of uint8.
py::array_t<std::uint8_t> to_array(const RgbImage& picture);

}  // namespace csrbf::python
