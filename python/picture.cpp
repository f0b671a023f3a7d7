#include "picture.hpp"

#include <array>

namespace csrbf::python {
namespace {

RenderColor color_named(const std::string& name) {
  struct Name {
    const char* name;
    RenderColor color;
  };
  constexpr std::array<Name, 5> names{{{"plain", RenderColor::plain},
                                       {"normal", RenderColor::normal},
                                       {"mean-curvature", RenderColor::mean_curvature},
                                       {"gaussian-curvature", RenderColor::gaussian_curvature},
                                       {"error", RenderColor::error}}};
  for (const auto& [known, color] : names)
    if (name == known) return color;
  throw InvalidInput("render: color = " + name +
                     ": must be plain, normal, mean-curvature, gaussian-curvature or error");
}

UpAxis up_named(const std::string& name) {
  if (name == "x") return UpAxis::x;
  if (name == "y") return UpAxis::y;
  require(name == "z", "render", "up", name, "must be x, y or z");
  return UpAxis::z;
}

}  // namespace

PictureOptions::PictureOptions(const py::dict& given, const std::optional<py::tuple>& reference) {
  read_entry(given, "width", options_.width);
  read_entry(given, "height", options_.height);
  read_entry(given, "view", options_.view);
  read_entry(given, "field_of_view", options_.field_of_view);
  read_entry(given, "color_limit", options_.color_limit);
  read_entry(given, "occlusion_rays", options_.occlusion_rays);
  read_entry(given, "material", options_.material);
  read_entry(given, "background", options_.background);
  options_.up = up_named(word_or(given, "up", "z"));
  options_.color = color_named(word_or(given, "color", "plain"));
  if (!given["ground"].cast<bool>()) options_.ground = Ground::none;
  if (reference) reference_ = mesh_from(*reference);
}

RenderOptions PictureOptions::with(const Progress& progress) const {
  RenderOptions options = options_;
  if (reference_) options.reference = &*reference_;
  options.progress = progress;
  return options;
}

py::array_t<std::uint8_t> to_array(const RgbImage& picture) {
  return py::array_t<std::uint8_t>(std::vector<py::ssize_t>{picture.height, picture.width, 3}, picture.pixels.data());
}

}  // namespace csrbf::python
