#include "model.hpp"
#include "options.hpp"

#include "csrbf/io/model.hpp"
#include "csrbf/levelset/image_contour.hpp"
#include "csrbf/levelset/objects.hpp"
#include "csrbf/levelset/segment_json.hpp"

#include <emscripten.h>

#include <algorithm>

namespace csrbf::wasm {
namespace {

// Arrays of one byte per voxel, or null: where the inside starts, known voxels, voxels to look at.
struct VoxelArrays {
  const std::uint8_t* init = nullptr;
  const std::uint8_t* seeds = nullptr;
  const std::uint8_t* mask = nullptr;
};

// What is wanted besides the settings.
struct Wanted {
  SegmentOptions options;
  bool contour = true, model = false, objects = false;
  std::optional<Index> min_size;
};

std::vector<std::uint8_t> voxels_of(const std::uint8_t* array, Index count) {
  return array == nullptr ? std::vector<std::uint8_t>() : std::vector<std::uint8_t>(array, array + count);
}

Wanted read_wanted(Options& given, const VoxelArrays& arrays, Index voxels) {
  Wanted wanted;
  SegmentOptions& o = wanted.options;
  o.progress = progress();
  o.seed = voxels_of(arrays.init, voxels);
  o.seeds = voxels_of(arrays.seeds, voxels);
  o.mask = voxels_of(arrays.mask, voxels);
  // Seeds of several regions say how many there are.
  if (!o.seeds.empty())
    o.regions = std::max(o.regions, static_cast<int>(*std::max_element(o.seeds.begin(), o.seeds.end())));
  given.read("energy", o.energy, segment_energy);
  given.read("mode", o.mode, segment_mode);
  given.read("method", o.method, segment_method);
  given.read("shading", o.shading, shading_named);
  given.read("regions", o.regions);
  given.read("centerSpacing", o.center_spacing);
  given.read("support", o.support);
  given.read("kernel", o.kernel);
  given.read("smoothness", o.smoothness);
  given.read("window", o.window);
  given.read("balloon", o.balloon);
  given.read("fillHoles", o.fill_holes);
  given.read("missing", o.missing);
  given.read("iterations", o.iterations);
  given.read("seedConfidence", o.seed_confidence);
  given.read("contour", wanted.contour);
  given.read("model", wanted.model);
  given.read("objects", wanted.objects);
  given.read("minSize", wanted.min_size);
  if (wanted.objects && o.regions > 2) given.refuse("objects", "needs two regions, of which label 1 has the objects");
  return wanted;
}

void read_placement(Options& given, Grid& grid) {
  const int dim = grid.axes;
  const auto take = [&](const char* name, Point<3>& to) {
    std::vector<double> numbers;
    given.read(name, numbers);
    if (numbers.empty()) return;
    if (std::ssize(numbers) != dim) given.refuse(name, "must be one number for each axis, x first");
    for (int a = 0; a < dim; ++a) to[a] = numbers[static_cast<std::size_t>(a)];
  };
  take("spacing", grid.spacing);
  take("origin", grid.origin);
  if (!(grid.spacing.minCoeff() > 0)) given.refuse("spacing", "must be positive");
}

Json to_json(const SegmentReport& r) {
  Json result = segment_json<Json>(r);
  result.update({{"energy", name_of(r.options.energy)},
                 {"shading", name_of(r.options.shading)},
                 {"mode", name_of(r.options.mode)},
                 {"method", name_of(r.options.method)},
                 {"steps", r.energy},
                 {"warnings", r.warnings}});
  return result;
}

// The level sets whose insides are the labels from 1 on.
template <int Dim>
std::vector<const Field<Dim>*> fields_of(const Segmentation<Dim>& found) {
  std::vector<const Field<Dim>*> fields;
  const std::size_t first = found.fields.size() > 1 ? 1 : 0;
  for (std::size_t i = first; i < found.fields.size(); ++i) fields.push_back(found.fields[i].get());
  return fields;
}

// Lines in physical coordinates: their points, and for each its first point, number of points and label.
void add_contour(const Segmentation<2>& found, const Grid& grid, Answer& answer) {
  std::vector<double> points;
  std::vector<std::uint32_t> lines;
  Json measures = Json::array();
  std::uint32_t label = 0;
  for (const Field<2>* field : fields_of(found)) {
    const ImageContour contour = image_contour(*field, grid, {.progress = progress()});
    ++label;
    const auto begin = static_cast<std::uint32_t>(points.size() / 2);
    for (Index i = 0; i < contour.lines.points.cols(); ++i) {
      const Point<2> p = contour.lines.points.col(i);
      const Point<3> placed = contour.placement * Eigen::Vector4d(p.x(), p.y(), 0, 1);
      points.insert(points.end(), {placed.x(), placed.y()});
    }
    for (const ContourLine& line : contour.lines.lines)
      lines.insert(lines.end(),
                   {begin + static_cast<std::uint32_t>(line.begin), static_cast<std::uint32_t>(line.size), label});
    measures.push_back({{"label", label}, {"length", contour.lines.length}, {"area", contour.lines.area}});
  }
  answer.json["measures"] = measures;
  answer.add("contour", std::move(points));
  answer.add("lines", std::move(lines));
}

// One mesh of the surfaces of all labels, with the label of each vertex.
void add_contour(const Segmentation<3>& found, const Grid& grid, Answer& answer) {
  std::vector<double> positions, normals;
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint8_t> labels;
  Json measures = Json::array();
  std::uint8_t label = 0;
  for (const Field<3>* field : fields_of(found)) {
    const ImageSurface surface = image_contour(*field, grid, {.progress = progress()});
    const Mesh& mesh = surface.mesh;
    ++label;
    const auto begin = static_cast<std::uint32_t>(labels.size());
    positions.insert(positions.end(), mesh.vertices.data(), mesh.vertices.data() + mesh.vertices.size());
    normals.insert(normals.end(), mesh.normals.data(), mesh.normals.data() + mesh.normals.size());
    for (Index i = 0; i < mesh.triangles.size(); ++i)
      triangles.push_back(begin + static_cast<std::uint32_t>(mesh.triangles.data()[i]));
    labels.insert(labels.end(), static_cast<std::size_t>(mesh.vertices.cols()), label);
    measures.push_back({{"label", label}, {"area", surface.area}, {"volume", surface.volume}});
  }
  answer.json["measures"] = measures;
  answer.add("positions", std::move(positions));
  answer.add("triangles", std::move(triangles));
  answer.add("normals", std::move(normals));
  answer.add("regions", std::move(labels));
}

void add_objects(const Volume<float>& image, const std::vector<std::uint8_t>& labels, std::optional<Index> min_size,
                 Answer& answer) {
  const Objects objects = find_objects(image, labels, {.min_size = min_size, .progress = progress()});
  Json table = Json::array();
  for (const ObjectMeasure& each : objects.table)
    table.push_back({{"label", each.label},
                     {"voxels", each.voxels},
                     {"volume", each.volume},
                     {"area", each.area},
                     {"centroid", std::vector<double>(each.centroid.data(), each.centroid.data() + image.grid.axes)},
                     {"mean", each.mean},
                     {"sphericity", each.sphericity}});
  answer.json["objects"] = std::move(table);
  answer.json["objectsLeftOut"] = objects.left_out;
  answer.add("objectLabels", std::vector<std::uint32_t>(objects.labels.begin(), objects.labels.end()));
}

template <int Dim>
void segment_in(const Volume<float>& image, const Wanted& wanted, Answer& answer) {
  const Segmentation<Dim> found = segment<Dim>(image, wanted.options);
  answer.json["report"] = to_json(found.report);
  answer.add("labels", found.labels);
  if (wanted.objects) add_objects(image, found.labels, wanted.min_size, answer);
  if (wanted.contour) add_contour(found, image.grid, answer);
  if (!wanted.model) return;
  Model model{.function = to_function(found)};
  if constexpr (Dim == 3)
    if (found.fields.size() == 1) model.surface = found.fields.front();
  add_model(answer, std::move(model));
}

void segment_array(const float* values, const std::array<Index, 3>& size, Index components, const VoxelArrays& arrays,
                   const char* options, Answer& answer) {
  VolumeLayout layout;
  layout.grid.axes = size[2] > 1 ? 3 : 2;
  layout.grid.size = size;
  layout.components = components;
  Options given(options, "segment");
  read_placement(given, layout.grid);
  const Wanted wanted = read_wanted(given, arrays, layout.grid.voxels());
  given.expect_all_known();
  Volume<float> image(layout);
  std::copy_n(values, image.values.size(), image.values.begin());
  if (layout.grid.axes == 2)
    segment_in<2>(image, wanted, answer);
  else
    segment_in<3>(image, wanted, answer);
}

}  // namespace
}  // namespace csrbf::wasm

extern "C" {

using csrbf::wasm::Answer;

// `values`: component fastest, then x, y, z. The arrays of voxels may be null.
EMSCRIPTEN_KEEPALIVE Answer* csrbf_segment(const float* values, int nx, int ny, int nz, int components,
                                           const std::uint8_t* init, const std::uint8_t* seeds,
                                           const std::uint8_t* mask, const char* options) {
  return csrbf::wasm::answer([&](Answer& answer) {
    csrbf::wasm::segment_array(values, {nx, ny, nz}, components, {init, seeds, mask}, options, answer);
  });
}
}
