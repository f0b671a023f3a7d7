#include "report/segment_page.hpp"

#include "report/html.hpp"
#include "report/plots.hpp"
#include "report/surface_view.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/preview.hpp"
#include "csrbf/levelset/image/channel_contrast.hpp"

#include <cctype>
#include <cmath>

namespace csrbf::app {
namespace {

std::string with_error(const Json& measures, const std::string& name) {
  return readable(measures[name], 5) + " ± " + readable(measures[name + "_error"], 1);
}

std::string region_name(const RegionReport& region) {
  return "label " + std::to_string(region.label) + (region.label == 0 ? " (outside)" : "");
}

std::string capitalized(std::string text) {
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

void add_segment_facts(const SegmentReport& r, const Json& measures, bool is_volume, const std::string& unit,
                       Page& page) {
  const auto in_unit = [&](const char* power) { return unit.empty() ? "" : ", " + unit + power; };
  page.facts = {{std::to_string(r.options.regions), "regions"},
                {with_error(measures, is_volume ? "volume" : "area"),
                 is_volume ? "volume inside" + in_unit("³") : "area inside" + in_unit("²")},
                {with_error(measures, is_volume ? "area" : "length"),
                 is_volume ? "area of the surface" + in_unit("²") : "length of the contour" + in_unit("")},
                {std::to_string(r.components), "connected components inside"}};
  page.findings.push_back(r.converged ? "The contour converged after " + counted(r.iterations, "iteration") + "."
                                      : "The contour had not converged after " + counted(r.iterations, "iteration") +
                                            ": more may help (--iterations).");
  for (const RegionReport& region : r.regions)
    page.findings.push_back(capitalized(region_name(region)) + " has " +
                            counted(region.voxels, is_volume ? "voxel" : "pixel") + " with a mean of " +
                            readable(region.mean, 4) + " and a standard deviation of " + readable(region.sd, 4) +
                            (r.channels.empty() ? "." : ", of the weighted sum of the channels."));
  constexpr double strong = 0.5;  // one voxel in six is then beyond the middle between the means
  if (r.noise > strong)
    page.findings.push_back("The noise is strong: its standard deviation is " + rounded(r.noise, 2) +
                            " times the contrast between the regions. Look closely at small parts.");
}

// Of channels, the sum that was segmented.
Figure intensities(const Volume<float>& image, const std::vector<std::uint8_t>& mask,
                   const std::vector<std::uint8_t>& labels, const SegmentReport& r) {
  const bool is_sum = !r.channels.empty();
  const std::vector<float> sum =
      is_sum ? weigh_channels(root_channels(image, mask), r.channels).values : std::vector<float>();
  const std::vector<float>& segmented = is_sum ? sum : image.values;
  constexpr std::size_t most = 64, most_curves = 6;  // bins of six pixels; curves, as the style sheet has colours
  constexpr double least = 0.002;                    // percentiles at the ends of the axis: outliers do not set it
  std::vector<float> values;
  const auto counts = [&](std::size_t i) { return (mask.empty() || mask[i] != 0) && std::isfinite(segmented[i]); };
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (counts(i)) values.push_back(segmented[i]);
  double lo = percentile(values, least), hi = percentile(values, 1 - least);
  double width = hi > lo ? (hi - lo) / most : 1;
  std::size_t parts = most;
  if (std::all_of(values.begin(), values.end(), [](float value) { return value == std::floor(value); })) {
    // As many whole numbers in each bin, or the curves have teeth.
    width = std::ceil(width);
    lo = std::floor(lo) - 0.5;
    parts = static_cast<std::size_t>(std::max(1.0, std::ceil((hi - lo) / width)));
  }
  std::vector<Distribution> distributions;
  for (const RegionReport& region : r.regions)
    if (distributions.size() < most_curves)
      distributions.push_back({region_name(region), std::vector<double>(parts, 0)});
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] >= distributions.size() || !counts(i)) continue;
    const double place = std::clamp(std::floor((segmented[i] - lo) / width), 0.0, static_cast<double>(parts) - 1);
    ++distributions[labels[i]].counts[static_cast<std::size_t>(place)];
  }
  return {
      "Intensities of the regions",
      draw(distributions, lo, lo + width * static_cast<double>(parts),
           is_sum ? "weighted sum of the channels" : "intensity", image.grid.dimension() == 3 ? "voxels" : "pixels"),
      "The less the curves overlap, the more certain the labels. The ends include all values beyond them."};
}

