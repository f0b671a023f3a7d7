#include "mesh_arrays.hpp"
#include "picture.hpp"
#include "volume_layout.hpp"

#include "csrbf/implicit/preview.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/levelset/image_contour.hpp"
#include "csrbf/levelset/objects.hpp"
#include "csrbf/levelset/seed.hpp"
#include "csrbf/levelset/segment.hpp"
#include "csrbf/levelset/track.hpp"

#include <Eigen/Geometry>

#include <memory>
#include <optional>
#include <variant>

namespace csrbf::python {
namespace {

using Bytes = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;
using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Image = Volume<float>;

// Labels with their level sets, and the layout of the image.
struct Segments {
  std::variant<Segmentation<2>, Segmentation<3>> found;
  Grid grid;
};

// [z, y, x] of the axes that the image has.
std::vector<py::ssize_t> shape_of(const Grid& grid) {
  std::vector<py::ssize_t> shape;
  for (int a = grid.axes; a-- > 0;) shape.push_back(grid.size[a]);
  return shape;
}

std::vector<std::uint8_t> voxels_of(const std::optional<Bytes>& given) {
  if (!given) return {};
  return {given->data(), given->data() + given->size()};
}

template <class Fill>
Bytes seed_array(const Image& image, const Fill& fill) {
  const Seed seed = run([&](const Progress& /*progress*/) { return fill(); });
  Bytes array(shape_of(image.grid));
  std::copy(seed.begin(), seed.end(), array.mutable_data());
  return array;
}

Bytes seed_ball_array(const Image& image, const Eigen::VectorXd& center, double radius) {
  return seed_array(image, [&] {
    return center.size() == 2 ? seed_ball<2>(image.grid, center.head<2>(), radius)
                              : seed_ball<3>(image.grid, center.head<3>(), radius);
  });
}

template <int Dim>
Seed boxed(const Grid& grid, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  Box<Dim> box;
  box.add(Point<Dim>(a.head<Dim>()));
  box.add(Point<Dim>(b.head<Dim>()));
  return seed_box<Dim>(grid, box);
}

Bytes seed_box_array(const Image& image, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return seed_array(image, [&] { return a.size() == 2 ? boxed<2>(image.grid, a, b) : boxed<3>(image.grid, a, b); });
}

SegmentOptions make_options(const py::dict& given) {
  SegmentOptions options;
  options.energy = segment_energy(word_or(given, "energy", "auto"));
  options.mode = segment_mode(word_or(given, "mode", "global"));
  options.method = segment_method(word_or(given, "method", "variational"));
  options.shading = shading_named(word_or(given, "shading", "auto"));
  read_entry(given, "regions", options.regions);
  read_entry(given, "center_spacing", options.center_spacing);
  read_entry(given, "support", options.support);
  read_entry(given, "kernel", options.kernel);
  read_entry(given, "smoothness", options.smoothness);
  read_entry(given, "window", options.window);
  read_entry(given, "balloon", options.balloon);
  read_entry(given, "fill_holes", options.fill_holes);
  read_entry(given, "iterations", options.iterations);
  read_entry(given, "seed_confidence", options.seed_confidence);
  read_entry(given, "missing", options.missing);
  return options;
}

// Calls a Python function of the labels, an array like the image, that returns the cost of being inside.
ForceUpdate force_of(const py::object& function, const Grid& grid) {
  if (function.is_none()) return {};
  return [function = function.ptr(), shape = shape_of(grid), n = grid.voxels()](const unsigned char* labels,
                                                                                float* force) {
    const py::gil_scoped_acquire hold;
    Bytes given(shape);
    std::copy_n(labels, n, given.mutable_data());
    const py::object result = py::reinterpret_borrow<py::function>(function)(given);
    const Floats values = Floats::ensure(result);
    if (!values) throw py::error_already_set();
    require(values.size() == n, "segment", "size of the result of force", values.size(),
            "must be that of the image, " + std::to_string(n));
    std::copy_n(values.data(), n, force);
  };
}

std::unique_ptr<Segments> segment_image(const Image& image, const std::optional<Bytes>& seed,
                                        const std::optional<Bytes>& mask, const std::optional<Bytes>& seeds,
                                        const std::optional<Floats>& confidences, const py::dict& given,
                                        const py::object& force, const py::object& listener) {
  SegmentOptions options = make_options(given);
  options.seed = voxels_of(seed);
  options.mask = voxels_of(mask);
  options.seeds = voxels_of(seeds);
  if (confidences) options.seed_confidences.assign(confidences->data(), confidences->data() + confidences->size());
  options.force = force_of(force, image.grid);
  return run(listener, [&](const Progress& progress) {
    options.progress = progress;
    auto result = std::make_unique<Segments>();
    result->grid = image.grid;
    if (image.grid.dimension() == 2)
      result->found = segment<2>(image, options);
    else
      result->found = segment<3>(image, options);
    return result;
  });
}

// One frame of a sequence, and its measures.
struct Tracked {
  std::unique_ptr<Segments> segments;
  std::vector<RegionMeasure> regions;
};

struct TrackedSequence {
  std::vector<Tracked> frames;
  std::vector<std::string> warnings;
};

template <int Dim>
TrackedSequence track_in(const std::vector<const Image*>& images, const TrackOptions& options) {
  TrackedSequence result;
  result.frames.resize(images.size());
  TrackReport report = track<Dim>(
      static_cast<Index>(images.size()), [&](Index t) { return *images[t]; }, options,
      [&](Index t, TrackedFrame<Dim>&& frame) {
        Tracked& to = result.frames[t];
        to.segments = std::make_unique<Segments>();
        to.segments->grid = images[t]->grid;
        to.segments->found = std::move(frame.segmentation);
        to.regions = std::move(frame.regions);
      });
  result.warnings = std::move(report.warnings);
  return result;
}

TrackedSequence track_images(const std::vector<const Image*>& images, const std::optional<Bytes>& seed,
                             const std::optional<Bytes>& mask, const py::dict& given, double persistence,
                             std::optional<double> motion, int sweeps, const py::object& listener) {
  require(!images.empty(), "track", "number of frames", images.size(), "there must be at least one");
  TrackOptions options;
  options.segment = make_options(given);
  options.segment.seed = voxels_of(seed);
  options.segment.mask = voxels_of(mask);
  options.persistence = persistence;
  options.motion = motion;
  options.sweeps = sweeps;
  return run(listener, [&](const Progress& progress) {
    options.progress = progress;
    return images[0]->grid.dimension() == 2 ? track_in<2>(images, options) : track_in<3>(images, options);
  });
}

std::unique_ptr<Image> frame_of(const Image& image, Index t) {
  require(t >= 0 && t < image.frames, "track", "frame", t, "there is no such frame");
  auto frame = std::make_unique<Image>();
  static_cast<VolumeLayout&>(*frame) = image;
  frame->frames = 1;
  const auto size = static_cast<std::ptrdiff_t>(image.values_per_frame());
  frame->values.assign(image.values.begin() + t * size, image.values.begin() + (t + 1) * size);
  return frame;
}

py::dict segmentation_to_dict(const SegmentReport& r) {
  using namespace py::literals;
  const SegmentSettings& o = r.options;
  py::list regions;
  for (const RegionReport& region : r.regions)
    regions.append(py::dict("label"_a = region.label, "voxels"_a = region.voxels, "volume"_a = region.volume,
                            "mean"_a = region.mean, "sd"_a = region.sd));
  py::list prices;
  for (const EnergyPrice& each : r.prices)
    prices.append(py::dict("energy"_a = std::string(name_of(each.energy)),
                           "shading"_a = std::string(name_of(each.shading)), "nats"_a = each.nats));
  const py::dict options("energy"_a = std::string(name_of(o.energy)), "mode"_a = std::string(name_of(o.mode)),
                         "method"_a = std::string(name_of(o.method)), "shading"_a = std::string(name_of(o.shading)),
                         "regions"_a = o.regions, "center_spacing"_a = o.center_spacing, "support"_a = o.support,
                         "kernel"_a = o.kernel, "smoothness"_a = o.smoothness, "window"_a = o.window,
                         "balloon"_a = o.balloon, "fill_holes"_a = o.fill_holes, "missing"_a = o.missing,
                         "iterations"_a = o.iterations);
  return py::dict("iterations"_a = r.iterations, "converged"_a = r.converged, "energy"_a = r.energy,
                  "regions"_a = regions, "components"_a = r.components, "noise"_a = r.noise,
                  "noise_growth"_a = r.noise_growth, "uneven_noise"_a = r.uneven_noise, "grain"_a = r.grain,
                  "blur"_a = r.blur, "impulses"_a = r.impulses, "missing"_a = r.missing, "textures"_a = r.textures,
                  "speckle"_a = r.speckle, "prices"_a = prices, "channels"_a = r.channels, "options"_a = options,
                  "warnings"_a = r.warnings);
}

const SegmentReport& report_of(const Segments& s) {
  return std::visit([](const auto& found) -> const SegmentReport& { return found.report; }, s.found);
}

Bytes labels_of(const Segments& s) {
  Bytes array(shape_of(s.grid));
  std::visit([&](const auto& found) { std::copy(found.labels.begin(), found.labels.end(), array.mutable_data()); },
             s.found);
  return array;
}

std::unique_ptr<NamedFunction> function_of(const Segments& s) {
  return std::visit([](const auto& found) { return std::make_unique<NamedFunction>(to_function(found)); }, s.found);
}

template <class Fields>
const auto& field_of(const Fields& fields, Index label) {
  const Index k = fields.size() == 1 ? label - 1 : label;
  require(k >= 0 && k < static_cast<Index>(fields.size()), "contour", "label", label, "there is no such region");
  return *fields[k];
}

// The labels, the measures of each, and how many are too small.
py::tuple objects_of(const Image& image, const Segments& s, std::optional<Index> min_size, const py::object& listener) {
  using namespace py::literals;
  const Objects found = run(listener, [&](const Progress& progress) {
    return std::visit(
        [&](const auto& segmentation) {
          return find_objects(image, segmentation.labels, {.min_size = min_size, .progress = progress});
        },
        s.found);
  });
  py::array_t<std::int32_t> labels(shape_of(s.grid));
  std::copy(found.labels.begin(), found.labels.end(), labels.mutable_data());
  const int dim = s.grid.dimension();
  py::list table;
  for (const ObjectMeasure& each : found.table) {
    py::list centroid, axes;
    for (int a = 0; a < dim; ++a) {
      centroid.append(each.centroid[a]);
      axes.append(each.axes[static_cast<std::size_t>(a)]);
    }
    py::dict row("label"_a = each.label, "voxels"_a = each.voxels);
    row[dim == 2 ? "area" : "volume"] = each.volume;
    row[dim == 2 ? "length" : "area"] = each.area;
    row["centroid"] = centroid;
    row["axes"] = axes;
    row["mean"] = each.mean;
    row["sphericity"] = each.sphericity;
    table.append(row);
  }
  return py::make_tuple(labels, table, found.left_out);
}

// Arrays of the points of each line, and its measures.
py::tuple contour_in_plane(const Segmentation<2>& found, const Grid& grid, Index label, int resolution) {
  using namespace py::literals;
  const ImageContour contour = run([&](const Progress& progress) {
    return image_contour(field_of(found.fields, label), grid, {.resolution = resolution, .progress = progress});
  });
  py::list lines;
  for (const ContourLine& line : contour.lines.lines) {
    Points<3> points = Points<3>::Zero(3, line.size);
    points.topRows(2) = contour.lines.points.middleCols(line.begin, line.size);
    lines.append(to_array(Points<2>((Eigen::Affine3d(contour.placement) * points).topRows(2))));
  }
  return py::make_tuple(
      lines, py::dict("length"_a = contour.lines.length, "area"_a = contour.lines.area,
                      "length_error"_a = contour.lines.length_error, "area_error"_a = contour.lines.area_error));
}

// The mesh, and the measures.
py::tuple contour_in_space(const Segmentation<3>& found, const Grid& grid, Index label, int resolution) {
  using namespace py::literals;
  ImageSurface surface = run([&](const Progress& progress) {
    return image_contour(field_of(found.fields, label), grid, {.resolution = resolution, .progress = progress});
  });
  const py::dict measures("area"_a = surface.area, "volume"_a = surface.volume, "area_error"_a = surface.area_error,
                          "volume_error"_a = surface.volume_error);
  return py::make_tuple(to_tuple(std::move(surface.mesh)), measures);
}

py::tuple contour_of(const Segments& s, Index label, int resolution) {
  if (const auto* plane = std::get_if<Segmentation<2>>(&s.found))
    return contour_in_plane(*plane, s.grid, label, resolution);
  return contour_in_space(std::get<Segmentation<3>>(s.found), s.grid, label, resolution);
}

// The content of pickles: the labels, the level sets from to_function(), and the layout of the image.
std::unique_ptr<Segments> restored(const NamedFunction& function, const Bytes& labels, const py::dict& layout) {
  auto segments = std::make_unique<Segments>();
  segments->grid = layout_from(layout).grid;
  const auto fill = [&](auto& found, const auto& fit) {
    found.fields = fit.components;
    found.labels = voxels_of(labels);
  };
  if (function.function.dimension() == 2)
    fill(segments->found.emplace<Segmentation<2>>(), function.function.fit<2>());
  else
    fill(segments->found.emplace<Segmentation<3>>(), function.function.fit<3>());
  return segments;
}

// A slice of the image with the contours of all regions but the outside.
py::array_t<std::uint8_t> preview_of(const Segments& s, const Image& image, int axis, int size) {
  return to_array(run([&](const Progress& /*progress*/) {
    return std::visit(
        [&]<int Dim>(const Segmentation<Dim>& found) {
          std::vector<const Field<Dim>*> fields;
          for (std::size_t k = found.fields.size() > 1 ? 1 : 0; k < found.fields.size(); ++k)
            fields.push_back(found.fields[k].get());
          return preview<Dim>(image, fields, {.axis = axis, .size = size});
        },
        s.found);
  }));
}

py::dict layout_of(const Segments& s) {
  VolumeLayout layout;
  layout.grid = s.grid;
  layout.type = SampleType::uint8;
  return python::to_dict(layout);
}

}  // namespace

void bind_segment(py::module_& m) {
  py::class_<Image>(m, "Volume")
      .def(py::init([](const Floats& values, const py::dict& layout) {
        return std::make_unique<Image>(volume_from<float>(values, layout));
      }))
      .def_property_readonly("shape", [](const Image& image) { return shape_of(image.grid); })
      .def_property_readonly("dimension", [](const Image& image) { return image.grid.dimension(); })
      .def_property_readonly("frames", [](const Image& image) { return image.frames; })
      .def("frame", &frame_of)
      .def("seed_ball", [](const Image& image, const Array& center,
                           double radius) { return seed_ball_array(image, vector(center, "init"), radius); })
      .def("seed_box", [](const Image& image, const Array& a,
                          const Array& b) { return seed_box_array(image, vector(a, "init"), vector(b, "init")); })
      .def("seed_polygon", [](const Image& image, const Array& corners) {
        return seed_array(image, [&] { return seed_polygon(image.grid, points<2>(corners, "init")); });
      });
  py::class_<Segments>(m, "Segments")
      .def_property_readonly("labels", &labels_of)
      .def_property_readonly("report", [](const Segments& s) { return segmentation_to_dict(report_of(s)); })
      .def("function", &function_of)
      .def("contour", &contour_of)
      .def("preview", &preview_of)
      .def_property_readonly("layout", &layout_of)
      .def_static("restore", &restored);
  m.def("segment", &segment_image);
  m.def("find_objects", &objects_of);
  m.def("track", [](const std::vector<const Image*>& images, const std::optional<Bytes>& seed,
                    const std::optional<Bytes>& mask, const py::dict& given, double persistence,
                    std::optional<double> motion, int sweeps, const py::object& listener) {
    using namespace py::literals;
    TrackedSequence tracked = track_images(images, seed, mask, given, persistence, motion, sweeps, listener);
    py::list frames;
    for (Tracked& frame : tracked.frames) {
      py::list regions;
      for (const RegionMeasure& region : frame.regions)
        regions.append(py::dict("label"_a = region.label, "voxels"_a = region.voxels, "volume"_a = region.volume,
                                "area"_a = region.area, "mean"_a = region.mean));
      frames.append(py::make_tuple(std::move(frame.segments), regions));
    }
    return py::make_tuple(frames, tracked.warnings);
  });
}

}  // namespace csrbf::python
