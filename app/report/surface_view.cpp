#include "report/surface_view.hpp"

#include "report/html.hpp"
#include "report/page_files.hpp"
#include "report/plots.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/implicit/render.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <array>
#include <bit>
#include <cmath>

namespace csrbf::app {
namespace {

static_assert(std::endian::native == std::endian::little, "the page takes little-endian numbers");

template <class Number>
std::string as_base64(const std::vector<Number>& numbers) {
  return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)});
}

// Fractions of the box in 16 bits.
std::string positions(const Points<3>& points, const Box<3>& box) {
  constexpr double most = 65535;  // of 16 bits
  const Point<3> extent = box.extent();
  std::vector<std::uint16_t> numbers;
  for (Index i = 0; i < points.cols(); ++i)
    for (Index a = 0; a < 3; ++a) {
      const double part = extent[a] > 0 ? (points(a, i) - box.lo[a]) / extent[a] : 0.5;
      numbers.push_back(static_cast<std::uint16_t>(std::lround(most * std::clamp(part, 0.0, 1.0))));
    }
  return as_base64(numbers);
}

std::string normals(const Points<3>& vectors) {
  constexpr double most = 127;  // of 8 bits with sign
  std::vector<std::int8_t> numbers;
  for (Index i = 0; i < vectors.cols(); ++i)
    for (Index a = 0; a < 3; ++a)
      numbers.push_back(static_cast<std::int8_t>(std::lround(most * std::clamp(vectors(a, i), -1.0, 1.0))));
  return as_base64(numbers);
}

std::string triangles(const Triangles& corners) {
  return as_base64(std::vector<std::uint16_t>(corners.data(), corners.data() + corners.size()));
}

// 0 to 254 along the scale, 255 where there is no value.
std::string bytes(const Eigen::VectorXd& values, double lo, double hi) {
  constexpr double most = 254;  // of 8 bits, without 255
  std::vector<std::uint8_t> numbers;
  for (const double value : values) {
    const double part = hi > lo ? std::clamp((value - lo) / (hi - lo), 0.0, 1.0) : 0.5;
    numbers.push_back(std::isfinite(value) ? static_cast<std::uint8_t>(std::lround(most * part)) : std::uint8_t{255});
  }
  return as_base64(numbers);
}

Json scale_data(const SurfaceColors& colors) {
  Json scale = {{"name", colors.name},
                {"title", colors.title},
                {"map", colors.diverging ? "diverging" : "sequential"},
                {"values", bytes(colors.values, colors.lo, colors.hi)}};
  for (const double value : {colors.lo, 0.5 * (colors.lo + colors.hi), colors.hi})
    scale["ticks"].push_back(readable(value, 2));
  if (colors.point_values.size() > 0) scale["point_values"] = bytes(colors.point_values, colors.lo, colors.hi);
  return scale;
}

Json view_data(const SurfaceView& view) {
  Box<3> box = bounding_box<3>(view.mesh.vertices);
  const auto coordinates = [](const Point<3>& p) { return Json{p.x(), p.y(), p.z()}; };
  Json data = {{"low", coordinates(box.lo)},
               {"high", coordinates(box.hi)},
               {"up", "z"},
               {"shown", view.shown},
               {"positions", positions(view.mesh.vertices, box)},
               {"normals", normals(view.mesh.normals)},
               {"triangles", triangles(view.mesh.triangles)},
               {"scales", Json::array()},
               {"colors", {{"sequential", color_stops(false)}, {"diverging", color_stops(true)}}}};
  for (const SurfaceColors& colors : view.colors) data["scales"].push_back(scale_data(colors));
  if (view.points.cols() > 0) data["points"] = {{"positions", positions(view.points, box)}};
  return data;
}

// Chosen by hand: more neighbours smooth more; a larger reach closes gaps in the data, a smaller one opens holes in it.
constexpr Index neighbors = 6;
constexpr double reach = 3;  // relative to the distance from the nearest point to its own neighbours

}  // namespace

bool has_interactive_view() {
  return !page_script.empty();
}

Mesh mesh_to_show(const Mesh& mesh, int resolution, const std::function<Mesh(int)>& coarser) {
  Mesh shown = mesh;
  while (shown.vertices.cols() > SurfaceView::most_vertices) {
    // The number of vertices grows with the square of the resolution; 0.97 makes one step almost always enough.
    constexpr double safety = 0.97;
    const double vertices = static_cast<double>(shown.vertices.cols());
    resolution = std::max(1, static_cast<int>(safety * resolution *
                                              std::sqrt(static_cast<double>(SurfaceView::most_vertices) / vertices)));
    shown = coarser(resolution);
  }
  return shown;
}

std::vector<Index> spread_indices(Index n, Index most) {
  const Index count = std::min(n, most);
  std::vector<Index> indices;
  indices.reserve(count);
  for (Index i = 0; i < count; ++i) indices.push_back(i * n / count);
  return indices;
}

std::vector<Index> spread(const std::vector<Index>& indices, Index most) {
  std::vector<Index> kept;
  for (const Index i : spread_indices(std::ssize(indices), most)) kept.push_back(indices[i]);
  return kept;
}

Eigen::VectorXd values_near(const PointsRef<3>& points, const Eigen::VectorXd& values, const PointsRef<3>& places) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd result = Eigen::VectorXd::Constant(places.cols(), none);
  if (points.cols() == 0) return result;
  const KdTree<3> tree(points);
  constexpr Index grain = 256;  // places per task: larger balances worse, smaller costs overhead
  parallel_for(places.cols(), grain, [&](Index begin, Index end) {
    std::array<Index, neighbors> near{}, beside{};
    std::array<double, neighbors> squared{}, spacing{};
    for (Index i = begin; i < end; ++i) {
      const Index found = tree.nearest(places.col(i), neighbors, near.data(), squared.data());
      const Index around = tree.nearest(points.col(near[0]), neighbors, beside.data(), spacing.data());
      if (squared[0] > reach * reach * spacing[around - 1]) continue;
      double sum = 0;
      for (Index k = 0; k < found; ++k) sum += values[near[k]];
      result[i] = sum / static_cast<double>(found);
    }
  });
  return result;
}

Figure surface_figure(const SurfaceView& view) {
  RenderOptions options{.width = 800, .height = 500};
  options.view = {-65, 15};
  options.ground = Ground::none;
  constexpr int few_rays = 2;  // the picture is only seen until the viewer starts
  if (has_interactive_view()) options.occlusion_rays = few_rays;
  const std::string still = picture_element(render(view.mesh, options), "The surface, from above its front");
  std::string body = "<div class=\"stage\">" + still;
  if (has_interactive_view())
    body +=
        "<canvas tabindex=\"0\" role=\"img\" aria-label=\"The surface. Arrow keys turn it, with Shift they move it; "
        "plus and minus zoom, 0 resets the view.\"></canvas></div><div class=\"controls\"></div>"
        "<p class=\"hint\">Drag to turn, drag with Shift or the right button to move, click and scroll to zoom. Keys: "
        "arrows, Shift, + and −, 0.</p>"
        "<p class=\"why-still\"></p><noscript><p>Scripts are off, so this is a still picture.</p></noscript>"
        "<script type=\"application/json\" class=\"surface-data\">" +
        script_text(view_data(view)) + "</script>";
  else
    body +=
        "</div><p class=\"why-still\">A still picture: this csrbf was built without three.js, which the interactive "
        "view needs.</p>";
  return {"The surface", "<figure class=\"surface\">" + body + "</figure>", view.caption, true};
}

}  // namespace csrbf::app
