#include "report/surface_view.hpp"

#include "report/html.hpp"
#include "report/page_files.hpp"
#include "report/plots.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/implicit/render.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

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
  numbers.reserve(static_cast<std::size_t>(points.size()));
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
  Json scale = {{"name", colors.name}, {"title", colors.title}, {"map", colors.diverging ? "diverging" : "sequential"},
                {"lo", colors.lo},     {"hi", colors.hi},       {"values", bytes(colors.values, colors.lo, colors.hi)}};
  if (colors.point_values.size() > 0) scale["point_values"] = bytes(colors.point_values, colors.lo, colors.hi);
  return scale;
}

Json inside_data(const InsideValues& inside) {
  return {{"size", inside.size},       {"lo", inside.lo},
          {"hi", inside.hi},           {"title", inside.title},
          {"largest", inside.largest}, {"values", bytes(inside.values, inside.lo, inside.largest)}};
}

Json view_data(const SurfaceView& view) {
  const Box<3> box = bounding_box<3>(view.mesh.vertices);
  const auto coordinates = [](const Point<3>& p) { return Json{p.x(), p.y(), p.z()}; };
  Json data = {{"low", coordinates(box.lo)},
               {"high", coordinates(box.hi)},
               {"up", view.up},
               {"unit", view.unit},
               {"axes", view.axes},
               {"shown", view.shown},
               {"positions", positions(view.mesh.vertices, box)},
               {"normals", normals(view.mesh.normals)},
               {"triangles", triangles(view.mesh.triangles)},
               {"scales", Json::array()},
               {"colors", {{"sequential", color_stops(false)}, {"diverging", color_stops(true)}}}};
  for (const SurfaceColors& colors : view.colors) data["scales"].push_back(scale_data(colors));
  if (view.ranges)
    for (Index a = 0; a < 3; ++a) data["axis_ranges"].push_back({view.ranges->lo[a], view.ranges->hi[a]});
  if (view.points.cols() > 0) data["points"] = {{"positions", positions(view.points, box)}};
  if (view.lines.edges.cols() > 0 && view.lines.vertices.cols() <= SurfaceView::most_vertices) {
    const auto& edges = view.lines.edges;
    data["lines"] = {{"positions", positions(view.lines.vertices, box)},
                     {"edges", as_base64(std::vector<std::uint16_t>(edges.data(), edges.data() + edges.size()))}};
  }
  if (view.inside) data["inside"] = inside_data(*view.inside);
  return data;
}

// Which cube of a grid each point is in.
struct Clusters {
  std::vector<std::int32_t> of;  // for each point, from 0
  Index count = 0;
};

Clusters cluster(const Points<3>& points, double side) {
  constexpr std::int64_t most = (std::int64_t{1} << 21) - 1;  // of three numbers in 63 bits
  const Point<3> lo = bounding_box<3>(points).lo;
  std::vector<std::pair<std::int64_t, std::int32_t>> keys;
  keys.reserve(static_cast<std::size_t>(points.cols()));
  for (Index i = 0; i < points.cols(); ++i) {
    std::int64_t key = 0;
    for (Index a = 0; a < 3; ++a)
      key = (key << 21) | std::clamp<std::int64_t>(static_cast<std::int64_t>((points(a, i) - lo[a]) / side), 0, most);
    keys.emplace_back(key, static_cast<std::int32_t>(i));
  }
  std::sort(keys.begin(), keys.end());
  Clusters clusters{std::vector<std::int32_t>(keys.size())};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i > 0 && keys[i].first != keys[i - 1].first) ++clusters.count;
    clusters.of[keys[i].second] = static_cast<std::int32_t>(clusters.count);
  }
  ++clusters.count;
  return clusters;
}

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles.colwise()) {
    const Point<3> a = mesh.vertices.col(t[0]);
    sum += (mesh.vertices.col(t[1]) - a).cross(mesh.vertices.col(t[2]) - a).norm() / 2;
  }
  return sum;
}

