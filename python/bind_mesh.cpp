#include "mesh_arrays.hpp"
#include "picture.hpp"
#include "volume_layout.hpp"

#include "csrbf/implicit/compare.hpp"
#include "csrbf/implicit/render/color_map.hpp"
#include "csrbf/io/image.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/polylines.hpp"

#include <cmath>

namespace csrbf::python {
namespace {

py::dict mesh_to_dict(const Topology& t) {
  using namespace py::literals;
  return py::dict("components"_a = t.components, "watertight"_a = t.watertight(), "manifold"_a = t.manifold(),
                  "euler"_a = t.euler, "boundary_edges"_a = t.boundary_edges,
                  "nonmanifold_edges"_a = t.nonmanifold_edges, "nonmanifold_vertices"_a = t.nonmanifold_vertices,
                  "inconsistent_edges"_a = t.inconsistent_edges);
}

py::dict mesh_to_dict(const DistanceStatistics& d) {
  using namespace py::literals;
  return py::dict("mean"_a = d.mean, "rms"_a = d.rms, "p99"_a = d.p99, "max"_a = d.max);
}

py::dict with_topology(py::dict result, const Topology& topology) {
  for (const auto& [name, value] : mesh_to_dict(topology)) result[name] = value;
  return result;
}

py::dict compare_meshes(const py::tuple& first, const py::tuple& second, Index samples, std::uint64_t seed,
                        const py::object& listener) {
  using namespace py::literals;
  const Mesh mesh = mesh_from(first), reference = mesh_from(second);
  const MeshComparison found = run(listener, [&](const Progress& progress) {
    return compare(mesh, reference, {.samples = samples, .seed = seed, .progress = progress});
  });
  return with_topology(
      py::dict("chamfer_mean"_a = found.chamfer_mean, "hausdorff99"_a = found.hausdorff99,
               "normal_error_deg"_a = found.normal_error_deg, "accuracy"_a = mesh_to_dict(found.accuracy),
               "completeness"_a = mesh_to_dict(found.completeness), "diagonal"_a = found.diagonal),
      found.topology);
}

py::dict compare_points(const py::tuple& first, const py::tuple& second, const py::object& listener) {
  using namespace py::literals;
  const Mesh mesh = mesh_from(first);
  const PointCloud points = cloud_from(second);
  const PointComparison found =
      run(listener, [&](const Progress& progress) { return compare(mesh, points, {.progress = progress}); });
  return with_topology(py::dict("chamfer_mean"_a = found.distance.mean, "hausdorff99"_a = found.distance.p99,
                                "normal_error_deg"_a = found.normal_error_deg,
                                "distance"_a = mesh_to_dict(found.distance), "diagonal"_a = found.diagonal),
                       found.topology);
}

void write_picture(const std::string& path, const py::array_t<std::uint8_t, py::array::c_style>& pixels) {
  RgbImage picture(static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)));
  std::copy_n(pixels.data(), pixels.size(), picture.pixels.begin());
  run([&](const Progress& /*progress*/) { write_png(path, picture); });
}

// sRGB colours (n, 3) of values from 0 to 1.
py::array_t<std::uint8_t> color_map(const Array& given, bool diverging) {
  const auto values = vector(given, "values");
  py::array_t<std::uint8_t> colors({values.size(), Index{3}});
  std::uint8_t* out = colors.mutable_data();
  constexpr float most = 255;  // of 8 bits
  for (const double t : values) {
    const LinearRgb color = diverging ? diverging_color(2 * t - 1) : sequential_color(t);
    for (const float part : color) *out++ = static_cast<std::uint8_t>(std::lround(most * srgb_from_linear(part)));
  }
  return colors;
}

}  // namespace

void bind_mesh(py::module_& m) {
  m.def("read_mesh", [](const std::string& path) {
    Mesh mesh = run([&](const Progress& /*progress*/) { return read_mesh_or_points(path); });
    const char* space = space_name(mesh.space);
    return py::make_tuple(to_tuple(std::move(mesh)), space);
  });
  m.def("write_mesh", [](const std::string& path, const py::tuple& given, const std::string& space) {
    Mesh mesh = mesh_from(given);
    mesh.space = space_named(space);
    return run([&](const Progress& /*progress*/) { return write_mesh(path, mesh); });
  });
  m.def("topology", [](const py::tuple& given) {
    const Mesh mesh = mesh_from(given);
    return mesh_to_dict(run([&](const Progress& /*progress*/) { return topology(mesh); }));
  });
  m.def("compare_meshes", &compare_meshes);
  m.def("compare_points", &compare_points);
  m.def("render_mesh", [](const py::tuple& given, const py::dict& options, const std::optional<py::tuple>& reference,
                          const py::object& listener) {
    const Mesh mesh = mesh_from(given);
    const PictureOptions picture(options, reference);
    return to_array(run(listener, [&](const Progress& progress) { return render(mesh, picture.with(progress)); }));
  });
  m.def("write_picture", &write_picture);
  m.def("color_map", &color_map);
  m.def("write_polylines", [](const std::string& path, const py::tuple& given) {
    const Polylines lines = polylines_from(given);
    run([&](const Progress& /*progress*/) { write_polylines(path, lines); });
  });
}

}  // namespace csrbf::python
