#pragma once

#include "csrbf/core/types.hpp"

#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace csrbf {

/// A dense array of an archive; vectors have one column.
template <class T>
using ArchiveArray = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

/// Named numbers, texts and arrays, and the kind of object they describe: the content of a .csrbf file.
class Archive {
 public:
  using Value = std::variant<double, std::int64_t, std::string, ArchiveArray<double>, ArchiveArray<float>,
                             ArchiveArray<std::int32_t>, ArchiveArray<std::int64_t>, ArchiveArray<std::uint8_t>>;

  std::string kind;            ///< of the object that the entries describe
  std::string source;          ///< the file they were read from, for messages
  std::int64_t file_size = 0;  ///< of the archive alone: tiles of a model may follow in its file

  void set(const std::string& name, double value) { values_[name] = value; }
  void set(const std::string& name, std::string value) { values_[name] = std::move(value); }
  /// Whole numbers of any type, enumerators included.
  template <class T>
  requires std::is_integral_v<T> || std::is_enum_v<T>
  void set(const std::string& name, T value) { values_[name] = static_cast<std::int64_t>(value); }
  /// Matrices, vectors and expressions of a supported scalar type.
  template <class Derived>
  void set(const std::string& name, const Eigen::DenseBase<Derived>& array) {
    using Scalar = typename Derived::Scalar;
    using Stored = std::conditional_t<std::is_same_v<Scalar, Index>, std::int64_t, Scalar>;
    values_[name] = ArchiveArray<Stored>(array.template cast<Stored>());
  }
  template <class T>
  void set(const std::string& name, const std::vector<T>& column) {
    set(name, Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, 1>>(column.data(), std::ssize(column)));
  }
  /// An entry of any type.
  void insert(const std::string& name, Value value) { values_[name] = std::move(value); }
  /// All entries of `part`, and its kind, under "prefix/".
  void set(const std::string& prefix, Archive part);

  [[nodiscard]] bool has(const std::string& name) const { return values_.count(name) > 0; }
  /// The entries, sorted by name.
  [[nodiscard]] const std::map<std::string, Value>& values() const { return values_; }

  /// Number, whole number or text `name`. Throws IoError when there is none of that type.
  [[nodiscard]] double number(const std::string& name) const { return as<double>(name, "a number"); }
  [[nodiscard]] std::int64_t integer(const std::string& name) const { return as<std::int64_t>(name, "an integer"); }
  /// As integer(), and in [lo, hi].
  [[nodiscard]] std::int64_t integer(const std::string& name, std::int64_t lo, std::int64_t hi) const;
  [[nodiscard]] const std::string& text(const std::string& name) const { return as<std::string>(name, "a text"); }
  /// Array `name`, which must have the given shape (negative: any). Throws IoError.
  template <class T>
  [[nodiscard]] const ArchiveArray<T>& array(const std::string& name, Index rows = -1, Index cols = -1) const {
    const auto& found = as<ArchiveArray<T>>(name, "an array of the expected type");
    check_shape(name, found.rows(), found.cols(), rows, cols);
    return found;
  }
  /// As array<double>(); all entries must be finite.
  [[nodiscard]] const ArchiveArray<double>& numbers(const std::string& name, Index rows = -1, Index cols = -1) const;
  /// A column of finite numbers.
  [[nodiscard]] std::vector<double> column(const std::string& name, Index rows = -1) const;
  /// The archive that was stored under "prefix/". Throws IoError when there is none.
  [[nodiscard]] Archive part(const std::string& prefix) const;

  /// Throws IoError "source: message": for inconsistent contents.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  template <class T>
  [[nodiscard]] const T& as(const std::string& name, const char* what) const {
    const auto found = values_.find(name);
    if (found == values_.end()) fail("the model has no entry \"" + name + "\"");
    const T* value = std::get_if<T>(&found->second);
    if (value == nullptr) fail("entry \"" + name + "\" is not " + what);
    return *value;
  }
  void check_shape(const std::string& name, Index rows, Index cols, Index expected_rows, Index expected_cols) const;

  std::map<std::string, Value> values_;
};

/// A box, which may be empty, as the entries "lower_bounds" and "upper_bounds".
template <int Dim>
void set_box(Archive& archive, const Box<Dim>& box) {
  archive.set("lower_bounds", box.lo);
  archive.set("upper_bounds", box.hi);
}

template <int Dim>
Box<Dim> box_of(const Archive& archive) {
  return {archive.array<double>("lower_bounds", Dim, 1), archive.array<double>("upper_bounds", Dim, 1)};
}

/// Format version that this version writes; it reads all up to this one.
inline constexpr int archive_format = 1;

/// The bytes of an archive file. Little-endian: 8 bytes magic, uint32 format, uint64 size of the whole file, kind,
/// uint64 number of entries, entries, CRC-32 of everything before it. Texts are uint32 length and bytes. An entry is
/// its name, a uint8 type (index in Archive::Value) and its value; arrays are uint64 rows, uint64 columns and the
/// columns.
std::string format_archive(const Archive& archive);

/// Reads the bytes of an archive file. Throws IoError for anything but a complete, undamaged file of a known format;
/// never allocates more than a few times the size of the file.
Archive parse_archive(std::string_view bytes, const std::string& name);

/// Writes an archive, complete or not at all (AtomicFile). Throws IoError.
void write_archive(const std::string& path, const Archive& archive);

/// Reads an archive, without the tiles that follow the one of a model in tiles. Throws IoError.
Archive read_archive(const std::string& path);

}  // namespace csrbf
