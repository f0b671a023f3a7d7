#include "mesh_arrays.hpp"

#include "csrbf/io/points.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/surface/estimate_normals.hpp"

#include <optional>

namespace csrbf::python {
namespace {

Orient orient_named(const std::string& name) {
  if (name == "none") return Orient::none;
  if (name == "viewpoint") return Orient::viewpoint;
  require(name == "consistent", "estimate_normals", "orient", name, "must be consistent, viewpoint or none");
  return Orient::consistent;
}

py::array_t<double> normals_of(const Array& given, Index neighbors, const std::string& orient, const Array& viewpoint,
                               const py::object& listener) {
  NormalOptions options{.neighbors = neighbors, .orient = orient_named(orient)};
  require(viewpoint.size() == 3, "estimate_normals", "coordinates of viewpoint", viewpoint.size(), "must be 3");
  options.viewpoint = vector(viewpoint, "viewpoint").head<3>();
  const auto x = points<3>(given, "points");
  return to_array(run(listener, [&](const Progress& progress) {
    options.progress = progress;
    return estimate_normals(x, options);
  }));
}

template <int Dim>
std::vector<Index> farthest_in(const Array& given, Index count, const FarthestPointsOptions& options) {
  return farthest_points<Dim>(points<Dim>(given, "points"), count, options).indices;
}

py::array_t<std::int64_t> farthest_of(const Array& given, Index count, std::optional<Index> first,
                                      const py::object& listener) {
  const Index dimension = columns(given, "points").rows();
  const std::vector<Index> picks = run(listener, [&](const Progress& progress) {
    const FarthestPointsOptions options{.first = first, .progress = progress};
    switch (dimension) {
#define CSRBF_CASE(Dim) \
  case Dim:             \
    return farthest_in<Dim>(given, count, options);
      CSRBF_FOR_EACH_DIM(CSRBF_CASE)
#undef CSRBF_CASE
      default:
        throw InvalidInput("farthest_points: points have " + std::to_string(dimension) +
                           " coordinates; 1 to 6 are supported");
    }
  });
  return py::array_t<std::int64_t>(static_cast<py::ssize_t>(picks.size()), picks.data());
}

}  // namespace

void bind_points(py::module_& m) {
  m.def("estimate_normals", &normals_of);
  m.def("farthest_points", &farthest_of);
  m.def("read_points", [](const std::string& path) {
    return to_tuple(run([&](const Progress& /*progress*/) { return read_points(path); }));
  });
  m.def("read_queries", [](const std::string& path, const std::vector<std::string>& names) {
    return to_array(run([&](const Progress& /*progress*/) { return read_queries(path, names).coordinates; }));
  });
  m.def("write_points", [](const std::string& path, const py::tuple& given) {
    const PointCloud cloud = cloud_from(given);
    return run([&](const Progress& /*progress*/) { return write_points(path, cloud); });
  });
}

}  // namespace csrbf::python
