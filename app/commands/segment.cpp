#include "commands/formats.hpp"
#include "commands/segment_contours.hpp"
#include "commands/segment_options.hpp"
#include "inputs/segment_seeds.hpp"
#include "report/segment_page.hpp"

#include "csrbf/core/joined.hpp"
#include "csrbf/core/voxel_axes.hpp"
#include "csrbf/implicit/preview.hpp"
#include "csrbf/io/contour_lines.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/image.hpp"
#include "csrbf/io/images/sample_codec.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/volume.hpp"
#include "csrbf/io/volume_stream.hpp"
#include "csrbf/levelset/frame/missing_voxels.hpp"
#include "csrbf/levelset/objects.hpp"
#include "csrbf/levelset/segment_checks.hpp"
#include "csrbf/levelset/segment_json.hpp"
#include "csrbf/levelset/segment_slices.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <sstream>

namespace csrbf::app {
namespace {

void check_object_flags(const SegmentCommand& command, Session& session) {
  if (!command.objects) {
    const char* flag = !command.table.empty() ? "--table" : command.min_size ? "--min-size" : nullptr;
    if (flag != nullptr) throw UsageError(std::string(flag) + ": is about objects: add --objects");
    return;
  }
  if (command.regions > 2) throw UsageError("--objects: needs two regions, of which label 1 has the objects");
  if (!command.table.empty()) session.expect_output("--table", command.table, ".csv", "tables of objects");
}

// The objects that --objects asks for; their number goes to the report and the summary.
std::optional<Objects> find_objects(const SegmentCommand& command, const Volume<float>& image,
                                    const std::vector<std::uint8_t>& labels, Session& session) {
  if (!command.objects) return std::nullopt;
  Objects objects = session.timed("objects", [&] {
    return csrbf::find_objects(image, labels, {.min_size = command.min_size, .progress = session.progress()});
  });
  session.result["objects"] = objects.table.size();
  session.result["objects_left_out"] = objects.left_out;
  std::string said = counted(std::ssize(objects.table), "object");
  if (objects.left_out > 0) said += "; " + std::to_string(objects.left_out) + " smaller ones left out (--min-size)";
  session.say(said);
  return objects;
}

// One row for each object.
void write_object_table(const std::string& path, const std::vector<ObjectMeasure>& table, const Grid& grid) {
  const bool plane = grid.dimension() == 2;
  std::ostringstream text;
  text.precision(9);
  text << (plane ? "label,voxels,area,length,x,y,major_axis,minor_axis,mean,sphericity\n"
                 : "label,voxels,volume,area,x,y,z,major_axis,middle_axis,minor_axis,mean,sphericity\n");
  for (const ObjectMeasure& each : table) {
    text << each.label << ',' << each.voxels << ',' << each.volume << ',' << each.area;
    for (int a = 0; a < grid.dimension(); ++a) text << ',' << each.centroid[a];
    for (int a = 0; a < grid.dimension(); ++a) text << ',' << each.axes[static_cast<std::size_t>(a)];
    text << ',' << each.mean << ',' << each.sphericity << '\n';
  }
  write_file(path, text.str());
}

// Of as many bits as their number needs.
Volume<float> object_image(VolumeLayout layout, const Objects& objects) {
  const std::size_t n = objects.table.size();
  layout.type = n < 256 ? SampleType::uint8 : n < 65536 ? SampleType::uint16 : SampleType::uint32;
  layout.components = 1;
  Volume<float> image(layout);
  for (std::size_t i = 0; i < objects.labels.size(); ++i) image.values[i] = static_cast<float>(objects.labels[i]);
  return image;
}

void expect_outputs(const SegmentCommand& command, Session& session) {
  session.expect_output("--output", command.output, is_label_file(command.output),
                        std::string("label images are ") + label_formats);
  if (!command.contour.empty())
    session.expect_output(
        "--contour", command.contour, is_contour_file(command.contour),
        std::string("contours are ") + plane_contour_formats + " in the plane, " + written_mesh_formats + " in space");
  if (!command.model.empty()) session.expect_output("--model", command.model, ".csrbf", "models");
  if (!command.preview.empty()) session.expect_output("--preview", command.preview, ".png", "pictures");
  check_object_flags(command, session);
  const bool certain = command.seed_confidence.empty() || command.seed_confidence == "1";  // programs give defaults
  if (!certain && command.seeds.empty()) throw UsageError("--seed-confidence: is about seeds: add --seeds");
}

void add_options(const SegmentCommand& command, const SegmentSettings& used, Session& session) {
  session.options = {{"output", command.output}};
  add_segment_options(command, used, session);
  session.options.update({{"contour", or_null(command.contour)},
                          {"model", or_null(command.model)},
                          {"preview", or_null(command.preview)},
                          {"channels", or_null(command.channels)},
                          {"missing", or_null(used.missing)},
                          {"seeds", or_null(command.seeds)},
                          {"seed_confidence", or_null(command.seed_confidence)},
                          {"objects", command.objects},
                          {"table", or_null(command.table)},
                          {"min_size", or_null(command.min_size)}});
}

// The mean of each channel in the voxels of a label; nothing where there is one channel.
std::vector<double> channel_means(const Volume<float>& image, const std::vector<std::uint8_t>& labels, int label) {
  if (image.components == 1) return {};
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(image.components);
  Index count = 0;
  for (Index i = 0; i < std::ssize(labels); ++i) {
    const auto values = image.frame().col(i);
    if (labels[static_cast<std::size_t>(i)] != label || !values.allFinite()) continue;
    sums += values.cast<double>();
    ++count;
  }
  if (count > 0) sums /= static_cast<double>(count);
  return {sums.begin(), sums.end()};
}

// Significant digits that tell the means of regions apart, and that integers have.
int mean_digits(const std::vector<RegionReport>& regions) {
  constexpr int fewest = 4, most = 12;
  constexpr double largest_integer = 1e7;
  double largest = 1, distance = std::numeric_limits<double>::infinity();
  for (const RegionReport& region : regions) {
    largest = std::max(largest, std::abs(region.mean));
    for (const RegionReport& other : regions)
      if (other.mean > region.mean) distance = std::min(distance, other.mean - region.mean);
  }
  const double integers = largest < largest_integer ? 1 + std::floor(std::log10(largest)) : 0;
  const double apart = std::isfinite(distance) ? 2 + std::ceil(std::log10(largest / distance)) : 0;
  return std::clamp(static_cast<int>(std::max(integers, apart)), fewest, most);
}

// Of several channels the contour follows a weighted sum, of which a mean says little.
std::string brightness_text(const RegionReport& region, const std::vector<double>& channels, int digits) {
  if (channels.empty()) return "mean " + rounded(region.mean, digits) + ", sd " + rounded(region.sd);
  std::vector<std::string> means;
  for (const double mean : channels) means.push_back(rounded(mean));
  return "means of the channels " + joined(means);
}

void warn_of_skew(const Grid& grid, Session& session) {
  constexpr double small = 0.5;  // degrees
  if (skew(grid) > small)
    session.warn("the axes of the image are up to " + rounded(skew(grid), 3) +
                 " degrees off right angles: places and volumes are right, but what is smooth is told as if they were "
                 "at right angles");
}

using ChannelMeans = std::function<std::vector<double>(int label)>;

void add_result(const SegmentCommand& command, const SegmentReport& r, const Grid& grid, const ChannelMeans& means,
                Session& session) {
  session.result = segment_json<Json>(r);
  session.warn(r.warnings);
  warn_of_skew(grid, session);
  session.say(command.output + ": " + size_text(grid) + " voxels in " + counted(r.options.regions, "region") +
              ", the inside in " + counted(r.components, "component"));
  if (r.missing) session.say("missing: " + rounded(100 * *r.missing, 3) + " % of the voxels, which have label 0");
  session.say("energy: " + std::string(name_of(r.options.energy)) +
              (r.prices.empty() || r.options.shading == Shading::none
                   ? ""
                   : ", shading " + std::string(name_of(r.options.shading))) +
              (r.prices.empty() ? ", " : ", chosen; ") + std::string(name_of(r.options.mode)) + "; " +
              counted(r.iterations, "iteration") + (r.converged ? ", converged" : ", not converged") +
              (r.options.center_spacing ? "; centers every " + rounded(*r.options.center_spacing) + " voxels" : ""));
  constexpr Index most_lines = 5;  // of the summary; the report has every region
  for (const RegionReport& region : r.regions) {
    const std::vector<double> channels = means(region.label);
    if (!channels.empty())
      session.result["regions"][static_cast<std::size_t>(region.label)]["channel_means"] = channels;
    if (region.label >= most_lines) continue;
    session.say("label " + std::to_string(region.label) + ": " + counted(region.voxels, "voxel") +
                (grid.dimension() == 3 ? ", volume " : ", area ") + rounded(region.volume, 6) + ", " +
                brightness_text(region, channels, mean_digits(r.regions)));
  }
  if (std::ssize(r.regions) > most_lines)
    session.say("and " + counted(std::ssize(r.regions) - most_lines, "more label"));
}

// Runs segment(), timing its preparation and its evolution separately.
template <int Dim>
Segmentation<Dim> timed_segment(const Volume<float>& image, SegmentOptions options, Session& session) {
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double>(to - from).count();
  };
  const auto start = Clock::now();
  auto evolving = start;
  options.progress = [&, watch = session.progress()](std::string_view stage, double fraction) {
    if (stage == "evolve" && evolving == start) evolving = Clock::now();
    return watch(stage, fraction);
  };
  Segmentation<Dim> segmentation = segment<Dim>(image, options);
  session.add_time("prepare", seconds(start, evolving));
  session.add_time("evolve", seconds(evolving, Clock::now()));
  return segmentation;
}

template <int Dim>
SegmentContours<Dim> measured_contours(const Segmentation<Dim>& segmentation, const Grid& grid, Session& session) {
  SegmentContours<Dim> contours =
      session.timed("polygonize", [&] { return SegmentContours<Dim>(segmentation, grid, session.progress()); });
  contours.measure(session);
  return contours;
}

template <int Dim>
void run_segment(const SegmentCommand& command, SegmentOptions options, Volume<float> image, Session& session) {
  const Grid& grid = image.grid;
  if (!command.contour.empty()) check_contour_file(command.contour, Dim);
  session.timed("read", [&] {
    if (!command.mask.empty()) options.mask = read_mask<Dim>(command.mask, grid);
  });
  check_finite(command.input, image, without_missing_voxels(image, options.missing, options.mask));
  options.seed = session.timed("prepare", [&] { return read_seed<Dim>(command.init, grid, session.progress()); });
  if (!command.seeds.empty()) {
    session.timed("read", [&] { read_seeds<Dim>(command.seeds, command.seed_confidence, grid, options); });
    const int most = *std::max_element(options.seeds.begin(), options.seeds.end());
    if (command.regions == SegmentFlags().regions) options.regions = std::max(options.regions, most);
  }
  const std::vector<std::uint8_t> mask = options.mask;
  const Segmentation<Dim> segmentation = timed_segment<Dim>(image, std::move(options), session);
  add_options(command, segmentation.report.options, session);
  const auto means = [&](int label) { return channel_means(image, segmentation.labels, label); };
  add_result(command, segmentation.report, grid, means, session);
  const std::optional<Objects> objects = find_objects(command, image, segmentation.labels, session);
  const SegmentContours<Dim> contours = measured_contours(segmentation, grid, session);
  session.add_to_page([&](Page& page) {
    show<Dim>(
        image, mask, segmentation, session.result["contour"], [&] { return contours.mesh(); }, page);
  });
  session.write([&] {
    if (objects && !command.table.empty()) write_object_table(command.table, objects->table, grid);
    if (!command.contour.empty()) session.warn(contours.write(command.contour));
    if (!command.model.empty()) write_model(command.model, to_function(segmentation));
    if (!command.preview.empty()) write_png(command.preview, preview<Dim>(image, inside_fields(segmentation)));
    // The image is not needed any more: its memory holds the labels.
    std::vector<float> memory = std::move(image.values);
    write_volume(command.output,
                 objects ? object_image(image, *objects) : label_image(image, segmentation.labels, std::move(memory)));
  });
}

// The components that --channels asks for; by default all, of pictures without their transparency. Volumes have none,
// and other files than .png do not say that they have any.
Volume<float> with_channels(const SegmentCommand& command, Volume<float> image, Session& session) {
  const Index n = image.components;
  std::vector<Index> chosen;
  if (command.channels.empty()) {
    const bool transparent = !is_floating(image.type) && (n == 2 || n == 4);
    if (!transparent) return image;
    if (image.grid.axes == 3) {
      session.warn("the last of " + std::to_string(n) + " components is used like the others; if it is transparency, " +
                   "leave it out by --channels");
      return image;
    }
    if (file_extension(command.input) != ".png")
      session.warn("the last of " + std::to_string(n) + " components is taken for transparency and left out: with " +
                   (n == 2 ? "--channels 1,2" : "--channels 1,2,3,4") + " it counts");
    for (Index c = 0; c + 1 < n; ++c) chosen.push_back(c);
  } else {
    for (const double number : parse_list(command.channels, ',', "--channels")) {
      if (number != std::floor(number) || number < 1 || number > static_cast<double>(n))
        throw UsageError("--channels " + command.channels + ": expected numbers from 1 to " + std::to_string(n) +
                         ", the components of the image");
      chosen.push_back(static_cast<Index>(number) - 1);
    }
  }
  VolumeLayout layout = image;
  layout.components = std::ssize(chosen);
  Volume<float> result(layout);
  for (Index i = 0; i < image.grid.voxels() * image.frames; ++i)
    for (std::size_t c = 0; c < chosen.size(); ++c)
      result.values[static_cast<std::size_t>(i) * chosen.size() + c] = image.values[i * n + chosen[c]];
  return result;
}

Json describe_image(const std::string& path, const VolumeLayout& image) {
  const Grid& grid = image.grid;
  return {{"file", path},
          {"size", grid.size},
          {"type", sample_name(image.type)},
          {"spacing", {grid.spacing.x(), grid.spacing.y(), grid.spacing.z()}},
          {"origin", {grid.origin.x(), grid.origin.y(), grid.origin.z()}}};
}

// The slices of a file, whose values must be numbers.
class FileSlices final : public SliceSource {
 public:
  FileSlices(const std::string& path, VolumeStream& stream) : path_(path), stream_(stream) {}

