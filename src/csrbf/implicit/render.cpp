#include "csrbf/implicit/render.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/render/field_scene.hpp"
#include "csrbf/implicit/render/mesh_scene.hpp"
#include "csrbf/implicit/render/render_tile.hpp"

namespace csrbf {
namespace {

constexpr int tile_size = 64;          // pixels; larger: less overlap of light samples, more memory
constexpr Index tiles_per_thread = 4;  // between two progress reports, at which the work can be stopped

void check(const RenderOptions& options) {
  constexpr const char* f = "render";
  constexpr int largest_size = 32768;
  require(options.width >= 1 && options.width <= largest_size, f, "width", options.width, "must be in [1, 32768]");
  require(options.height >= 1 && options.height <= largest_size, f, "height", options.height, "must be in [1, 32768]");
  require(std::isfinite(options.view[0]), f, "azimuth", options.view[0], "must be finite");
  require(std::abs(options.view[1]) <= 90, f, "elevation", options.view[1], "must be in [-90, 90] degrees");
  require(options.field_of_view >= 0 && options.field_of_view <= 150, f, "field_of_view", options.field_of_view,
          "must be in [0, 150] degrees");
  require(options.margin >= 0 && options.margin < 0.5, f, "margin", options.margin, "must be in [0, 0.5)");
  require(options.color_limit >= 0 && std::isfinite(options.color_limit), f, "color_limit", options.color_limit,
          "must be positive, or 0 to choose it from the surface");
  require(options.samples >= 1 && options.samples <= 8, f, "samples", options.samples, "must be in [1, 8]");
  require(options.occlusion_rays >= 0 && options.occlusion_rays <= 1024, f, "occlusion_rays", options.occlusion_rays,
          "must be in [0, 1024]");
  require(options.field_resolution >= 4 && options.field_resolution <= 1024, f, "field_resolution",
          options.field_resolution, "must be in [4, 1024]");
  for (const Rgb& color : {options.material, options.background})
    for (const float channel : color)
      require(channel >= 0 && channel <= 1, f, "color component", channel, "must be in [0, 1]");
  const Box<3>& frame = options.frame;
  const bool usable = (frame.lo.allFinite() && frame.hi.allFinite() && frame.diagonal() > 0) || frame.empty();
  require(usable, f, "diagonal of frame", frame.diagonal(), "must be positive and finite; or leave the frame empty");
}

Points<3> corners(const Box<3>& box) {
  Points<3> points(3, 8);
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 3; ++k) points(k, i) = (i >> k) & 1 ? box.hi[k] : box.lo[k];
  return points;
}

// Values of the displayed quantity at about 20000 rays across the picture.
std::vector<double> visible_values(const Scene& scene, const Camera& camera, const SurfaceColor& color) {
  const double step = std::max(1.0, std::sqrt(camera.width * camera.height / 20000));
  std::vector<Ray> rays;
  for (double y = 0.5 * step; y < camera.height; y += step)
    for (double x = 0.5 * step; x < camera.width; x += step) rays.push_back(camera.ray(x, y));
  std::vector<double> values(rays.size(), std::numeric_limits<double>::quiet_NaN());
  constexpr Index grain = 512;
  parallel_for(std::ssize(rays), grain, [&](Index begin, Index end) {
    std::vector<SurfaceHit> hits(end - begin);
    scene.trace(std::span(rays).subspan(begin, hits.size()), hits);
    for (Index i = begin; i < end; ++i)
      if (hits[i - begin].exists()) values[i] = color.value(hits[i - begin]);
  });
  std::erase_if(values, [](double value) { return std::isnan(value); });
  return values;
}

RgbImage render_scene(const Scene& scene, const RenderOptions& options) {
  const Box<3> box = bounding_box<3>(scene.outline());
  const Camera camera = frame_points(options.frame.empty() ? scene.outline() : corners(options.frame), options);
  SurfaceColor color(options, box.diagonal());
  if (color.has_scale()) color.set_scale(visible_values(scene, camera, color));
  const Studio studio(scene, options, color, camera, box);

  RgbImage image(options.width, options.height);
  const int across = (options.width + tile_size - 1) / tile_size, down = (options.height + tile_size - 1) / tile_size;
  const Index tiles = static_cast<Index>(across) * down, tiles_at_once = tiles_per_thread * thread_count();
  for (Index first = 0; first < tiles; first += tiles_at_once) {
    report(options.progress, "render", static_cast<double>(first) / static_cast<double>(tiles));
    parallel_for(std::min(tiles_at_once, tiles - first), 1, [&](Index begin, Index end) {
      for (Index i = first + begin; i < first + end; ++i) {
        const int x = static_cast<int>(i % across) * tile_size, y = static_cast<int>(i / across) * tile_size;
        render_tile(studio, {x, std::min(x + tile_size, options.width), y, std::min(y + tile_size, options.height)},
                    image);
      }
    });
  }
  report(options.progress, "render", 1);
  return image;
}

}  // namespace

RgbImage render(const Mesh& mesh, const RenderOptions& options) {
  check(options);
  report(options.progress, "render", 0);
  return render_scene(MeshScene(mesh, options), options);
}

RgbImage render(const Field<3>& field, const RenderOptions& options) {
  check(options);
  report(options.progress, "render", 0);
  return render_scene(FieldScene(field, options), options);
}

}  // namespace csrbf
