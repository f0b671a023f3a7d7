#include "report/image_page.hpp"

#include "report/html.hpp"
#include "report/plots.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/implicit/preview.hpp"

#include <cmath>

namespace csrbf::app {
namespace {

constexpr int picture_size = 420;  // pixels: two side by side

Volume<float> single(const Volume<double>& image) {
  Volume<float> result(static_cast<const VolumeLayout&>(image));
  std::copy(image.values.begin(), image.values.end(), result.values.begin());
  return result;
}

// The slice with most of the marked voxels.
Index fullest_slice(const Grid& grid, const std::vector<unsigned char>& marked) {
  const Index slice = grid.size[0] * grid.size[1];
  Index best = 0, most = -1;
  for (Index z = 0; z < grid.size[2]; ++z) {
    const auto begin = marked.begin() + z * slice;
    const Index count = std::count_if(begin, begin + slice, [](unsigned char m) { return m != 0; });
    if (count > most) most = count, best = z;
  }
  return best;
}

std::string slice_picture(const Volume<float>& image, Index slice, const std::string& description) {
  const PreviewOptions options{.slice = slice, .size = picture_size};
  return "<figure>" +
         picture_element(image.grid.dimension() == 3 ? preview<3>(image, {}, options) : preview<2>(image, {}, options),
                         description) +
         "<p class=\"caption\">" + escaped(description) + "</p></figure>";
}

std::string in_columns(const std::vector<std::string>& pictures) {
  std::string text = "<div class=\"pictures\">";
  for (const std::string& picture : pictures) text += picture;
  return text + "</div>";
}

// Both, one of them, or the other; each pixel enlarged.
RgbImage agreement_picture(const Volume<float>& a, const Volume<float>& b, Index slice) {
  using Color = std::array<std::uint8_t, 3>;
  constexpr Color neither{24, 28, 34}, both{122, 150, 176}, only_a{240, 146, 76}, only_b{86, 170, 240},
      other{228, 92, 112};
  const auto& size = a.grid.size;
  const int factor = static_cast<int>(std::max<Index>(1, picture_size / std::max(size[0], size[1])));
  RgbImage picture(static_cast<int>(size[0]) * factor, static_cast<int>(size[1]) * factor);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const Index voxel = a.grid.index(x / factor, y / factor, slice);
      const float in_a = a.values[voxel], in_b = b.values[voxel];
      const Color& color = in_a == 0 && in_b == 0 ? neither
                           : in_a == in_b         ? both
                           : in_b == 0            ? only_a
                           : in_a == 0            ? only_b
                                                  : other;
      std::copy(color.begin(), color.end(), picture.pixels.begin() + 3 * (Index{y} * picture.width + x));
    }
  return picture;
}

}  // namespace

void show_filled(const Volume<double>& before, const Volume<double>& after, const std::vector<unsigned char>& missing,
                 Page& page) {
  if (before.grid.dimension() < 2) return;
  const Index slice = fullest_slice(before.grid, missing);
  Volume<float> holes = single(before);
  for (std::size_t i = 0; i < missing.size(); ++i)
    if (missing[i] != 0)
      for (Index c = 0; c < before.components; ++c)
        holes.values[i * static_cast<std::size_t>(before.components) + static_cast<std::size_t>(c)] =
            std::numeric_limits<float>::quiet_NaN();
  page.figures.push_back({"Before and after",
                          in_columns({slice_picture(holes, slice, "Missing pixels in black"),
                                      slice_picture(single(after), slice, "Filled")}),
                          before.grid.dimension() == 3 ? "The slice across z with most missing voxels." : "", true});
}

void show_agreement(const Volume<float>& a, const Volume<float>& b, Page& page) {
  if (a.grid.size != b.grid.size || a.components != 1 || b.components != 1) return;
  std::vector<unsigned char> differs(static_cast<std::size_t>(a.grid.voxels()));
  for (std::size_t i = 0; i < differs.size(); ++i) differs[i] = a.values[i] != b.values[i] ? 1 : 0;
  const Index slice = fullest_slice(a.grid, differs);
  page.figures.push_back(
      {"Where they agree",
       in_columns(
           {"<figure>" + picture_element(agreement_picture(a, b, slice), "Labels of both images") + "</figure>"}),
       "Grey-blue: the same label in both; orange: only in the first; blue: only in the second; red: different "
       "labels." +
           std::string(a.grid.dimension() == 3 ? " The slice across z with most differences." : ""),
       true});
}