Figure descent(const SegmentReport& r) {
  return {"Descent of the energy", draw(Course{.values = r.energy, .label = "energy per voxel", .counted = "step"}),
          r.converged ? "It ends where the labels stopped changing." : "The labels were still changing at the end."};
}

// The slice across an axis with most voxels inside; the labels tell, without the function.
Index fullest_slice(const Grid& grid, const std::vector<std::uint8_t>& labels, int axis) {
  std::vector<Index> inside(static_cast<std::size_t>(grid.size[axis]), 0);
  std::size_t voxel = 0;
  std::array<Index, 3> at{};
  for (at[2] = 0; at[2] < grid.size[2]; ++at[2])
    for (at[1] = 0; at[1] < grid.size[1]; ++at[1])
      for (at[0] = 0; at[0] < grid.size[0]; ++at[0])
        if (labels[voxel++] != 0) ++inside[static_cast<std::size_t>(at[axis])];
  return std::max_element(inside.begin(), inside.end()) - inside.begin();
}

template <int Dim>
Figure pictures(const Volume<float>& image, const Segmentation<Dim>& segmentation) {
  const std::vector<const Field<Dim>*> fields = inside_fields(segmentation);
  if (Dim == 2) {
    constexpr int size = 900;  // pixels along the longer side, about the width of the page
    return {"The contour on the image",
            picture_element(preview<Dim>(image, fields, {.size = size}), "The image with the contour"), "", true};
  }
  std::vector<std::string> slices;
  constexpr int size = 420;  // pixels: three side by side
  for (const int axis : {2, 1, 0}) {
    const PreviewOptions options{
        .axis = axis, .slice = fullest_slice(image.grid, segmentation.labels, axis), .size = size};
    slices.push_back(picture_element(preview<Dim>(image, fields, options),
                                     "Slice across " + std::string(1, "xyz"[axis]) + " with the contour"));
  }
  return {"The contour on slices of the image", side_by_side(slices),
          "Slices across z, y and x, each where the area inside is largest.", true};
}

Figure surface(const Mesh& mesh, const std::string& unit) {
  SurfaceView view;
  view.mesh = mesh_to_show(mesh);
  view.unit = unit;
  if (!view.mesh.properties.empty()) {
    const Eigen::VectorXd& labels = view.mesh.properties.front().values;
    view.colors.push_back({"label", "Label of the region", 0, labels.maxCoeff(), false, labels});
  }
  view.caption = reduction_note(view.mesh, mesh);
  return surface_figure(view);
}

}  // namespace

template <int Dim>
void show(const Volume<float>& image, const std::vector<std::uint8_t>& mask, const Segmentation<Dim>& segmentation,
          const Json& measures, const std::function<Mesh()>& mesh, Page& page) {
  const SegmentReport& r = segmentation.report;
  const std::string unit = image.grid.space == Space::unknown ? "" : "mm";
  add_segment_facts(r, measures, Dim == 3, unit, page);
  page.figures.push_back(pictures<Dim>(image, segmentation));
  if constexpr (Dim == 3)
    if (measures["triangles"].template get<Index>() > 0) page.figures.push_back(surface(mesh(), unit));
  page.figures.push_back(intensities(image, mask, segmentation.labels, r));
  if (r.energy.size() > 1) page.figures.push_back(descent(r));
}

template void show(const Volume<float>&, const std::vector<std::uint8_t>&, const Segmentation<2>&, const Json&,
                   const std::function<Mesh()>&, Page&);
template void show(const Volume<float>&, const std::vector<std::uint8_t>&, const Segmentation<3>&, const Json&,
                   const std::function<Mesh()>&, Page&);

}  // namespace csrbf::app
