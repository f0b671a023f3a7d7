#include "csrbf/io/models/surface_parts.hpp"

namespace csrbf {
namespace {

constexpr Index patch_numbers =
    24;  // center 3, T 9, radius, flatness, quadric 10; of the kind "joined patches" also: join
constexpr const char* joined_kind = "joined patches";

Archive to_archive(const Patches& patches) {
  Archive archive;
  const bool joined = patches.pieces() > patches.size();
  archive.kind = joined ? joined_kind : "patches";
  Eigen::MatrixXd table(patch_numbers + (joined ? 1 : 0), patches.pieces());
  for (Index i = 0; i < patches.pieces(); ++i) {
    const Patch& p = patches.patch(i);
    table.col(i).head(patch_numbers) << p.center, p.T.reshaped(), p.radius, p.flatness, p.quadric;
    if (joined) table(patch_numbers, i) = static_cast<double>(p.join);
  }
  archive.set("patches", table);
  archive.set("center_begin", patches.center_begin());
  archive.set("centers", Eigen::Map<const Points<3>>(patches.center_coordinates().data(), 3, patches.centers()));
  archive.set("alpha", patches.alpha());
  return archive;
}

Join join_from(const Archive& archive, double number, bool first) {
  for (const Join join : {Join::first, Join::intersection, Join::unite})
    if (number == static_cast<double>(join) && !(first && join != Join::first)) return join;
  archive.fail("a patch is damaged");
}

Patches patches_from(const Archive& archive) {
  const bool joined = archive.kind == joined_kind;
  const auto& table = archive.numbers("patches", patch_numbers + (joined ? 1 : 0));
  const auto& begin = archive.array<std::int64_t>("center_begin", table.cols() + 1, 1);
  const auto& centers = archive.numbers("centers", 3);
  const auto& alpha = archive.numbers("alpha", centers.cols(), 1);
  if (begin(0, 0) != 0 || begin(table.cols(), 0) != centers.cols()) archive.fail("the centres do not fit the patches");
  Patches patches;
  for (Index i = 0; i < table.cols(); ++i) {
    const Index first = begin(i, 0), count = begin(i + 1, 0) - first;
    if (count < 0 || first < 0 || first + count > centers.cols()) archive.fail("the centres do not fit the patches");
    Patch p;
    p.center = table.col(i).segment<3>(0);
    p.T = table.col(i).segment<9>(3).reshaped(3, 3);
    p.radius = table(12, i);
    p.flatness = table(13, i);
    p.quadric = table.col(i).segment<10>(14);
    if (joined) p.join = join_from(archive, table(patch_numbers, i), i == 0);
    if (!(p.radius > 0) || !(p.flatness > 0)) archive.fail("a patch is damaged");
    patches.add(p, centers.middleCols(first, count), alpha.col(0).segment(first, count));
  }
  patches.build();
  return patches;
}

}  // namespace

Archive to_archive(const WindingNumber& winding) {
  Archive archive;
  archive.kind = "winding number";
  const WindingNumber::Data data = winding.data();
  archive.set("points", data.points);
  archive.set("normals", data.normals);
  archive.set("areas", data.areas);
  archive.set("smoothing_length", data.eps);
  return archive;
}

WindingNumber winding_from(const Archive& archive) {
  WindingNumber::Data data;
  data.points = archive.numbers("points", 3);
  data.normals = archive.numbers("normals", 3, data.points.cols());
  data.areas = archive.numbers("areas", data.points.cols(), 1);
  data.eps = archive.numbers("smoothing_length", data.points.cols(), 1);
  return WindingNumber(std::move(data));
}

Archive to_archive(const CompositeField& field) {
  const CompositeField::Data& data = field.data();
  Archive archive;
  archive.kind = composite_kind;
  archive.set("origin", data.origin);
  archive.set("scale", data.scale);
  archive.set("far_value", data.far_value);
  archive.set("detail", data.feature_size);
  if (data.noisy) archive.set("noisy", 1.0);
  if (data.winding_level != 0) archive.set("winding_level", data.winding_level);
  archive.set("lower_bounds", data.bounds.lo);
  archive.set("upper_bounds", data.bounds.hi);
  archive.set("levels", data.levels.size());
  for (std::size_t i = 0; i < data.levels.size(); ++i)
    archive.set("level" + std::to_string(i), to_archive(data.levels[i]));
  archive.set("winding", to_archive(data.winding));
  return archive;
}

std::shared_ptr<const CompositeField> composite_from(const Archive& archive) {
  CompositeField::Data data;
  data.origin = archive.numbers("origin", 3, 1);
  data.scale = archive.number("scale");
  data.far_value = archive.number("far_value");
  data.feature_size = archive.number("detail");
  data.noisy = archive.has("noisy");
  if (archive.has("winding_level")) data.winding_level = archive.number("winding_level");
  data.bounds.lo = archive.numbers("lower_bounds", 3, 1);
  data.bounds.hi = archive.numbers("upper_bounds", 3, 1);
  if (!(data.scale > 0 && data.far_value > 0 && data.feature_size > 0)) archive.fail("the scale is damaged");
  if (!(std::abs(data.winding_level) <= 2)) archive.fail("the winding level is damaged");
  const std::int64_t levels = archive.integer("levels", 1, 64);
  for (std::int64_t i = 0; i < levels; ++i)
    data.levels.push_back(patches_from(archive.part("level" + std::to_string(i))));
  data.winding = winding_from(archive.part("winding"));
  return std::make_shared<const CompositeField>(std::move(data));
}

}  // namespace csrbf
