#include "csrbf/levelset/image_contour.hpp"
#include "csrbf/levelset/segment.hpp"

namespace csrbf {

template <int Dim>
std::vector<RegionMeasure> measure_segmentation(const Segmentation<Dim>& segmentation, const Grid& grid) {
  std::vector<RegionMeasure> measures;
  const bool two = segmentation.fields.size() == 1;
  for (const RegionReport& region : segmentation.report.regions) {
    if (region.label == 0) continue;
    RegionMeasure measure{region.label, region.voxels, 0, 0, region.mean};
    const auto contour = image_contour(*segmentation.fields[two ? 0 : static_cast<std::size_t>(region.label)], grid);
    if constexpr (Dim == 2) {
      measure.volume = contour.lines.area;
      measure.area = contour.lines.length;
    } else {
      measure.volume = contour.volume;
      measure.area = contour.area;
    }
    measures.push_back(measure);
  }
  return measures;
}

template std::vector<RegionMeasure> measure_segmentation<2>(const Segmentation<2>&, const Grid&);
template std::vector<RegionMeasure> measure_segmentation<3>(const Segmentation<3>&, const Grid&);

}  // namespace csrbf
