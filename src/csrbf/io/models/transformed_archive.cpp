#include "csrbf/io/models/surface_parts.hpp"

#include "csrbf/io/models/field_archive.hpp"
#include "csrbf/io/models/field_parts.hpp"
#include "csrbf/surface/baselines/quadric_balls.hpp"
#include "csrbf/surface/medial/medial_axis_field.hpp"

namespace csrbf {
namespace {

using baselines::QuadricBalls;

constexpr const char* medial_axis_kind = "medial axis surface";
constexpr const char* balls_kind = "quadrics in balls";

void set_balls(Archive& archive, const Points<3>& centers, const Eigen::VectorXd& supports,
               const BallTree::Quadrics& quadrics) {
  archive.set("centers", centers);
  archive.set("supports", supports);
  archive.set("quadrics", quadrics);
}

// The centres, supports and quadrics of `data`.
template <class Data>
void read_balls(const Archive& archive, Data& data) {
  data.centers = archive.numbers("centers", 3);
  data.supports = archive.numbers("supports", data.centers.cols(), 1);
  data.quadrics = archive.numbers("quadrics", 10, data.centers.cols());
  if (data.centers.cols() == 0 || !(data.supports.minCoeff() > 0)) archive.fail("a support is damaged");
}

Archive medial_to_archive(const MedialAxisField& field) {
  const MedialAxisField::Data& data = field.data();
  Archive archive;
  archive.kind = medial_axis_kind;
  set_balls(archive, data.centers, data.supports, data.quadrics);
  archive.set("far_value", data.far_value);
  archive.set("winding", to_archive(data.winding));
  return archive;
}

std::shared_ptr<const MedialAxisField> medial_axis_from(const Archive& archive) {
  MedialAxisField::Data data;
  read_balls(archive, data);
  data.far_value = positive_number(archive, "far_value");
  data.winding = winding_from(archive.part("winding"));
  return std::make_shared<const MedialAxisField>(std::move(data));
}

Archive balls_to_archive(const QuadricBalls& field) {
  const QuadricBalls::Data& data = field.data();
  Archive archive;
  archive.kind = balls_kind;
  set_balls(archive, data.centers, data.supports, data.quadrics);
  archive.set("normalized", data.normalized ? 1 : 0);
  archive.set("constant", data.constant);
  return archive;
}

std::shared_ptr<const QuadricBalls> balls_from(const Archive& archive) {
  QuadricBalls::Data data;
  read_balls(archive, data);
  data.normalized = archive.integer("normalized", 0, 1) == 1;
  data.constant = archive.number("constant");
  return std::make_shared<const QuadricBalls>(std::move(data));
}

}  // namespace

Archive to_archive(const TransformedField& field) {
  const TransformedField::Data& data = field.data();
  Archive archive;
  archive.kind = transformed_kind;
  archive.set("origin", data.origin);
  archive.set("scale", data.scale);
  archive.set("detail", data.feature_size);
  set_box(archive, data.bounds);
  if (data.seeds.cols() > 0) archive.set("seeds", data.seeds);
  if (const auto* medial_axis = dynamic_cast<const MedialAxisField*>(data.inner.get())) {
    archive.set("inner", medial_to_archive(*medial_axis));
  } else if (const auto* balls = dynamic_cast<const QuadricBalls*>(data.inner.get())) {
    archive.set("inner", balls_to_archive(*balls));
  } else {
    FieldWriter<3> writer;
    archive.set("inner", writer.field(*data.inner));
    writer.store_shared(archive);
  }
  return archive;
}

std::shared_ptr<const TransformedField> transformed_from(const Archive& archive) {
  TransformedField::Data data;
  data.origin = archive.numbers("origin", 3, 1);
  data.scale = positive_number(archive, "scale");
  data.feature_size = positive_number(archive, "detail");
  data.bounds = {archive.numbers("lower_bounds", 3, 1), archive.numbers("upper_bounds", 3, 1)};
  if (archive.has("seeds")) data.seeds = archive.numbers("seeds", 3);
  const Archive inner = archive.part("inner");
  if (inner.kind == medial_axis_kind) {
    data.inner = medial_axis_from(inner);
  } else if (inner.kind == balls_kind) {
    data.inner = balls_from(inner);
  } else {
    data.inner = FieldReader<3>(archive).field(inner);
  }
  return std::make_shared<const TransformedField>(std::move(data));
}

}  // namespace csrbf
