#include "csrbf/approx/inpaint.hpp"

#include "commands/fit_summary.hpp"
#include "commands/formats.hpp"
#include "inputs/bytes.hpp"
#include "inputs/segment_seeds.hpp"
#include "report/image_page.hpp"

#include "csrbf/io/images/sample_codec.hpp"
#include "csrbf/io/volume.hpp"
#include "csrbf/tiles/inpaint_slices.hpp"

#include <cmath>
#include <limits>

namespace csrbf::app {
namespace {

using Image = Volume<double>;  // exact for every sample type

double parse_missing(const std::string& text) {
  if (text.empty() || text == "nan") return std::numeric_limits<double>::quiet_NaN();
  return parse_numbers(text, ',', 1, "--missing")[0];
}

int parse_blocks(const std::string& text) {
  if (text == "none") return 0;
  const double width = parse_numbers(text, ',', 1, "--blocks")[0];
  if (width != std::floor(width) || width < 4 || width > 64)
    throw UsageError("--blocks " + text + ": expected auto, none or a whole number from 4 to 64");
  return static_cast<int>(width);
}

std::string size_text(const VolumeLayout& image) {
  return csrbf::size_text(image.grid) + (image.frames > 1 ? " x " + std::to_string(image.frames) + " frames" : "");
}

Image read_mask_image(const std::string& path, const Image& image) {
  Image mask = read_volume<double>(path);
  if (mask.components != 1)
    throw UsageError("--mask " + path + ": a mask has one value per pixel, this image " +
                     std::to_string(mask.components));
  if (mask.grid.size != image.grid.size || (mask.frames != 1 && mask.frames != image.frames))
    throw UsageError("--mask " + path + ": the mask has " + size_text(mask) + " pixels, the image " + size_text(image));
  require_same_place("--mask", path, mask.grid, image.grid);
  return mask;
}

// Marks the voxels of every frame that are missing in all components.
void mark_value(double value, const Image& image, std::vector<unsigned char>& missing) {
  // The file stores the nearest number of its type.
  const double stored = image.type == SampleType::float32 ? static_cast<double>(static_cast<float>(value)) : value;
  for (Index i = 0; i < std::ssize(missing); ++i) {
    bool all = true;
    for (Index c = 0; c < image.components; ++c) all = all && image.values[image.components * i + c] == stored;
    if (all) missing[i] = 1;
  }
}

std::vector<unsigned char> missing_voxels(const InpaintCommand& command, double value, const Image& image) {
  std::vector<unsigned char> missing(image.grid.voxels() * image.frames, 0);
  if (!command.mask.empty()) {
    const Image mask = read_mask_image(command.mask, image);
    for (std::size_t i = 0; i < missing.size(); ++i) missing[i] = mask.values[i % mask.values.size()] != 0 ? 1 : 0;
  }
  if (!std::isnan(value)) mark_value(value, image, missing);
  return missing;
}

Json describe_input(const std::string& path, const VolumeLayout& image) {
  return {{"file", path},
          {"size", image.grid.size},
          {"frames", image.frames},
          {"components", image.components},
          {"spacing", {image.grid.spacing.x(), image.grid.spacing.y(), image.grid.spacing.z()}}};
}

void add_inpaint_report(const InpaintCommand& command, double value, const InpaintReport& report,
                        const VolumeLayout& image, Session& session) {
  session.options = {{"output", command.output},
                     {"mask", or_null(command.mask)},
                     {"missing", or_null(!std::isnan(value), value)},
                     {"blocks", report.plan.blocks}};
  session.result = {{"missing", report.missing}, {"known", report.known}, {"thin_plate", report.plan.thin_plate}};
  session.say(command.output + ": " + size_text(image) + " pixels, " + counted(report.missing, "value") + " filled");
  if (report.missing > 0) {
    add_fit_report(command.fit, report.fit, session);
    say_fit(report.fit, session);
    if (report.plan.blocks > 0) session.say("refined by blocks of " + std::to_string(report.plan.blocks) + " pixels");
  } else {
    session.warn("nothing is missing: give --mask FILE or --missing VALUE");
  }
}

void inpaint_by_slices(const InpaintCommand& command, const InpaintOptions& options, double value, Session& session) {
  if (session.wants_page()) throw UsageError("--memory: a report in HTML shows the whole image; give a report in JSON");
  InpaintSlicesOptions how{
      .memory = static_cast<double>(parse_bytes(command.memory, "--memory")), .mask = command.mask, .inpaint = options};
  if (!std::isnan(value)) how.missing = value;
  const InpaintSlicesReport done =
      session.timed("inpaint", [&] { return inpaint_slices(command.input, command.output, how); });
  session.input = describe_input(command.input, done.layout);
  add_inpaint_report(command, value, done.inpaint, done.layout, session);
  session.options["memory"] = command.memory;
  session.result["slice_blocks"] = done.blocks;
  session.say(counted(done.blocks, "block") + " of slices");
}

}  // namespace

void run(const InpaintCommand& command, Session& session) {
  InpaintOptions options{make_fit_options(command.fit, session)};
  if (command.blocks != "auto") options.blocks = parse_blocks(command.blocks);
  const double value = parse_missing(command.missing);
  session.expect_output("--output", command.output, is_volume_file(command.output),
                        std::string("images are ") + image_formats);
  if (!command.memory.empty()) return inpaint_by_slices(command, options, value, session);
  Image image = session.timed("read", [&] { return read_volume<double>(command.input); });
  if (is_floating(image.type) && is_picture_file(command.output))
    throw UsageError("--output " + command.output + ": pictures hold whole numbers, " + command.input +
                     " does not; write .tif, .nii.gz, .nrrd or .npy");
  if (options.extrapolation == Extrapolation::nan && !is_floating(image.type))
    throw UsageError("--extrapolation nan: the image holds whole numbers, which cannot be NaN");
  const std::vector<unsigned char> missing =
      session.timed("read", [&] { return missing_voxels(command, value, image); });
  session.input = describe_input(command.input, image);
  const Image before = session.wants_page() ? image : Image();
  const InpaintReport report = session.timed("inpaint", [&] { return inpaint(image, missing, options); });
  add_inpaint_report(command, value, report, image, session);
  session.add_to_page([&](Page& page) {
    page.facts = {{grouped(report.missing), "values filled"}};
    if (std::isfinite(report.fit.cross_validation_rmse))
      page.facts.push_back({readable(report.fit.cross_validation_rmse), "error at pixels left out, root mean square"});
    show_filled(before, image, missing, page);
  });
  session.write([&] { write_volume(command.output, image); });
}

}  // namespace csrbf::app
