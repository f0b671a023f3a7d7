#pragma once

#include "csrbf/spatial/thinned_points.hpp"

#include <functional>
#include <string>
#include <vector>

namespace csrbf {

/// Points, each with the bytes that belong to it.
template <int Dim>
struct Records {
  std::size_t each = 0;        ///< bytes of the payload of one point
  std::vector<double> points;  ///< Dim each
  std::string payload;

  [[nodiscard]] Index size() const { return std::ssize(points) / Dim; }
  /// Dim x n
  [[nodiscard]] Eigen::Map<const Points<Dim>> matrix() const { return {points.data(), Dim, size()}; }
  [[nodiscard]] std::string_view payload_of(Index i) const {
    return std::string_view(payload).substr(static_cast<std::size_t>(i) * each, each);
  }
  void add(const Point<Dim>& point, std::string_view its_payload) {
    points.insert(points.end(), point.begin(), point.end());
    payload += its_payload;
  }
};

/// Takes the numbers at the ends of payloads off.
template <int Dim>
std::vector<Index> take_numbers(Records<Dim>& records);

/// Appends the records of one tile after another to files, in buffers: any number of files, little memory. The files
/// are raw: the coordinates of each point as doubles, then its payload. Those of tiles without records are not made.
class RecordDealer {
 public:
  explicit RecordDealer(std::vector<std::string> paths);

  template <int Dim>
  void add(Index tile, const Point<Dim>& point, std::string_view payload);
  /// Writes what is in the buffers. Throws IoError.
  void flush();

 private:
  void flush(Index tile);

  std::vector<std::string> paths_;
  std::vector<std::string> buffers_;
  std::vector<char> begun_;  // files that were begun; what an earlier run left is overwritten
  std::size_t most_;         // bytes in a buffer
};

/// The records of raw files, one after the other, with so many bytes of payload each; missing files have none.
template <int Dim>
Records<Dim> read_raw_records(const std::vector<std::string>& paths, std::size_t payload);

/// Writes a tile: its points along the curve and its levels of thinning, in blocks with their boxes; coordinates in
/// single precision where that holds all of them. Throws IoError.
template <int Dim>
void write_tile(const std::string& path, const Records<Dim>& records, const ThinnedPoints& thinned);

/// Appends the records of one level (0: all) that `wants_point` names, of blocks whose boxes `wants_box` names. A level
/// beyond the last has none. Throws IoError.
template <int Dim>
void read_tile(const std::string& path, int level, const std::function<bool(const Box<Dim>&)>& wants_box,
               const std::function<bool(const Point<Dim>&)>& wants_point, Records<Dim>& out);

}  // namespace csrbf