// Means of those of the triangles around each vertex, weighted by their areas.
Points<3> vertex_normals(const Mesh& mesh) {
  Points<3> normals = Points<3>::Zero(3, mesh.vertices.cols());
  for (const auto& t : mesh.triangles.colwise()) {
    const Point<3> a = mesh.vertices.col(t[0]);
    const Point<3> n = (mesh.vertices.col(t[1]) - a).cross(mesh.vertices.col(t[2]) - a);
    for (const std::int32_t corner : t) normals.col(corner) += n;
  }
  normals.colwise().normalize();
  return normals;
}

// Means of positions, normals and values; the first value of labels.
Mesh clustered(const Mesh& mesh, const Clusters& clusters) {
  Mesh few;
  few.vertices = Points<3>::Zero(3, clusters.count);
  few.normals = Points<3>::Zero(3, mesh.normals.cols() > 0 ? clusters.count : 0);
  Eigen::VectorXd size = Eigen::VectorXd::Zero(clusters.count);
  for (const Property& p : mesh.properties) few.properties.push_back({p.name, p.type, Eigen::VectorXd(clusters.count)});
  for (Index i = 0; i < mesh.vertices.cols(); ++i) {
    const Index to = clusters.of[i];
    few.vertices.col(to) += mesh.vertices.col(i);
    if (few.normals.cols() > 0) few.normals.col(to) += mesh.normals.col(i);
    if (size[to]++ == 0)
      for (std::size_t p = 0; p < few.properties.size(); ++p)
        few.properties[p].values[to] = mesh.properties[p].values[i];
  }
  for (Index i = 0; i < clusters.count; ++i) few.vertices.col(i) /= size[i];
  few.normals.colwise().normalize();
  few.triangles.resize(3, mesh.triangles.cols());
  Index kept = 0;
  for (const auto& t : mesh.triangles.colwise()) {
    const std::int32_t a = clusters.of[t[0]], b = clusters.of[t[1]], c = clusters.of[t[2]];
    if (a != b && b != c && c != a) few.triangles.col(kept++) << a, b, c;
  }
  few.triangles.conservativeResize(3, kept);
  return few;
}

// Chosen by hand: more neighbours smooth more; a larger reach closes gaps in the data, a smaller one opens holes in it.
constexpr Index neighbors = 6;
constexpr double reach = 3;  // relative to the distance from the nearest point to its own neighbours

}  // namespace

bool has_interactive_view() {
  return !page_script.empty();
}

Mesh mesh_to_show(const Mesh& mesh) {
  const Index count = mesh.vertices.cols();
  if (mesh.normals.cols() != count) {
    Mesh with_normals = mesh;
    with_normals.normals = vertex_normals(mesh);
    return mesh_to_show(with_normals);
  }
  if (count <= SurfaceView::most_vertices) return mesh;
  // A surface of area A meets about 1.5 A / s^2 cubes of side s; where it meets more, larger cubes follow.
  constexpr double cubes = 1.6, larger = 1.12;
  double side = std::sqrt(cubes * area_of(mesh) / static_cast<double>(SurfaceView::most_vertices));
  for (;; side *= larger) {
    const Clusters clusters = cluster(mesh.vertices, side);
    if (clusters.count <= SurfaceView::most_vertices) return clustered(mesh, clusters);
  }
}

std::string reduction_note(const Mesh& shown, const Mesh& mesh) {
  if (shown.triangles.cols() == mesh.triangles.cols()) return "";
  return "Shown with " + counted(shown.triangles.cols(), "triangle") + "; the file has " +
         counted(mesh.triangles.cols(), "triangle") + ". ";
}

