#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/io/models/archive.hpp"

#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace csrbf {

/// Is this the kind of the archives that FieldWriter makes?
bool is_field_kind(const std::string& kind);

/// Turns fitted fields into archives. What several fields share (centres, covers, samples) is stored once.
template <int Dim>
class FieldWriter {
 public:
  /// Throws InvalidInput for a kind of field that has no file form.
  Archive field(const Field<Dim>& field);

  /// Adds what the fields share, after the last of them, to the archive that their archives are parts of.
  void store_shared(Archive& archive);

 private:
  bool level_set(const Field<Dim>& field, Archive& archive);
  std::int64_t share(const void* object, const std::function<Archive()>& to_archive);

  std::map<const void*, std::int64_t> numbers_;
  std::vector<Archive> shared_;
};

/// Reads what FieldWriter made: the fields give the same values, bit for bit.
template <int Dim>
class FieldReader {
 public:
  /// `archive` holds what the fields share.
  explicit FieldReader(const Archive& archive) : archive_(archive) {}

  /// Throws IoError, or InvalidInput, for entries that are missing or do not fit together.
  std::shared_ptr<const Field<Dim>> field(const Archive& archive);

 private:
  std::shared_ptr<const Field<Dim>> level_set(const Archive& archive);
  template <class T>
  std::shared_ptr<const T> shared(const Archive& user, const std::string& name, const char* kind,
                                  const std::function<std::shared_ptr<const T>(const Archive&)>& from_archive);

  const Archive& archive_;
  std::map<std::int64_t, std::shared_ptr<const void>> read_;
};

}  // namespace csrbf
