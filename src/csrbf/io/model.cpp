#include "csrbf/io/model.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/models/archive.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "csrbf/io/models/surface_archive.hpp"
#include "csrbf/io/models/tile_store.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"
#include "csrbf/levelset/contour/segment_fields.hpp"
#include "csrbf/levelset/lattice/lattice_field.hpp"

namespace csrbf {
namespace {

template <int Dim>
NamedFunction function_of(const Segmentation<Dim>& segmentation) {
  const SegmentSettings& options = segmentation.report.options;
  Fit<Dim> fit{segmentation.fields, {}, {}};
  fit.report.method = "segment";
  fit.report.kernel = options.kernel;
  for (const RegionReport& region : segmentation.report.regions) fit.report.samples += region.voxels;
  fit.report.smoothing = options.smoothness.value_or(0);
  fit.report.axis_scales.assign(Dim, 1.0);
  for (const auto& field : segmentation.fields) {
    const Field<Dim>* one = field.get();
    if (const auto* largest = dynamic_cast<const LargestField<Dim>*>(one))
      one = largest->fields()[largest->number()].get();
    const auto* lattice = dynamic_cast<const LatticeField<Dim>*>(one);
    if (lattice == nullptr) continue;
    fit.report.centers += std::ssize(lattice->data().coefficients);
    fit.report.support = lattice->data().support;
  }
  NamedFunction named{Function(std::move(fit))};
  const std::size_t fields = segmentation.fields.size();
  if (fields == 1) named.value_names = {"level_set"};
  for (std::size_t k = 0; fields > 1 && k < fields; ++k) named.value_names.push_back("region" + std::to_string(k));
  return named;
}

Archive model_archive(const std::string& path) {
  if (is_volume_file(path))
    throw IoError(path +
                  ": an image, not a csrbf model: csrbf segment IMAGE -o LABELS --model MODEL.csrbf makes one of "
                  "it, --contour a mesh");
  if (is_listed(content_extension(path), ".ply .obj .off .stl .vtp .xyz .pts .las .laz .e57 .pcd .ptx"))
    throw IoError(path +
                  ": a mesh or points, not a csrbf model: csrbf reconstruct POINTS -o MESH --model MODEL.csrbf makes "
                  "one of it");
  return read_archive(path);
}

}  // namespace

NamedFunction to_function(const Segmentation<2>& segmentation) {
  return function_of(segmentation);
}

NamedFunction to_function(const Segmentation<3>& segmentation) {
  return function_of(segmentation);
}

void write_model(const std::string& path, const Field<3>& field) {
  write_archive(path, surface_to_archive(field), tile_places(field));
}

std::shared_ptr<const Field<3>> read_model(const std::string& path) {
  const Archive archive = model_archive(path);
  if (archive.kind != function_kind) return surface_from(archive);
  const Function function = function_from(archive).function;
  if (function.dimension() != 3 || function.components() != 1)
    archive.fail("this is a function of " + std::to_string(function.dimension()) + " variables with " +
                 std::to_string(function.components()) +
                 " components, not a surface: surfaces are functions of 3 variables with 1 component");
  return function.fit<3>().components.front();
}

void write_model(const std::string& path, const NamedFunction& function) {
  write_archive(path, to_archive(function), tile_places(function.function));
}

NamedFunction read_function(const std::string& path) {
  const Archive archive = model_archive(path);
  if (archive.kind == function_kind) return function_from(archive);
  Fit<3> fit;
  fit.components = {surface_from(archive)};
  fit.report.method = archive.kind;
  return {Function(std::move(fit)), default_coordinate_names(3), {"field"}, {}};
}

}  // namespace csrbf
