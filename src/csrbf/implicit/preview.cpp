#include "csrbf/implicit/preview.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/implicit/plane_section.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

constexpr int largest_size = 16384;  // pixels along the longest side
constexpr int pixels_per_cell = 4;   // of a contour at most, so that its corners are invisible. Chosen by hand
constexpr std::array<RgbColor, 6> default_colors{
    {{255, 64, 64}, {255, 210, 63}, {63, 193, 255}, {110, 224, 110}, {255, 122, 217}, {255, 255, 255}}};

// A slice of an image: its two axes, and the number along the third.
struct Slice {
  const Grid& grid;
  std::array<int, 2> axes;
  int across;
  Index number;

  Slice(const Grid& g, int axis, Index n)
      : grid(g), axes{axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}, across(axis), number(n) {}

  [[nodiscard]] Index size(std::size_t k) const { return grid.size[axes[k]]; }
  [[nodiscard]] double spacing(std::size_t k) const { return grid.spacing[axes[k]]; }
  [[nodiscard]] Index voxel(Index u, Index v) const {
    std::array<Index, 3> at{};
    at[axes[0]] = u;
    at[axes[1]] = v;
    at[across] = number;
    return grid.index(at[0], at[1], at[2]);
  }
  // The field on the slice, in voxels.
  template <int Dim>
  [[nodiscard]] PlaneSection<Dim> section(const Field<Dim>& field) const {
    const auto map = grid.to_physical<Dim>();
    typename PlaneSection<Dim>::Across columns;
    for (Index k = 0; k < 2; ++k) columns.col(k) = map.linear().col(axes[k]);
    Point<Dim> origin = map.translation();
    if constexpr (Dim == 3) origin += static_cast<double>(number) * map.linear().col(across);
    const Point<2> half(0.5, 0.5), size2(static_cast<double>(size(0)), static_cast<double>(size(1)));
    return {field, origin, columns, {-half, size2 - half}};
  }
  // Whether axis k is shown from its end to its start. To the right: the patient's left, else back; downwards: back,
  // else feet.
  [[nodiscard]] bool reversed(std::size_t k) const {
    if (grid.space == Space::unknown) return k == 1 && axes[1] == 2;
    const Eigen::Matrix3d direction = in_space(grid, Space::left_posterior_superior).direction;
    Index main = 0;
    direction.col(axes[k]).cwiseAbs().maxCoeff(&main);
    const bool towards_positive = direction(main, axes[k]) > 0;
    return main == 2 && k == 1 ? towards_positive : !towards_positive;
  }
};

// Pixels per voxel along both axes of a slice.
std::array<double, 2> pixels_per_voxel(const Slice& slice, int size) {
  const double finest = std::min(slice.spacing(0), slice.spacing(1));
  std::array<double, 2> scale{slice.spacing(0) / finest, slice.spacing(1) / finest};
  const double longest =
      std::max(scale[0] * static_cast<double>(slice.size(0)), scale[1] * static_cast<double>(slice.size(1)));
  require(longest <= largest_size, "preview", "pixels along the longest side", longest, "must be at most 16384");
  const double enlargement = std::ceil(size / longest);
  for (double& s : scale) s *= enlargement;
  return scale;
}

// The values shown as black and white.
std::array<float, 2> window_of(const Volume<float>& image, const Slice& slice, const PreviewOptions& options) {
  const auto frame = image.frame(options.frame);
  const Index channels = image.components >= 3 ? 3 : 1;
  std::vector<float> values;
  for (Index v = 0; v < slice.size(1); ++v)
    for (Index u = 0; u < slice.size(0); ++u)
      for (Index c = 0; c < channels; ++c)
        if (const float value = frame(c, slice.voxel(u, v)); std::isfinite(value)) values.push_back(value);
  if (values.empty()) return {0, 1};
  const float black = percentile(values, options.window[0]), white = percentile(values, options.window[1]);
  if (black < white) return {black, white};
  // If few voxels differ from the rest, or none, the window is the whole range.
  const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
  return *lo < *hi ? std::array{*lo, *hi} : std::array{*lo - 1, *lo + 1};
}

RgbImage picture_of(const Volume<float>& image, const Slice& slice, const std::array<double, 2>& scale,
                    const PreviewOptions& options) {
  const auto [black, white] = window_of(image, slice, options);
  const auto pixels = [&](std::size_t k) {
    return std::max(1, static_cast<int>(std::lround(scale[k] * static_cast<double>(slice.size(k)))));
  };
  RgbImage picture(pixels(0), pixels(1));
  const auto frame = image.frame(options.frame);
  const auto voxel_at = [&](int pixel, std::size_t k) {
    const auto i = std::min(static_cast<Index>((pixel + 0.5) / scale[k]), slice.size(k) - 1);
    return slice.reversed(k) ? slice.size(k) - 1 - i : i;
  };
  std::uint8_t* out = picture.pixels.data();
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (Index c = 0; c < 3; ++c) {
        const float value = frame(image.components >= 3 ? c : 0, slice.voxel(voxel_at(x, 0), voxel_at(y, 1)));
        const float grey = (value - black) / (white - black);
        *out++ = std::isnan(grey) ? std::uint8_t{0}
                                  : static_cast<std::uint8_t>(std::lround(255 * std::clamp(grey, 0.0F, 1.0F)));
      }
  return picture;
}