void show_values(const Eigen::Ref<const Eigen::RowVectorXd>& values, const std::vector<Eigen::VectorXd>& axes,
                 const std::vector<std::string>& axis_names, const std::string& value_name, Page& page,
                 const Points<2>& segments) {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  extend(values.transpose(), lo, hi);
  if (!(lo <= hi)) return;
  if (!(lo < hi)) lo -= 1, hi += 1;
  if (axes.size() == 1 && axes[0].size() > 1) {
    Curve curve{.x_label = axis_names[0], .y_label = value_name};
    curve.line.resize(2, values.size());
    curve.line << axes[0].transpose(), values;
    page.figures.push_back({"Values", draw(curve), ""});
  } else if (axes.size() == 2 && axes[0].size() > 1 && axes[1].size() > 1) {
    constexpr Index most = 400;  // nodes along an axis: pixels of the picture
    const auto few = [&](Index n) {
      return Eigen::VectorXd::LinSpaced(std::min(n, most), 0, static_cast<double>(n - 1));
    };
    const Eigen::VectorXd columns = few(axes[0].size()), rows = few(axes[1].size());
    PlaneMap map{.values = Eigen::MatrixXd(rows.size(), columns.size()),
                 .x_label = axis_names[0],
                 .y_label = axis_names[1],
                 .scale = {lo, hi, false, value_name},
                 .segments = segments,
                 .description = value_name + " by " + axis_names[0] + " and " + axis_names[1]};
    for (Index j = 0; j < rows.size(); ++j)
      for (Index i = 0; i < columns.size(); ++i)
        map.values(j, i) = values[std::lround(columns[i]) + axes[0].size() * std::lround(rows[j])];
    map.box.lo << axes[0].minCoeff(), axes[1].minCoeff();
    map.box.hi << axes[0].maxCoeff(), axes[1].maxCoeff();
    const Point<2> extent = map.box.extent();
    constexpr double ratio = 3;  // of extents, from which axes have different units
    map.to_scale = extent.x() < ratio * extent.y() && extent.y() < ratio * extent.x();
    page.figures.push_back({"Values", draw(map), ""});
  }
  page.figures.push_back(
      {"Distribution of the values",
       draw(Histogram{
           .values = {values.begin(), values.end()}, .lo = lo, .hi = hi, .label = value_name, .counted = "places"}),
       ""});
}

void show_track(const std::vector<TrackedMeasure>& measures, const std::string& size_name,
                const std::map<Index, RgbImage>& frames, Page& page) {
  const auto [least, most] = [&] {
    std::pair<double, double> range{std::numeric_limits<double>::infinity(), 0};
    for (const TrackedMeasure& measure : measures)
      if (measure.label == 1)
        for (const double size : measure.sizes) range = {std::min(range.first, size), std::max(range.second, size)};
    return range;
  }();
  if (least <= most)
    page.facts = {{std::to_string(measures.front().sizes.size()), "frames"},
                  {readable(least, 4), "smallest " + size_name + " of label 1"},
                  {readable(most, 4), "largest " + size_name + " of label 1"}};
  if (!frames.empty()) {
    std::string pictures = "<div class=\"pictures series\">";
    for (const auto& [number, frame] : frames)
      pictures += "<figure data-frame=\"" + std::to_string(number) + "\">" +
                  picture_element(frame, "Frame " + std::to_string(number) + " with the contour") + "</figure>";
    page.figures.push_back({"Frames with their contours", pictures + "</div>", ""});
  }
  for (const TrackedMeasure& measure : measures)
    if (measure.sizes.size() > 1)
      page.figures.push_back({"Label " + std::to_string(measure.label) + " over time",
                              draw(Course{.values = measure.sizes, .label = size_name, .counted = "frame"}), ""});
}

}  // namespace csrbf::app
