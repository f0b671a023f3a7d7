#include "model.hpp"
#include "options.hpp"

#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/surface/trim.hpp"

#include <emscripten.h>

namespace csrbf::wasm {
namespace {

Json to_json(const ReconstructReport& r) {
  Json json = {{"method", r.method},
               {"normals", name_of(r.normals)},
               {"points", r.points},
               {"pointsUsed", r.points_used},
               {"centers", r.centers},
               {"smoothing", r.smoothing},
               {"rmsDistance", r.rms_distance},
               {"p99Distance", r.p99_distance},
               {"maxDistance", r.max_distance},
               {"prepareSeconds", r.prepare_seconds},
               {"fitSeconds", r.fit_seconds},
               {"evaluateSeconds", r.evaluate_seconds},
               {"warnings", r.warnings}};
  if (!r.composite) return json;
  json["patches"] = r.composite->patches;
  json["levels"] = r.composite->levels;
  json["crossValidationError"] = r.composite->cross_validation_error;
  return json;
}

// How a mesh is made of a surface.
struct MeshOptions {
  PolygonizeOptions polygonize;
  std::optional<PolygonizeMethod> method;  // unset: as suits the surface
  std::optional<double> trim;

  [[nodiscard]] Mesh mesh_of(const Model& model) const {
    PolygonizeOptions wanted = polygonize;
    wanted.method = method.value_or(mesh_method(*model.surface));
    Mesh mesh = csrbf::polygonize(*model.surface, wanted);
    if (trim) mesh = csrbf::trim(mesh, model.points, *trim, model.normals);
    return model.points.cols() > 0 ? keep_components_with_data(std::move(mesh), model.points).mesh : mesh;
  }
};

void read_trim(Options& given, std::optional<double>& trim) {
  std::string word;
  given.read("trim", trim);
  if (trim && !(*trim > 0)) given.refuse("trim", "must be positive");
}

Box<3> box_of(const std::vector<double>& corners, const Options& given) {
  if (corners.size() != 6) given.refuse("bounds", "must be six numbers: the lowest x, y, z, then the highest");
  Box<3> box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = corners[static_cast<std::size_t>(a)];
    box.hi[a] = corners[static_cast<std::size_t>(a) + 3];
  }
  return box;
}

void reconstruct_arrays(const double* points, Index count, const double* normals, Index normal_count,
                        const char* options, Answer& answer) {
  Options given(options, "reconstruct");
  ReconstructOptions wanted{.progress = progress()};
  MeshOptions mesh_options;
  mesh_options.polygonize.progress = progress();
  bool keep_model = false;
  std::string sharp = "auto";
  given.read("method", wanted.method);
  given.read("centers", wanted.centers);
  given.read("tolerance", wanted.tolerance);
  given.read_smoothing(wanted.smoothing);
  given.read("resolution", mesh_options.polygonize.resolution);
  given.read("sharp", sharp);
  read_trim(given, mesh_options.trim);
  given.read("model", keep_model);
  given.expect_all_known();
  if (sharp != "auto" && sharp != "on" && sharp != "off") given.refuse("sharp", "must be auto, on or off");
  if (sharp != "auto")
    mesh_options.method = sharp == "on" ? PolygonizeMethod::dual_contouring : PolygonizeMethod::marching_cubes;

  PointCloud cloud;
  cloud.points = Eigen::Map<const Points<3>>(points, 3, count);
  cloud.normals = Eigen::Map<const Points<3>>(normals, 3, normal_count);
  require(normal_count == 0 || normal_count == count, "reconstruct", "normals", normal_count,
          "there must be one for each point");
  Reconstruction found = reconstruct(cloud, wanted);
  answer.json["report"] = to_json(found.report);
  Model model{.surface = found.field, .points = cloud.points(Eigen::all, found.source), .normals = found.normals};
  add_mesh(answer, mesh_options.mesh_of(model));
  if (keep_model) add_model(answer, std::move(model));
}

void polygonize_model(const Model& model, const char* options, Answer& answer) {
  Options given(options, "polygonize");
  MeshOptions wanted;
  PolygonizeOptions& o = wanted.polygonize;
  o.progress = progress();
  std::string method = "auto";
  std::optional<std::vector<double>> bounds;
  given.read("method", method);
  given.read("resolution", o.resolution);
  given.read("level", o.level);
  given.read("tolerance", o.tolerance);
  given.read("persistence", o.persistence);
  given.read("refine", o.refine);
  given.read("bounds", bounds);
  read_trim(given, wanted.trim);
  given.expect_all_known();
  if (method != "auto") {
    wanted.method = polygonize_method_named(method);
    if (!wanted.method)
      given.refuse("method", "must be auto, marching-cubes, marching-tetrahedra, dual-contouring or adaptive");
  }
  if (bounds) o.bounds = box_of(*bounds, given);
  if (!model.surface)
    throw InvalidInput("polygonize: needs a surface, or a function of three variables with one value");
  if (wanted.trim && model.points.cols() == 0)
    given.refuse("trim", "only surfaces made from points can be trimmed; those from files have no points");
  add_mesh(answer, wanted.mesh_of(model));
}

}  // namespace

void add_mesh(Answer& answer, Mesh mesh) {
  answer.add("positions", std::move(mesh.vertices));
  answer.add("triangles", Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic>(mesh.triangles.cast<std::uint32_t>()));
  answer.add("normals", std::move(mesh.normals));
}

}  // namespace csrbf::wasm

extern "C" {

using csrbf::wasm::Answer;

EMSCRIPTEN_KEEPALIVE Answer* csrbf_reconstruct(const double* points, int count, const double* normals, int normal_count,
                                               const char* options) {
  return csrbf::wasm::answer(
      [&](Answer& answer) { csrbf::wasm::reconstruct_arrays(points, count, normals, normal_count, options, answer); });
}
EMSCRIPTEN_KEEPALIVE Answer* csrbf_polygonize(const csrbf::wasm::Model* model, const char* options) {
  return csrbf::wasm::answer([&](Answer& answer) { csrbf::wasm::polygonize_model(*model, options, answer); });
}
}
