#include "picture.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/implicit/combine.hpp"
#include "csrbf/implicit/curvature.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/raycast.hpp"
#include "csrbf/implicit/ridges.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/models/surface_archive.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/surface/reconstruct_contours.hpp"
#include "csrbf/surface/trim.hpp"
#include "csrbf/tiles/reconstruct_tiles.hpp"

#include <memory>
#include <optional>

namespace csrbf::python {
namespace {

// A field and, when it was made from points, those that the mesh is checked against.
struct Surface {
  std::shared_ptr<const Field<3>> field;
  Points<3> points{3, 0};
  Points<3> normals{3, 0};
};

py::dict reconstruction_to_dict(const ReconstructReport& r) {
  using namespace py::literals;
  const CompositeReport composite = r.composite.value_or(CompositeReport{});
  const ContoursReport contours = r.contours.value_or(ContoursReport{});
  return py::dict("method"_a = r.method, "normals"_a = name_of(r.normals), "points"_a = r.points,
                  "points_used"_a = r.points_used, "centers"_a = r.centers, "patches"_a = composite.patches,
                  "levels"_a = composite.levels, "smoothing"_a = r.smoothing, "contours"_a = contours.contours,
                  "slices"_a = contours.slices, "caps"_a = contours.caps,
                  "cross_validation_error"_a = composite.cross_validation_error, "rms_distance"_a = r.rms_distance,
                  "p99_distance"_a = r.p99_distance, "max_distance"_a = r.max_distance,
                  "prepare_seconds"_a = r.prepare_seconds, "fit_seconds"_a = r.fit_seconds,
                  "evaluate_seconds"_a = r.evaluate_seconds, "warnings"_a = r.warnings);
}

py::dict reconstruct_in_tiles(const std::string& points, const std::string& mesh, const std::string& folder, Index rank,
                              Index count, const py::dict& given, const py::object& listener) {
  using namespace py::literals;
  TileOptions options;
  options.folder = folder;
  read_entry(given, "tile_points", options.tile_points);
  read_entry(given, "memory", options.memory);
  read_entry(given, "smoothing", options.surface.smoothing);
  read_entry(given, "resolution", options.resolution);
  read_entry(given, "model", options.model);
  if (given.contains("normals"))
    options.surface.normals = given["normals"].cast<std::string>() == "file" ? Normals::file : Normals::estimate;
  if (given.contains("sharp"))
    options.mesh_method =
        given["sharp"].cast<bool>() ? PolygonizeMethod::dual_contouring : PolygonizeMethod::marching_cubes;
  options.share = {rank, count};
  const TileReport report = run(listener, [&](const Progress& progress) {
    options.surface.progress = progress;
    return reconstruct_tiles(points, mesh, options);
  });
  py::dict result = reconstruction_to_dict(report.surface);
  result["tiles"] = report.tiles;
  result["tile_points"] = report.tile_points;
  result["tiles_continued"] = report.continued;
  result["tiles_meshed_again"] = report.meshed_again;
  result["resolution"] = report.resolution;
  result["vertices"] = report.topology.vertices;
  result["triangles"] = report.topology.triangles;
  result["components"] = report.topology.components;
  result["watertight"] = report.topology.watertight();
  result["euler"] = report.topology.euler;
  result["weak_features"] = report.weak_features;
  return result;
}

py::tuple reconstruct_arrays(const Array& given, const std::optional<Array>& normals, const std::string& method,
                             Index centers, double tolerance, std::optional<double> smoothing,
                             const py::object& listener) {
  PointCloud cloud;
  cloud.points = points<3>(given, "points");
  if (normals) {
    cloud.normals = points<3>(*normals, "normals");
    require(cloud.has_normals(), "reconstruct", "normals", cloud.normals.cols(), "there must be one for each point");
  }
  ReconstructReport report;
  auto surface = run(listener, [&](const Progress& progress) {
    Reconstruction found = reconstruct(
        cloud,
        {.method = method, .centers = centers, .tolerance = tolerance, .smoothing = smoothing, .progress = progress});
    report = std::move(found.report);
    return std::make_unique<Surface>(
        Surface{found.field, cloud.points(Eigen::all, found.source), std::move(found.normals)});
  });
  return py::make_tuple(std::move(surface), reconstruction_to_dict(report));
}

// `sizes`: the numbers of points of the closed curves.
py::tuple reconstruct_contours_arrays(const Array& given, const std::vector<Index>& sizes, Index centers,
                                      std::optional<double> smoothing, const py::object& listener) {
  Polylines contours;
  contours.vertices = points<3>(given, "contours");
  contours.edges.resize(2, contours.vertices.cols());
  Index first = 0;
  for (const Index size : sizes) {
    for (Index i = 0; i < size; ++i)
      contours.edges.col(first + i) << static_cast<std::int32_t>(first + i),
          static_cast<std::int32_t>(first + (i + 1) % size);
    first += size;
  }
  ReconstructReport report;
  auto surface = run(listener, [&](const Progress& progress) {
    Reconstruction found =
        reconstruct_contours(contours, {.centers = centers, .smoothing = smoothing, .progress = progress});
    report = std::move(found.report);
    return std::make_unique<Surface>(
        Surface{found.field, contours.vertices(Eigen::all, found.source), std::move(found.normals)});
  });
  return py::make_tuple(std::move(surface), reconstruction_to_dict(report));
}

// Value, and gradient when asked for.
py::tuple evaluate_surface(const Surface& surface, const Array& at, bool with_gradient) {
  const auto x = points<3>(at, "x");
  const Index m = x.cols();
  py::array_t<double> value(m);
  py::array_t<double> gradient({with_gradient ? m : 0, Index{3}});
  double* const to_value = value.mutable_data();
  double* const to_gradient = gradient.mutable_data();
  run([&](const Progress& progress) {
    in_parts(m, progress, [&](Index begin, Index count) {
      const Jet<3> jet = surface.field->evaluate(x.middleCols(begin, count),
                                                 with_gradient ? Derivatives::gradient : Derivatives::none);
      std::copy_n(jet.value.data(), count, to_value + begin);
      std::copy_n(jet.gradient.data(), jet.gradient.size(), to_gradient + 3 * begin);
    });
  });
  return py::make_tuple(value, gradient);
}

// k1, k2 and their directions.
py::tuple curvature_arrays(const Surface& surface, const Array& at) {
  const auto x = points<3>(at, "x");
  Curvatures found = run([&](const Progress& progress) { return curvature(*surface.field, x, progress); });
  return py::make_tuple(py::array_t<double>(found.k1.size(), found.k1.data()),
                        py::array_t<double>(found.k2.size(), found.k2.data()), to_array(std::move(found.direction1)),
                        to_array(std::move(found.direction2)));
}

// Distances and normals.
py::tuple raycast_arrays(const Surface& surface, const Array& origins, const Array& directions, int resolution) {
  const auto from = points<3>(origins, "origins"), along = points<3>(directions, "directions");
  RayHits hits = run([&](const Progress& progress) {
    return raycast(*surface.field, from, along, {.resolution = resolution, .progress = progress});
  });
  return py::make_tuple(py::array_t<double>(hits.t.size(), hits.t.data()), to_array(std::move(hits.normals)));
}

py::tuple polygonize_arrays(const Surface& surface, int resolution, double level, const std::string& method,
                            double tolerance, std::optional<double> persistence, bool refine,
                            std::optional<double> trim_distance, const py::object& listener) {
  const std::optional<PolygonizeMethod> wanted =
      method == "auto" ? mesh_method(*surface.field) : polygonize_method_named(method);
  require(wanted.has_value(), "polygonize", "method", method,
          "must be auto, marching-cubes, marching-tetrahedra, dual-contouring or adaptive");
  require(!trim_distance || surface.points.cols() > 0, "polygonize", "trim", trim_distance.value_or(0),
          "only surfaces made from points can be trimmed; combined ones and those from files have no points");
  DataComponents kept = run(listener, [&](const Progress& progress) -> DataComponents {
    Mesh found = polygonize(*surface.field, {.resolution = resolution,
                                             .method = *wanted,
                                             .tolerance = tolerance,
                                             .level = level,
                                             .persistence = persistence,
                                             .refine = refine,
                                             .progress = progress});
    if (trim_distance) found = trim(found, surface.points, *trim_distance, surface.normals);
    if (surface.points.cols() == 0) return {std::move(found)};
    return keep_components_with_data(std::move(found), surface.points);
  });
  if (!kept.warning.empty() && PyErr_WarnEx(PyExc_UserWarning, kept.warning.c_str(), 2) < 0)
    throw py::error_already_set();
  return to_tuple(std::move(kept.mesh));
}

std::unique_ptr<Surface> combine_surfaces(const std::string& operation, const std::vector<const Surface*>& surfaces,
                                          const std::string& blending, double radius, double sharpness,
                                          const py::object& listener) {
  const std::optional<Operation> wanted = operation_named(operation);
  require(wanted.has_value(), "combine", "operation", operation,
          "must be union, intersection, difference, complement or blend");
  const std::optional<Blending> form = blending_named(blending);
  require(form.has_value(), "combine", "blending", blending,
          "must be sharp, r-function, super-elliptic or log-sum-exp");
  std::vector<Solid> solids;
  for (const Surface* surface : surfaces) solids.push_back(surface->field);
  return run(listener, [&](const Progress& progress) {
    return std::make_unique<Surface>(Surface{
        combine(*wanted, solids, {.blending = *form, .radius = radius, .sharpness = sharpness, .progress = progress})});
  });
}

py::bytes surface_to_bytes(const Surface& s) {
  return py::bytes(run([&](const Progress& /*progress*/) { return format_archive(surface_to_archive(*s.field)); }));
}

std::unique_ptr<Surface> surface_from_bytes(const std::string& bytes, const Array& given, const Array& normals) {
  const auto x = points<3>(given, "points"), n = points<3>(normals, "normals");
  return run([&](const Progress& /*progress*/) {
    return std::make_unique<Surface>(Surface{surface_from(parse_archive(bytes, "pickle")), x, n});
  });
}

}  // namespace

void bind_surface(py::module_& m) {
  py::class_<Surface>(m, "Surface")
      .def_property_readonly("bounds",
                             [](const Surface& s) {
                               const Box<3> box = s.field->bounds();
                               Points<3> corners(3, 2);
                               corners << box.lo, box.hi;
                               return to_array(std::move(corners));
                             })
      .def_property_readonly("points", [](const Surface& s) { return to_array(Points<3>(s.points)); })
      .def_property_readonly("normals", [](const Surface& s) { return to_array(Points<3>(s.normals)); })
      .def("evaluate", &evaluate_surface)
      .def("curvature", &curvature_arrays)
      .def("polygonize", &polygonize_arrays)
      .def("raycast", &raycast_arrays)
      .def(
          "ridges",
          [](const Surface& s, const py::tuple& given, double level, double least_turning, const py::object& listener) {
            const Mesh mesh = mesh_from(given);
            return to_tuple(run(listener, [&](const Progress& progress) {
              return ridges(*s.field, mesh, {.level = level, .least_turning = least_turning, .progress = progress});
            }));
          })
      .def("render",
           [](const Surface& s, const py::dict& given, const std::optional<py::tuple>& reference,
              const py::object& listener) {
             const PictureOptions picture(given, reference);
             return to_array(
                 run(listener, [&](const Progress& progress) { return render(*s.field, picture.with(progress)); }));
           })
      .def("save",
           [](const Surface& s, const std::string& path) {
             run([&](const Progress& /*progress*/) { write_model(path, *s.field); });
           })
      .def("to_bytes", &surface_to_bytes)
      .def_static("from_bytes", &surface_from_bytes);
  m.def("reconstruct", &reconstruct_arrays);
  m.def("reconstruct_tiles", &reconstruct_in_tiles);
  m.def("reconstruct_contours", &reconstruct_contours_arrays);
  m.def("combine", &combine_surfaces);
  m.def("surface_of", [](const NamedFunction& f) {
    require(f.function.dimension() == 3 && f.function.components() == 1, "to_surface", "variables",
            f.function.dimension(), "only functions of three variables with one value have surfaces f = 0");
    return std::make_unique<Surface>(Surface{f.function.fit<3>().components.front()});
  });
  m.def("read_surface", [](const std::string& path) {
    return run([&](const Progress& /*progress*/) { return std::make_unique<Surface>(Surface{read_model(path)}); });
  });
}

}  // namespace csrbf::python
