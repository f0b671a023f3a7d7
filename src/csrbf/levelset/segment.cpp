#include "csrbf/levelset/segment.hpp"

#include "csrbf/levelset/segment_channels.hpp"
#include "csrbf/levelset/segment_checks.hpp"
#include "csrbf/levelset/segment_local.hpp"
#include "csrbf/levelset/segment_missing.hpp"
#include "csrbf/levelset/segmenter.hpp"

namespace csrbf {

template <int Dim>
Segmentation<Dim> segment(const Volume<float>& image, const SegmentOptions& options) {
  check_segment_options(options);
  check_segment_image<Dim>(image, options);
  Segmentation<Dim> found = segment_without_missing(image, options, [&](const SegmentOptions& known) {
    if (image.components > 1)
      return segment_channels(image, known, [&](const Volume<float>& sum) { return segment<Dim>(sum, known); });
    const auto once = [&](const SegmentOptions& how) {
      return segment_known<Dim>(image, with_choice_of_means(how, image.grid.voxels()));
    };
    return follows_start(known) ? segment_locally(image, known, once) : once(known);
  });
  warn_of_drawing(image, options, found);
  return found;
}

template Segmentation<2> segment<2>(const Volume<float>&, const SegmentOptions&);
template Segmentation<3> segment<3>(const Volume<float>&, const SegmentOptions&);

}  // namespace csrbf