// Nodes around which all values are as large.
Index nodes_inside(const InsideValues& inside, double level) {
  const auto& n = inside.size;
  const auto is_large = [&](Index x, Index y, Index z) { return inside.values[x + n[0] * (y + n[1] * z)] >= level; };
  Index count = 0;
  for (Index z = 1; z + 1 < n[2]; ++z)
    for (Index y = 1; y + 1 < n[1]; ++y)
      for (Index x = 1; x + 1 < n[0]; ++x)
        count += is_large(x, y, z) && is_large(x - 1, y, z) && is_large(x + 1, y, z) && is_large(x, y - 1, z) &&
                         is_large(x, y + 1, z) && is_large(x, y, z - 1) && is_large(x, y, z + 1)
                     ? 1
                     : 0;
  return count;
}

InsideValues inside_values(const Field<3>& field, const Mesh& mesh, const std::string& title) {
  constexpr double nodes = 32;  // along the longest side: 33,000 values for a cube, in half a tenth of a second
  const Box<3> box = bounding_box<3>(mesh.vertices);
  InsideValues inside{.title = title};
  const double step = box.extent().maxCoeff() / (nodes - 1);
  GridAxes<3> axes;
  for (Index a = 0; a < 3; ++a) {
    inside.size[a] = std::max<Index>(2, 1 + std::lround(box.extent()[a] / step));
    axes[a] = Eigen::VectorXd::LinSpaced(inside.size[a], box.lo[a], box.hi[a]);
  }
  inside.values = field.evaluate_grid(axes);
  std::vector<double> positive;
  for (const double value : inside.values)
    if (value > 0) positive.push_back(value);
  if (positive.empty()) return inside;
  constexpr double most = 0.99;  // percentile of what is told
  inside.largest = inside.hi = percentile(positive, most);
  // Far from the samples f is constant. The way there follows the patches, not the shape: the scale ends before it.
  constexpr double level = 0.9, before = 0.75, least_share = 0.05;  // chosen by eye
  const auto flat = static_cast<double>(nodes_inside(inside, level * inside.hi));
  if (flat > least_share * static_cast<double>(positive.size())) inside.hi *= before;
  return inside;
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
  const auto squared_spacing = [&](Index point) {
    std::array<Index, neighbors> beside{};
    std::array<double, neighbors> squared{};
    return squared[tree.nearest(points.col(point), neighbors, beside.data(), squared.data()) - 1];
  };
  std::vector<double> spacing;  // where points are fewer than places: each once
  if (points.cols() < places.cols()) {
    spacing.resize(static_cast<std::size_t>(points.cols()));
    parallel_for(points.cols(), grain, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) spacing[i] = squared_spacing(i);
    });
  }
  parallel_for(places.cols(), grain, [&](Index begin, Index end) {
    std::array<Index, neighbors> near{};
    std::array<double, neighbors> squared{};
    for (Index i = begin; i < end; ++i) {
      const Index found = tree.nearest(places.col(i), neighbors, near.data(), squared.data());
      const double own = spacing.empty() ? squared_spacing(near[0]) : spacing[near[0]];
      if (squared[0] > reach * reach * own) continue;
      double sum = 0;
      for (Index k = 0; k < found; ++k) sum += values[near[k]];
      result[i] = sum / static_cast<double>(found);
    }
  });
  return result;
}

Figure surface_figure(const SurfaceView& view) {
  std::string body;
  if (has_interactive_view()) {
    body =
        "<p class=\"hint\">Drag to turn, drag with Shift or the right button to move, click and scroll to zoom. Two "
        "fingers turn it, too.</p><p class=\"why-still\"></p><noscript><p>Scripts are off: the surface is not "
        "shown.</p></noscript><script type=\"application/json\" class=\"surface-data\">" +
        script_text(view_data(view)) + "</script>";
  } else {
    RenderOptions options{.width = 800, .height = 500};
    options.view = {-65, 15};
    options.ground = Ground::none;
    body = "<div class=\"stage\">" + picture_element(render(view.mesh, options), "The surface, from above its front") +
           "</div><p class=\"why-still\">A still picture: this csrbf was built without three.js, which the interactive "
           "view needs.</p>";
  }
  return {view.title, "<figure class=\"surface\">" + body + "</figure>", view.caption, true};
}

}  // namespace csrbf::app
