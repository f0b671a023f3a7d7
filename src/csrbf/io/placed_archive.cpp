#include "csrbf/io/placed_archive.hpp"

#include "csrbf/io/field_archive.hpp"
#include "csrbf/io/field_parts.hpp"
#include "csrbf/io/winding_archive.hpp"
#include "csrbf/surface/medial_axis_field.hpp"

#include <utility>

namespace csrbf {
namespace {

constexpr const char* medial_axis_kind = "medial axis surface";

Archive to_archive(const MedialAxisField& field) {
  const MedialAxisField::Data& data = field.data();
  Archive archive;
  archive.kind = medial_axis_kind;
  archive.set("centers", data.centers);
  archive.set("supports", data.supports);
  archive.set("quadrics", data.quadrics);
  archive.set("far_value", data.far_value);
  archive.set("winding", to_archive(data.winding));
  return archive;
}

std::shared_ptr<const MedialAxisField> medial_axis_from(const Archive& archive) {
  MedialAxisField::Data data;
  data.centers = archive.numbers("centers", 3);
  data.supports = archive.numbers("supports", data.centers.cols(), 1);
  data.quadrics = archive.numbers("quadrics", 10, data.centers.cols());
  data.far_value = positive_number(archive, "far_value");
  data.winding = winding_from(archive.part("winding"));
  if (!(data.supports.minCoeff() > 0)) archive.fail("a support is damaged");
  return std::make_shared<const MedialAxisField>(std::move(data));
}

}  // namespace

Archive to_archive(const PlacedField& field) {
  const PlacedField::Data& data = field.data();
  Archive archive;
  archive.kind = placed_kind;
  archive.set("origin", data.origin);
  archive.set("scale", data.scale);
  archive.set("detail", data.detail);
  set_box(archive, data.bounds);
  if (const auto* medial_axis = dynamic_cast<const MedialAxisField*>(data.inner.get())) {
    archive.set("inner", to_archive(*medial_axis));
  } else {
    FieldWriter<3> writer;
    archive.set("inner", writer.field(*data.inner));
    writer.store_shared(archive);
  }
  return archive;
}

std::shared_ptr<const PlacedField> placed_from(const Archive& archive) {
  PlacedField::Data data;
  data.origin = archive.numbers("origin", 3, 1);
  data.scale = positive_number(archive, "scale");
  data.detail = positive_number(archive, "detail");
  data.bounds = {archive.numbers("lower_bounds", 3, 1), archive.numbers("upper_bounds", 3, 1)};
  const Archive inner = archive.part("inner");
  data.inner = inner.kind == medial_axis_kind ? medial_axis_from(inner) : FieldReader<3>(archive).field(inner);
  return std::make_shared<const PlacedField>(std::move(data));
}

}  // namespace csrbf
