#pragma once

#include "csrbf/approx/samples/drift_field.hpp"
#include "csrbf/io/models/field_archive.hpp"

namespace csrbf {

inline constexpr const char* drift_kind = "field with a drift";
inline constexpr const char* alone_kind = "field with its shared parts";

/// The archive of a field with a drift, and back. Throws IoError, or InvalidInput, for missing or inconsistent entries.
template <int Dim>
Archive drift_to_archive(const DriftField<Dim>& field);
template <int Dim>
std::shared_ptr<const Field<Dim>> drift_field_from(const Archive& archive);

/// A field of another dimension, with the parts that it shares with none.
template <int E>
Archive alone(const Field<E>& field) {
  FieldWriter<E> writer;
  Archive archive;
  archive.kind = alone_kind;
  archive.set("field", writer.field(field));
  writer.store_shared(archive);
  return archive;
}

template <int E>
std::shared_ptr<const Field<E>> alone_from(const Archive& archive) {
  if (archive.kind != alone_kind) archive.fail("a part is not a field");
  return FieldReader<E>(archive).field(archive.part("field"));
}

}  // namespace csrbf
