#include "bindings.hpp"

#include "csrbf/implicit/combine.hpp"
#include "csrbf/implicit/curvature.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/implicit/raycast.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/surface/reconstruct_contours.hpp"
#include "csrbf/surface/trim.hpp"

#include <memory>
#include <optional>

namespace csrbf::python {
namespace {

// A field and, where it was made from points, what the mesh is checked against.
struct Surface {
  std::shared_ptr<const Field<3>> field;
  Points<3> points{3, 0};
};

py::dict to_dict(const ReconstructReport& r) {
  using namespace py::literals;
  return py::dict(
      "method"_a = r.method, "normals"_a = r.normals, "points"_a = r.points, "points_used"_a = r.points_used,
      "centers"_a = r.centers, "patches"_a = r.patches, "levels"_a = r.levels, "smoothing"_a = r.smoothing,
      "contours"_a = r.contours, "slices"_a = r.slices, "lids"_a = r.lids,
      "cross_validation_error"_a = r.cross_validation_error, "rms_distance"_a = r.rms_distance,
      "p99_distance"_a = r.p99_distance, "max_distance"_a = r.max_distance, "prepare_seconds"_a = r.prepare_seconds,
      "fit_seconds"_a = r.fit_seconds, "evaluate_seconds"_a = r.evaluate_seconds, "warnings"_a = r.warnings);
}

py::tuple reconstruct_arrays(const Array& given, const std::optional<Array>& normals, const std::string& method,
                             Index centers, double tolerance, std::optional<double> smoothing) {
  PointCloud cloud;
  cloud.points = points<3>(given, "points");
  if (normals) {
    cloud.normals = points<3>(*normals, "normals");
    require(cloud.has_normals(), "reconstruct", "normals", cloud.normals.cols(), "there must be one for each point");
  }
  ReconstructReport report;
  auto surface = run([&](const Progress& progress) {
    Reconstruction found = reconstruct(
        cloud,
        {.method = method, .centers = centers, .tolerance = tolerance, .smoothing = smoothing, .progress = progress});
    report = std::move(found.report);
    return std::make_unique<Surface>(Surface{found.field, cloud.points(Eigen::all, found.source)});
  });
  return py::make_tuple(std::move(surface), to_dict(report));
}

// `sizes`: the numbers of points of the closed curves.
py::tuple reconstruct_contours_arrays(const Array& given, const std::vector<Index>& sizes, Index centers,
                                      std::optional<double> smoothing) {
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
  auto surface = run([&](const Progress& progress) {
    Reconstruction found =
        reconstruct_contours(contours, {.centers = centers, .smoothing = smoothing, .progress = progress});
    report = std::move(found.report);
    return std::make_unique<Surface>(Surface{found.field, contours.vertices(Eigen::all, found.source)});
  });
  return py::make_tuple(std::move(surface), to_dict(report));
}

// Value, and gradient when asked for.
py::tuple evaluate(const Surface& surface, const Array& at, bool with_gradient) {
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
                            double tolerance) {
  const std::optional<PolygonizeMethod> wanted = polygonize_method_named(method);
  require(wanted.has_value(), "polygonize", "method", method,
          "must be marching-cubes, marching-tetrahedra, dual-contouring or adaptive");
  Mesh mesh = run([&](const Progress& progress) {
    Mesh found = polygonize(
        *surface.field,
        {.resolution = resolution, .method = *wanted, .tolerance = tolerance, .level = level, .progress = progress});
    if (surface.points.cols() == 0) return found;
    return keep_components_with_data(std::move(found), surface.points).mesh;
  });
  return py::make_tuple(to_array(std::move(mesh.vertices)), to_array(std::move(mesh.triangles)),
                        to_array(std::move(mesh.normals)));
}

std::unique_ptr<Surface> combine_surfaces(const std::string& operation, const std::vector<const Surface*>& surfaces,
                                          const std::string& blending, double radius, double sharpness) {
  const std::optional<Operation> wanted = operation_named(operation);
  require(wanted.has_value(), "combine", "operation", operation,
          "must be union, intersection, difference, complement or blend");
  const std::optional<Blending> form = blending_named(blending);
  require(form.has_value(), "combine", "blending", blending,
          "must be sharp, r-function, super-elliptic or log-sum-exp");
  std::vector<Solid> solids;
  for (const Surface* surface : surfaces) solids.push_back(surface->field);
  return run([&](const Progress& progress) {
    return std::make_unique<Surface>(Surface{
        combine(*wanted, solids, {.blending = *form, .radius = radius, .sharpness = sharpness, .progress = progress})});
  });
}

using Faces = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

void write_arrays(const std::string& path, const Array& vertices, const Faces& faces, const Array& normals) {
  Mesh mesh;
  mesh.vertices = points<3>(vertices, "vertices");
  mesh.normals = points<3>(normals, "normals");
  require(mesh.normals.cols() == 0 || mesh.normals.cols() == mesh.vertices.cols(), "save", "normals",
          mesh.normals.cols(), "there must be one for each vertex, or none");
  require(faces.ndim() == 2 && faces.shape(1) == 3, "save", "faces", faces.ndim(), "must be an array of 3 columns");
  mesh.triangles = Eigen::Map<const Triangles>(faces.data(), 3, faces.shape(0));
  require(mesh.triangles.size() == 0 ||
              (mesh.triangles.minCoeff() >= 0 && mesh.triangles.maxCoeff() < mesh.vertices.cols()),
          "save", "faces", "out of range", "must be numbers of vertices, from 0 on");
  run([&](const Progress& /*progress*/) { write_mesh(path, mesh); });
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
      .def_property(
          "points", [](const Surface& s) { return to_array(Points<3>(s.points)); },
          [](Surface& s, const Array& given) { s.points = points<3>(given, "points"); })
      .def("evaluate", &evaluate)
      .def("curvature", &curvature_arrays)
      .def("polygonize", &polygonize_arrays)
      .def("raycast", &raycast_arrays)
      .def("save", [](const Surface& s, const std::string& path) {
        run([&](const Progress& /*progress*/) { write_model(path, *s.field); });
      });
  m.def("reconstruct", &reconstruct_arrays);
  m.def("reconstruct_contours", &reconstruct_contours_arrays);
  m.def("combine", &combine_surfaces);
  m.def("read_surface", [](const std::string& path) {
    return run([&](const Progress& /*progress*/) { return std::make_unique<Surface>(Surface{read_model(path)}); });
  });
  m.def("write_mesh", &write_arrays);
}

}  // namespace csrbf::python
