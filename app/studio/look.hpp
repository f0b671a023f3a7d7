#pragma once

#include "common.hpp"

#include "csrbf/core/grid.hpp"

#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <variant>

namespace csrbf::app {

/// The kind of an item from its name alone (viewer/src/engine/engine.js lists them); content may say otherwise.
std::string kind_by_name(const std::string& name);

/// What the page draws: a header in JSON and arrays of numbers behind it. Little-endian: uint32 size of the header, the
/// header, zeros up to a multiple of 8, then the arrays that the header lists under "arrays" with name, type (f4, u4,
/// f8, u1) and count, each padded with zeros to a multiple of 8.
struct Look {
  Json header = Json::object();
  std::string arrays;

  void add(const std::string& name, const std::vector<float>& values) { add(name, "f4", values); }
  void add(const std::string& name, const std::vector<std::uint32_t>& values) { add(name, "u4", values); }
  [[nodiscard]] std::string bytes() const;

 private:
  template <class Number>
  void add(const std::string& name, const char* type, const std::vector<Number>& values);
};

/// Reads files to be drawn; keeps the images that were read last, whose slices are asked for one by one.
class Looker {
 public:
  /// At most `most` points or rows, evenly chosen; all triangles of meshes. Throws IoError, InvalidInput.
  Look look(const std::filesystem::path& file, Index most);

  /// Slice `index` across `axis` of an image: the array "values". Throws InvalidInput outside of it.
  Look slice(const std::filesystem::path& file, int axis, Index index, Index frame = 0);

 private:
  using Image = std::shared_ptr<const Volume<float>>;
  struct Kept {
    std::filesystem::path file;
    std::filesystem::file_time_type time;
    Image image;
  };

  Image image(const std::filesystem::path& file);

  std::mutex mutex_;
  std::list<Kept> kept_;  // the last one first
};

}  // namespace csrbf::app