// From voxels of the slice to pixels of the picture.
void to_pixels(const Slice& slice, const std::array<double, 2>& scale, ContourLines& contours) {
  for (std::size_t k = 0; k < 2; ++k) {
    auto row = contours.points.row(k).array();
    if (slice.reversed(k)) row = static_cast<double>(slice.size(k) - 1) - row;
    row = (row + 0.5) * scale[k];
  }
}

template <int Dim>
void check_preview(const Volume<float>& image, const PreviewOptions& options) {
  const Grid& grid = image.grid;
  require(grid.dimension() <= Dim, "preview", "axes of the image", grid.dimension(),
          "must be at most those of the field");
  require(options.axis >= 0 && options.axis < 3, "preview", "axis", options.axis, "must be 0, 1 or 2");
  require(options.slice >= -1 && options.slice < grid.size[options.axis], "preview", "slice", options.slice,
          "must be one of the " + std::to_string(grid.size[options.axis]) +
              " slices, from 0 on, or -1 for the one with the largest area inside");
  require(options.frame >= 0 && options.frame < image.frames, "preview", "frame", options.frame,
          "must be one of the " + std::to_string(image.frames) + " frames, from 0 on");
  require(options.size >= 1 && options.size <= largest_size, "preview", "size", options.size,
          "must be between 1 and 16384 pixels");
  require(options.window[0] >= 0 && options.window[0] < options.window[1] && options.window[1] <= 1, "preview",
          "window", std::to_string(options.window[0]) + " to " + std::to_string(options.window[1]),
          "must be two shares of the voxels, ascending, between 0 and 1");
}

}  // namespace

template <int Dim>
RgbImage preview(const Volume<float>& image, const std::vector<const Field<Dim>*>& fields,
                 const PreviewOptions& options) {
  check_preview<Dim>(image, options);
  const int axis = image.grid.dimension() == 3 ? options.axis : 2;
  const Index number = image.grid.dimension() < 3 ? 0
                       : options.slice >= 0       ? options.slice
                                                  : largest_slice<Dim>(image.grid, fields, axis, options.level);
  const Slice slice(image.grid, axis, number);
  const std::array<double, 2> scale = pixels_per_voxel(slice, options.size);
  RgbImage picture = picture_of(image, slice, scale, options);
  const Index voxels = std::max(slice.size(0), slice.size(1));
  const int pixels = std::max(picture.width, picture.height);
  const int cells = static_cast<int>(std::clamp<Index>(voxels, pixels / pixels_per_cell, largest_size));
  for (std::size_t i = 0; i < fields.size(); ++i) {
    ContourLines contours = contour_lines(slice.section(*fields[i]),
                                          {.resolution = cells, .level = options.level, .ends = ContourEnds::open});
    to_pixels(slice, scale, contours);
    const RgbColor& color =
        options.colors.empty() ? default_colors[i % default_colors.size()] : options.colors[i % options.colors.size()];
    draw_contour(contours, {color, options.line_width}, picture);
  }
  return picture;
}

template <int Dim>
Index largest_slice(const Grid& grid, const std::vector<const Field<Dim>*>& fields, int axis, double level) {
  constexpr Index points_per_side = 64;  // at which areas are estimated; chosen by hand
  require(axis >= 0 && axis < 3, "largest_slice", "axis", axis, "must be 0, 1 or 2");
  const Index slices = grid.size[axis];
  Index best = slices / 2, most = 0;
  for (Index number = 0; number < slices; ++number) {
    const Slice slice(grid, axis, number);
    GridAxes<2> axes;
    for (std::size_t k = 0; k < 2; ++k) {
      const double step = static_cast<double>(slice.size(k)) / points_per_side;
      axes[k] = (Eigen::ArrayXd::LinSpaced(points_per_side, 0.5, points_per_side - 0.5) * step - 0.5).matrix();
    }
    Eigen::Array<bool, Eigen::Dynamic, 1> inside =
        Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(axes[0].size() * axes[1].size(), false);
    for (const Field<Dim>* field : fields)
      inside = inside || slice.section(*field).evaluate_grid(axes).array() >= level;
    if (inside.count() <= most) continue;
    most = inside.count();
    best = number;
  }
  return best;
}

template RgbImage preview<2>(const Volume<float>&, const std::vector<const Field<2>*>&, const PreviewOptions&);
template RgbImage preview<3>(const Volume<float>&, const std::vector<const Field<3>*>&, const PreviewOptions&);
template Index largest_slice<2>(const Grid&, const std::vector<const Field<2>*>&, int, double);
template Index largest_slice<3>(const Grid&, const std::vector<const Field<3>*>&, int, double);

}  // namespace csrbf
