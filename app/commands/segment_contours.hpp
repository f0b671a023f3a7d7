#pragma once

#include "commands/commands.hpp"

#include "csrbf/levelset/image_contour.hpp"
#include "csrbf/levelset/segment.hpp"

namespace csrbf::app {

/// The contours of all regions except the outside: extracts them, measures them for the report and the summary, and
/// writes them. Refers to the segmentation and the grid.
template <int Dim>
class SegmentContours {
 public:
  SegmentContours(const Segmentation<Dim>& segmentation, const Grid& grid, Session& session);

  /// Writes them to one file; returns warnings. Throws IoError.
  std::vector<std::string> write(const std::string& path) const;

  /// The surfaces of all of them as one mesh; empty in the plane. `resolution` 0: as they were extracted.
  [[nodiscard]] Mesh mesh(int resolution) const;

 private:
  using Contour = std::conditional_t<Dim == 2, ImageContour, ImageSurface>;
  const Segmentation<Dim>& segmentation_;
  const Grid& grid_;
  std::vector<Contour> contours_;
};

/// Throws UsageError unless the extension is one that contours of that dimension are written to.
void check_contour_file(const std::string& path, int dimension);

}  // namespace csrbf::app