  std::span<const float> slices(Index begin, Index end) override {
    const std::span<const float> values = stream_.read(begin, end);
    if (!is_floating(stream_.layout().type)) return values;
    const auto broken = std::find_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
    const Grid& grid = stream_.layout().grid;
    if (broken != values.end())
      refuse_voxel(path_, grid, begin * grid.size[0] * grid.size[1] + (broken - values.begin()), *broken);
    return values;
  }

 private:
  const std::string& path_;
  VolumeStream& stream_;
};

// A large image, some slices at a time, where nothing that is asked for needs all of it. False where it must be read
// whole.
bool run_by_slices(const SegmentCommand& command, SegmentOptions options, Session& session) {
  const bool labels_only = command.mask.empty() && command.init == "auto" && command.seeds.empty() &&
                           command.channels.empty() && command.missing == "auto" && !command.objects &&
                           command.preview.empty() && !session.wants_page() && VolumeWriter::can_write(command.output);
  if (!labels_only) return false;
  std::optional<VolumeStream> stream = VolumeStream::open(command.input);
  if (!stream || stream->layout().grid.dimension() != 3 || !is_large(options, stream->layout().grid.voxels()))
    return false;
  const Grid& grid = stream->layout().grid;
  if (*std::min_element(grid.size.begin(), grid.size.end()) < 2) return false;
  if (!command.contour.empty()) check_contour_file(command.contour, 3);
  VolumeLayout layout = stream->layout();
  layout.type = SampleType::uint8;
  FileSlices image(command.input, *stream);
  VolumeWriter writer(command.output, layout);
  options.progress = session.progress();
  const auto write = [&](Index, std::span<const std::uint8_t> labels) {
    writer.write({reinterpret_cast<const char*>(labels.data()), labels.size()});
  };
  const std::optional<Segmentation<3>> segmentation =
      session.timed("evolve", [&] { return segment_slices<3>(image, grid, options, write); });
  if (!segmentation) return false;
  session.input = describe_image(command.input, stream->layout());
  add_options(command, segmentation->report.options, session);
  const auto no_channels = [](int /*label*/) { return std::vector<double>(); };
  add_result(command, segmentation->report, grid, no_channels, session);
  const SegmentContours<3> contours = measured_contours(*segmentation, grid, session);
  session.write([&] {
    if (!command.contour.empty()) session.warn(contours.write(command.contour));
    if (!command.model.empty()) write_model(command.model, to_function(*segmentation));
    writer.commit();
  });
  return true;
}

}  // namespace

void run(const SegmentCommand& command, Session& session) {
  SegmentOptions options = make_segment_options(command);
  options.missing = parse_word_or_number(command.missing, "auto", "--missing");
  expect_outputs(command, session);
  if (run_by_slices(command, options, session)) return;
  Volume<float> image =
      session.timed("read", [&] { return with_channels(command, read_volume(command.input), session); });
  check_image(command.input, image);
  const Grid grid = image.grid;
  session.input = describe_image(command.input, image);
  if (grid.dimension() == 2)
    run_segment<2>(command, options, std::move(image), session);
  else
    run_segment<3>(command, options, std::move(image), session);
}

}  // namespace csrbf::app
