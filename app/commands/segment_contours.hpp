#pragma once

#include "commands/commands.hpp"

#include "csrbf/levelset/image_contour.hpp"
#include "csrbf/levelset/segment.hpp"

namespace csrbf::app {

/// The contours of all regions except the outside: extracts them, measures them for the report and the summary, and
/// writes them.
template <int Dim>
class SegmentContours {
 public:
  SegmentContours(const Segmentation<Dim>& segmentation, const Grid& grid, Session& session);

  /// Writes them to one file; returns warnings. Throws IoError.
  std::vector<std::string> write(const std::string& path) const;

  /// The surfaces of all of them as one mesh; empty in the plane.
  [[nodiscard]] Mesh mesh() const;

 private:
  using Contour = std::conditional_t<Dim == 2, ImageContour, ImageSurface>;
  std::vector<Contour> contours_;
  Space space_;  // of the image
};

template <>
std::vector<std::string> SegmentContours<2>::write(const std::string& path) const;
template <>
std::vector<std::string> SegmentContours<3>::write(const std::string& path) const;

/// Throws UsageError unless the extension is one that contours of that dimension are written to.
void check_contour_file(const std::string& path, int dimension);

}  // namespace csrbf::app
