#include "csrbf/io/models/surface_archive.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/implicit/combine.hpp"
#include "csrbf/implicit/combine/extend_distance.hpp"
#include "csrbf/io/models/field_archive.hpp"
#include "csrbf/io/models/field_parts.hpp"
#include "csrbf/io/models/surface_parts.hpp"

namespace csrbf {
namespace {

constexpr const char* combined_kind = "combined surface";
constexpr const char* extended_kind = "extended surface";
// Limits on damaged files.
constexpr std::int64_t most_terms = 1 << 20;
constexpr int deepest = 256;  // nested solids; bounds the recursion
constexpr std::int64_t most_nodes = 4096;

// Archives of trees of solids; parts that their fitted functions share are stored at the root.
class Writer {
 public:
  Archive surface(const Field<3>& field);

  FieldWriter<3> fitted;

 private:
  Archive combined(const CombinedField& field);
  Archive extended(const ExtendedField& field);
};

Archive Writer::surface(const Field<3>& field) {
  if (const auto* composite = dynamic_cast<const CompositeField*>(&field)) return to_archive(*composite);
  if (const auto* transformed = dynamic_cast<const TransformedField*>(&field)) return to_archive(*transformed);
  if (const auto* combination = dynamic_cast<const CombinedField*>(&field)) return combined(*combination);
  if (const auto* extension = dynamic_cast<const ExtendedField*>(&field)) return extended(*extension);
  return fitted.field(field);
}

Archive Writer::combined(const CombinedField& field) {
  const CombinedField::Data& data = field.data();
  Archive archive;
  archive.kind = combined_kind;
  archive.set("blending", std::string(name_of(data.blending)));
  archive.set("range", data.range);
  archive.set("sharpness", data.sharpness);
  archive.set("complemented", data.complemented);
  archive.set("terms", data.terms.size());
  for (std::size_t i = 0; i < data.terms.size(); ++i) {
    archive.set("term" + std::to_string(i), surface(*data.terms[i].solid));
    archive.set("term" + std::to_string(i) + "_complemented", data.terms[i].complemented);
  }
  return archive;
}

Archive Writer::extended(const ExtendedField& field) {
  const ExtendedField::Data& data = field.data();
  Archive archive;
  archive.kind = extended_kind;
  archive.set("near", data.near);
  archive.set("origin", data.origin);
  archive.set("spacing", data.spacing);
  archive.set("size", data.size.cast<std::int64_t>());
  archive.set("lack", data.lack);
  archive.set("inner", surface(*data.inner));
  return archive;
}

class SurfaceReader {
 public:
  explicit SurfaceReader(const Archive& root) : fitted_(root) {}

  std::shared_ptr<const Field<3>> surface(const Archive& archive, int depth = 0);

 private:
  std::shared_ptr<const Field<3>> combined(const Archive& archive, int depth);
  std::shared_ptr<const Field<3>> extended(const Archive& archive, int depth);

  FieldReader<3> fitted_;
};

std::shared_ptr<const Field<3>> SurfaceReader::surface(const Archive& archive, int depth) {
  if (depth > deepest) archive.fail("solids are nested more than " + std::to_string(deepest) + " levels deep");
  if (archive.kind == composite_kind) return composite_from(archive);
  if (archive.kind == transformed_kind) return transformed_from(archive);
  if (archive.kind == combined_kind) return combined(archive, depth);
  if (archive.kind == extended_kind) return extended(archive, depth);
  if (!is_field_kind(archive.kind)) archive.fail("this is a \"" + archive.kind + "\", not a surface");
  return fitted_.field(archive);
}

std::shared_ptr<const Field<3>> SurfaceReader::combined(const Archive& archive, int depth) {
  CombinedField::Data data;
  const std::optional<Blending> blending = blending_named(archive.text("blending"));
  if (!blending) archive.fail("this version knows no blending \"" + archive.text("blending") + "\"");
  data.blending = *blending;
  data.range = archive.number("range");
  data.sharpness = archive.number("sharpness");
  const bool ranged = has_range(data.blending);
  if (ranged && !(data.range >= 0 && std::isfinite(data.range) && data.sharpness >= 1 && data.sharpness < 1e9))
    archive.fail("the range of the blend is damaged");
  data.complemented = archive.integer("complemented", 0, 1) == 1;
  for (std::int64_t i = 0, count = archive.integer("terms", 1, most_terms); i < count; ++i) {
    const std::string term = "term" + std::to_string(i);
    data.terms.push_back({surface(archive.part(term), depth + 1), archive.integer(term + "_complemented", 0, 1) == 1});
  }
  if (ranged && data.range == 0 && data.terms.size() > 1) archive.fail("the range of the blend is damaged");
  return std::make_shared<const CombinedField>(std::move(data));
}

std::shared_ptr<const Field<3>> SurfaceReader::extended(const Archive& archive, int depth) {
  ExtendedField::Data data;
  data.near = positive_number(archive, "near");
  data.origin = archive.numbers("origin", 3, 1);
  data.spacing = positive_number(archive, "spacing");
  const auto& size = archive.array<std::int64_t>("size", 3, 1);
  if (size.minCoeff() < 4 || size.maxCoeff() > most_nodes) archive.fail("the lattice is damaged");
  data.size = size.col(0).cast<int>();
  data.lack = archive.array<float>("lack", size.prod(), 1);
  if (!(data.lack.minCoeff() >= 0 && data.lack.allFinite())) archive.fail("the lattice is damaged");
  data.inner = surface(archive.part("inner"), depth + 1);
  return std::make_shared<const ExtendedField>(std::move(data));
}

}  // namespace

Archive surface_to_archive(const Field<3>& field) {
  Writer writer;
  Archive archive = writer.surface(field);
  writer.fitted.store_shared(archive);
  return archive;
}

std::shared_ptr<const Field<3>> surface_from(const Archive& archive) {
  try {
    return SurfaceReader(archive).surface(archive);
  } catch (const InvalidInput& error) {
    archive.fail(std::string("the model is damaged: ") + error.what());
  }
}

}  // namespace csrbf
