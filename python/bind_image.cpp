#include "csrbf/approx/inpaint.hpp"
#include "csrbf/io/images/sample_codec.hpp"
#include "csrbf/io/volume.hpp"
#include "csrbf/levelset/compare_labels.hpp"
#include "csrbf/tiles/inpaint_slices.hpp"

#include "fit_options.hpp"
#include "volume_layout.hpp"

#include <array>

namespace csrbf::python {
namespace {

using Bytes = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;
using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;

}  // namespace

Space space_named(const std::string& name) {
  for (const Space space : {Space::unknown, Space::left_posterior_superior, Space::right_anterior_superior})
    if (name == space_name(space)) return space;
  throw InvalidInput("space: \"" + name + R"(" is neither "unknown" nor "LPS" nor "RAS")");
}

namespace {

SampleType sample_type_named(const std::string& name) {
  for (int type = 0; type <= static_cast<int>(SampleType::float64); ++type)
    if (sample_name(static_cast<SampleType>(type)) == name) return static_cast<SampleType>(type);
  throw InvalidInput("Image: type = " + name + ": there is no file of such numbers; convert the array");
}

// Can a float represent all numbers of that type?
bool fits_float(SampleType type) {
  return type == SampleType::float32 || (!is_floating(type) && sample_size(type) < sizeof(std::int32_t));
}

template <class Scalar>
py::tuple to_array_and_layout(const Volume<Scalar>& volume) {
  py::array values(py::dtype(std::string(sample_name(volume.type))), static_cast<py::ssize_t>(volume.values.size()));
  char* const to = static_cast<char*>(values.mutable_data());
  run([&](const Progress& /*progress*/) {
    const std::string samples = encode_samples(volume, volume.type);
    std::copy(samples.begin(), samples.end(), to);
  });
  return py::make_tuple(values, to_dict(static_cast<const VolumeLayout&>(volume)));
}

py::tuple read_image(const std::string& path) {
  const auto volume = run([&](const Progress& /*progress*/) { return read_volume<float>(path); });
  if (fits_float(volume.type)) return to_array_and_layout(volume);
  return to_array_and_layout(run([&](const Progress& /*progress*/) { return read_volume<double>(path); }));
}

void write_image(const std::string& path, const py::array& values, const py::dict& given) {
  if (fits_float(layout_from(given).type)) {
    const auto volume = volume_from<float>(Floats::ensure(values), given);
    run([&](const Progress& /*progress*/) { write_volume(path, volume); });
  } else {
    const auto volume = volume_from<double>(Array::ensure(values), given);
    run([&](const Progress& /*progress*/) { write_volume(path, volume); });
  }
}

py::dict inpainting_to_dict(const InpaintReport& report) {
  using namespace py::literals;
  py::dict result("missing"_a = report.missing, "known"_a = report.known, "blocks"_a = report.plan.blocks,
                  "thin_plate"_a = report.plan.thin_plate);
  if (report.missing > 0) result["fit"] = to_dict(report.fit);
  return result;
}

py::dict inpaint_by_slices(const std::string& image, const std::string& output, double memory, const std::string& mask,
                           const std::optional<double>& missing, const py::dict& given,
                           const std::optional<int>& blocks, const py::object& listener) {
  InpaintSlicesOptions options{memory, mask, missing, {fit_options(given), blocks}};
  const InpaintSlicesReport report = run(listener, [&](const Progress& progress) {
    options.inpaint.progress = progress;
    return inpaint_slices(image, output, options);
  });
  py::dict result = inpainting_to_dict(report.inpaint);
  result["slice_blocks"] = report.blocks;
  return result;
}

// The filled values, as doubles, and the report.
py::tuple inpaint_image(const Array& values, const py::dict& layout, const Bytes& missing, const py::dict& given,
                        const std::optional<int>& blocks, const py::object& listener) {
  Volume<double> volume = volume_from<double>(values, layout);
  const std::vector<unsigned char> holes(missing.data(), missing.data() + missing.size());
  InpaintOptions options{fit_options(given), blocks};
  const InpaintReport report = run(listener, [&](const Progress& progress) {
    options.progress = progress;
    return inpaint(volume, holes, options);
  });
  return py::make_tuple(py::array_t<double>(static_cast<py::ssize_t>(volume.values.size()), volume.values.data()),
                        inpainting_to_dict(report));
}

py::dict agreement_to_dict(const LabelAgreement& agreement) {
  using namespace py::literals;
  return py::dict("dice"_a = agreement.dice, "jaccard"_a = agreement.jaccard, "hausdorff95"_a = agreement.hausdorff95);
}

py::dict compare_images(const Floats& values, const py::dict& layout, const Floats& reference_values,
                        const py::dict& reference_layout, bool inside_only, const py::object& listener) {
  const Volume<float> image = volume_from<float>(values, layout);
  const Volume<float> reference = volume_from<float>(reference_values, reference_layout);
  const LabelsComparison found = run(listener, [&](const Progress& progress) {
    return compare_labels(image, reference, {.inside_only = inside_only, .progress = progress});
  });
  py::list labels;
  for (const LabelComparison& label : found.labels) {
    py::dict one = agreement_to_dict(label);
    one["label"] = label.label;
    one["voxels"] = label.voxels;
    one["reference_voxels"] = label.reference_voxels;
    labels.append(one);
  }
  py::dict result = agreement_to_dict(static_cast<const LabelAgreement&>(found));
  result["labels"] = labels;
  return result;
}

// How two images of one size lie apart; empty where they do not, or where one has no place.
std::string places_apart(const py::dict& one, const py::dict& other) {
  const Grid a = layout_from(one).grid, b = layout_from(other).grid;
  const bool placed = a.space != Space::unknown && b.space != Space::unknown;
  return placed && distance_apart(a, b) > 0 ? places_text(a, b) : "";
}

}  // namespace

py::dict to_dict(const VolumeLayout& layout) {
  using namespace py::literals;
  const Grid& grid = layout.grid;
  const Eigen::Matrix3d transposed = grid.direction.transpose();
  return py::dict("axes"_a = grid.axes, "size"_a = grid.size,
                  "spacing"_a = std::vector<double>(grid.spacing.begin(), grid.spacing.end()),
                  "origin"_a = std::vector<double>(grid.origin.begin(), grid.origin.end()),
                  "direction"_a = to_array(Eigen::MatrixXd(transposed)), "space"_a = space_name(grid.space),
                  "frames"_a = layout.frames, "time_step"_a = layout.time_step, "components"_a = layout.components,
                  "type"_a = std::string(sample_name(layout.type)));
}

VolumeLayout layout_from(const py::dict& given) {
  VolumeLayout layout;
  Grid& grid = layout.grid;
  read_entry(given, "axes", grid.axes);
  read_entry(given, "size", grid.size);
  read_entry(given, "frames", layout.frames);
  read_entry(given, "time_step", layout.time_step);
  read_entry(given, "components", layout.components);
  layout.type = sample_type_named(given["type"].cast<std::string>());
  const Array spacing = given["spacing"].cast<Array>();
  grid.spacing = vector(spacing, "spacing").head<3>();
  const Array origin = given["origin"].cast<Array>();
  grid.origin = vector(origin, "origin").head<3>();
  const Array direction = given["direction"].cast<Array>();
  grid.direction = columns(direction, "direction").topLeftCorner<3, 3>().transpose();
  grid.space = space_named(given["space"].cast<std::string>());
  return layout;
}

void bind_image(py::module_& m) {
  m.def("read_image", &read_image);
  m.def("write_image", &write_image);
  m.def("is_image_file", [](const std::string& path) { return is_readable_volume(path); });
  m.def("inpaint", &inpaint_image);
  m.def("inpaint_slices", &inpaint_by_slices);
  m.def("compare_labels", &compare_images);
  m.def("places_apart", &places_apart);
}

}  // namespace csrbf::python
