#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/io/models/archive.hpp"

#include <functional>
#include <memory>

namespace csrbf {

template <int Dim>
class Expansion;
template <int Dim>
class SphereField;
template <int Dim>
class TileStore;

/// Is this the kind of an archive made by FieldWriter?
bool is_field_kind(const std::string& kind);

/// Turns fitted fields into archives. Parts that several fields share (centres, covers, samples) are stored once.
template <int Dim>
class FieldWriter {
 public:
  /// Throws InvalidInput for a kind of field that has no file form.
  Archive field(const Field<Dim>& field);

  /// After the last field: adds the shared parts, and the sizes of tiles, to the archive that contains those of the
  /// fields. The tiles themselves are not in it: see tile_places().
  void store_shared(Archive& archive);

 private:
  bool few_variables(const Field<Dim>& field, Archive& archive);
  Archive sphere(const SphereField<Dim>& field);
  bool level_set(const Field<Dim>& field, Archive& archive);
  std::int64_t share(const void* object, const std::function<Archive()>& to_archive);

  std::map<const void*, std::int64_t> numbers_;
  std::vector<Archive> shared_;
  std::shared_ptr<const TileStore<Dim>> tiles_;  // of a field in tiles
};

/// Reads what FieldWriter made: the fields give the same values, bit for bit.
template <int Dim>
class FieldReader {
 public:
  /// `archive` holds the shared parts.
  explicit FieldReader(const Archive& archive) : archive_(archive) {}

  /// Throws IoError, or InvalidInput, for missing or inconsistent entries.
  std::shared_ptr<const Field<Dim>> field(const Archive& archive);

 private:
  std::shared_ptr<const Expansion<Dim>> expansion(const Archive& archive);
  std::shared_ptr<const Field<Dim>> few_variables(const Archive& archive);
  std::shared_ptr<const Field<Dim>> sphere(const Archive& archive);
  std::shared_ptr<const Field<Dim>> level_set(const Archive& archive);
  template <class T>
  std::shared_ptr<const T> shared(const Archive& user, const std::string& name, const char* kind,
                                  const std::function<std::shared_ptr<const T>(const Archive&)>& from_archive);

  const Archive& archive_;
  std::map<std::int64_t, std::shared_ptr<const void>> read_;
  std::shared_ptr<const TileStore<Dim>> tiles_;
};

}  // namespace csrbf
