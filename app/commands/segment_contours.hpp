#pragma once

#include "commands/commands.hpp"

#include "csrbf/levelset/image_contour.hpp"
#include "csrbf/levelset/segment.hpp"

namespace csrbf::app {

/// The contours of all regions except the outside.
template <int Dim>
class SegmentContours {
 public:
  /// Extracts them. `grid`: of the image.
  SegmentContours(const Segmentation<Dim>& segmentation, const Grid& grid, const Progress& progress);

  /// Measures them for the report and the summary.
  void measure(Session& session) const;

  /// Writes them to one file; returns warnings. Throws IoError.
  std::vector<std::string> write(const std::string& path) const;

  /// The surfaces of all of them as one mesh; empty in the plane.
  [[nodiscard]] Mesh mesh() const;

 private:
  using Contour = std::conditional_t<Dim == 2, ImageContour, ImageSurface>;
  std::vector<Contour> contours_;
};

template <>
std::vector<std::string> SegmentContours<2>::write(const std::string& path) const;
template <>
std::vector<std::string> SegmentContours<3>::write(const std::string& path) const;

/// Whether contours are written to such files, in the plane or in space.
bool is_contour_file(const std::string& path);

/// Throws UsageError unless the extension is one that contours of that dimension are written to.
void check_contour_file(const std::string& path, int dimension);

}  // namespace csrbf::app
