#include "csrbf/io/models/transform_archive.hpp"

#include <array>
#include <utility>

namespace csrbf {
namespace {

constexpr std::array transforms = {Transform::none, Transform::square_root, Transform::logarithm};

}  // namespace

template <int Dim>
Archive transform_to_archive(const TransformedBack<Dim>& field,
                             const std::function<Archive(const Field<Dim>&)>& to_archive) {
  const typename TransformedBack<Dim>::Parts& parts = field.parts();
  Archive archive;
  archive.kind = transformed_back_kind;
  archive.set("transform", name_of(parts.transform));
  archive.set("of", static_cast<int>(parts.of));
  archive.set("noise", parts.noise);
  archive.set("mean", to_archive(*parts.mean));
  if (!parts.variance) return archive;
  archive.set("variance", to_archive(*parts.variance));
  archive.set("largest", parts.largest);
  return archive;
}

template <int Dim>
std::shared_ptr<const Field<Dim>> transform_from(
    const Archive& archive, const std::function<std::shared_ptr<const Field<Dim>>(const Archive&)>& from_archive) {
  using Back = TransformedBack<Dim>;
  typename Back::Parts parts;
  const std::string name = archive.text("transform");
  bool is_known = false;
  for (const Transform transform : transforms) {
    if (name_of(transform) != name) continue;
    parts.transform = transform;
    is_known = true;
  }
  if (!is_known) archive.fail("this version knows no transform \"" + name + "\"");
  parts.of = static_cast<typename Back::Of>(archive.integer("of", 0, static_cast<int>(Back::Of::function)));
  parts.noise = archive.number("noise");
  if (!(parts.noise >= 0)) archive.fail("the noise is damaged");
  const auto read = [&](const std::string& part) {
    const Archive inner = archive.part(part);
    if (inner.kind == transformed_back_kind) archive.fail("values are transformed twice");
    return from_archive(inner);
  };
  parts.mean = read("mean");
  if (parts.of == Back::Of::value) return std::make_shared<const Back>(std::move(parts));
  parts.variance = read("variance");
  parts.largest = archive.number("largest");
  if (!(parts.largest > 0)) archive.fail("the largest variance is damaged");
  return std::make_shared<const Back>(std::move(parts));
}

#define CSRBF_INSTANTIATE(Dim)                                                                  \
  template Archive transform_to_archive<Dim>(const TransformedBack<Dim>&,                       \
                                             const std::function<Archive(const Field<Dim>&)>&); \
  template std::shared_ptr<const Field<Dim>> transform_from<Dim>(                               \
      const Archive&, const std::function<std::shared_ptr<const Field<Dim>>(const Archive&)>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
