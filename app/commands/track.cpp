#include "csrbf/levelset/track.hpp"

#include "commands/formats.hpp"
#include "commands/segment_contours.hpp"
#include "commands/segment_options.hpp"
#include "report/image_page.hpp"
#include "report/segment_page.hpp"

#include "csrbf/implicit/preview.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/volume.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

namespace csrbf::app {
namespace {

namespace fs = std::filesystem;

std::string numbered(const std::string& stem, Index frame, const std::string& extension) {
  char number[24];
  std::snprintf(number, sizeof number, "%04lld", static_cast<long long>(frame));
  return stem + number + extension;
}

bool is_label_result(const std::string& name) {
  return is_volume_file(name) || is_listed(file_extension(name), ".raw .zraw");  // those of .mhd
}

bool is_model_result(const std::string& name) {
  return file_extension(name) == ".csrbf";
}

// The files that numbered() could have named, of a format.
std::vector<fs::path> numbered_files(const fs::path& folder, const std::string& stem,
                                     bool (*has_format)(const std::string&)) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const std::size_t end = name.find_first_not_of("0123456789", stem.size());
    constexpr std::size_t fewest_digits = 4;  // as in numbered()
    const bool has_number = name.starts_with(stem) && end != std::string::npos && end >= stem.size() + fewest_digits;
    if (entry.is_regular_file() && has_number && name[end] == '.' && has_format(name)) files.push_back(entry.path());
  }
  return files;
}

// The folder of the results: files are written to a temporary folder in it, and moved when all are complete.
class ResultFolder {
 public:
  explicit ResultFolder(const std::string& path)
      : folder_(path), drafts_(folder_ / (".csrbf-" + std::to_string(getpid()))) {
    std::error_code error;
    existed_ = fs::exists(folder_, error);
    if (existed_ && !fs::is_directory(folder_, error))
      throw UsageError("--output " + path + ": is a file; track writes to a folder");
    fs::create_directories(drafts_ / "models", error);
    if (error) throw WriteFailure(path + ": cannot create the folder: " + error.message());
  }
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;
  ~ResultFolder() {
    std::error_code ignored;
    fs::remove_all(drafts_, ignored);
    if (!existed_) fs::remove(folder_, ignored);  // when it is empty
  }

  [[nodiscard]] std::string draft(const std::string& name) const { return (drafts_ / name).string(); }

  // Also removes what an earlier run with more frames, or another format, left.
  void publish() {
    std::error_code error;
    std::set<fs::path> published;
    fs::create_directories(folder_ / "models", error);
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(drafts_)) {
      if (!entry.is_regular_file()) continue;
      const fs::path to = folder_ / entry.path().lexically_relative(drafts_);
      fs::rename(entry.path(), to, error);
      if (error) throw WriteFailure(to.string() + ": cannot be written: " + error.message());
      published.insert(to);
    }
    remove_others(numbered_files(folder_, "labels_", is_label_result), published);
    remove_others(numbered_files(folder_, "contours_", is_contour_file), published);
    remove_others(numbered_files(folder_ / "models", "frame_", is_model_result), published);
  }

 private:
  static void remove_others(const std::vector<fs::path>& files, const std::set<fs::path>& published) {
    std::error_code error;
    for (const fs::path& file : files)
      if (!published.contains(file) && !fs::remove(file, error))
        throw WriteFailure(file.string() + ": from an earlier run, cannot be removed: " + error.message());
  }

  fs::path folder_, drafts_;
  bool existed_ = false;
};

// The frames, from one file or from many; of many, one is in memory at a time.
class Frames {
 public:
  explicit Frames(const TrackCommand& command) : paths_(command.inputs), flat_(command.slices_are_frames) {
    if (paths_.size() > 1) {
      count_ = std::ssize(paths_);
      return;
    }
    sequence_ = read_volume(paths_[0]);
    if (flat_) {
      if (sequence_.frames > 1 || sequence_.grid.axes < 3)
        throw UsageError("--slices-are-frames: " + paths_[0] + " has no third axis, or a time axis already");
      sequence_.frames = sequence_.grid.size[2];
      sequence_.grid.size[2] = 1;
      sequence_.grid.axes = 2;
    }
    count_ = sequence_.frames;
    if (count_ < 2)
      throw UsageError(paths_[0] +
                       ": has one frame; give an image with a time axis, several files in their order, or " +
                       "--slices-are-frames when its third axis is time");
  }

  [[nodiscard]] Index count() const { return count_; }
  /// The name of frame t in messages.
  [[nodiscard]] std::string name(Index t) const {
    return paths_.size() > 1 ? paths_[t] : paths_[0] + ": frame " + std::to_string(t);
  }
  [[nodiscard]] Volume<float> operator()(Index t) const {
    if (paths_.size() > 1) {
      Volume<float> image = read_volume(paths_[t]);
      if (image.frames > 1)
        throw UsageError(name(t) + ": has " + std::to_string(image.frames) +
                         " frames; with several files, each must hold one");
      return image;
    }
    VolumeLayout layout = sequence_;
    layout.frames = 1;
    Volume<float> image(layout);
    std::copy_n(sequence_.values.begin() + t * sequence_.values_per_frame(), image.values.size(), image.values.begin());
    return image;
  }

 private:
  std::vector<std::string> paths_;
  bool flat_;
  Index count_ = 0;
  Volume<float> sequence_;
};

// The extension of the labels: as asked for, else that of the input where it can hold labels.
std::string label_extension(const TrackCommand& command) {
  if (!command.format.empty()) {
    const std::string extension = (command.format[0] == '.' ? "" : ".") + command.format;
    const std::string name = "labels" + extension;
    if (!is_label_file(name))
      throw UsageError("--format " + command.format +
                       ": unknown; label images are png pgm tif nii nii.gz nrrd mha mhd npy");
    return extension;
  }
  std::string name = fs::path(command.inputs[0]).filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  if (name.ends_with(".nii.gz")) return ".nii.gz";
  const std::string extension = file_extension(command.inputs[0]);
  if (extension == ".mhd") return ".mha";  // one file each
  if (extension == ".ppm") return ".pgm";
  return is_volume_file("labels" + extension) ? extension : ".nii.gz";
}

// The extension of the contours, none where they are not asked for.
std::string contour_extension(const TrackCommand& command) {
  if (command.contour.empty()) return "";
  const std::string extension = (command.contour[0] == '.' ? "" : ".") + lower_case(command.contour);
  const std::string known = content_extension("contours" + extension);
  if ((extension != known && extension != known + ".gz") || !is_contour_file("contours" + extension))
    throw UsageError("--contour " + command.contour + ": unknown extension; contours are " + plane_contour_formats +
                     " in the plane, " + written_mesh_formats + " in space");
  return extension;
}

struct Row {
  Index frame;
  RegionMeasure region;
  int iterations;
};

void write_measures(const std::string& path, const std::vector<Row>& rows) {
  std::ostringstream table;
  table.precision(12);
  table << "frame,region,voxels,volume,area,mean\n";
  for (const Row& row : rows)
    table << row.frame << ',' << row.region.label << ',' << row.region.voxels << ',' << row.region.volume << ','
          << row.region.area << ',' << row.region.mean << '\n';
  write_file(path, table.str());
}

void add_track_result(const TrackCommand& command, const std::vector<Row>& rows, Index frames, const Grid& grid,
                      const TrackReport& report, Session& session) {
  session.options = {{"output", command.output}};
  add_segment_options(command, report.options.segment, session);
  const TrackSettings& used = report.options;
  const bool limited = used.motion && std::isfinite(*used.motion);
  session.options.update({{"persistence", used.persistence},
                          {"motion", or_null(limited, used.motion.value_or(0))},
                          {"prediction", used.prediction.value_or(0)},
                          {"sweeps", used.sweeps},
                          {"format", label_extension(command).substr(1)},
                          {"contour", command.contour.empty() ? Json() : Json(contour_extension(command).substr(1))},
                          {"slices_are_frames", command.slices_are_frames}});
  Json measures = Json::array();
  for (const Row& row : rows)
    measures.push_back({{"frame", row.frame},
                        {"region", row.region.label},
                        {"voxels", row.region.voxels},
                        {"volume", row.region.volume},
                        {"area", row.region.area},
                        {"mean", row.region.mean},
                        {"iterations", row.iterations}});
  session.result = {{"frames", frames}, {"measures", measures}};
  session.warn(report.warnings);
  session.say(command.output + ": " + counted(frames, "frame") + " of " + size_text(grid) + " voxels");
  constexpr int most_lines = 5;  // of the summary; the report has every region
  for (int label = 1; label < std::min(used.segment.regions, most_lines + 1); ++label) {
    const Row *least = nullptr, *most = nullptr;
    for (const Row& row : rows) {
      if (row.region.label != label) continue;
      if (least == nullptr || row.region.volume < least->region.volume) least = &row;
      if (most == nullptr || row.region.volume > most->region.volume) most = &row;
    }
    if (least == nullptr) continue;
    session.say("label " + std::to_string(label) + (grid.dimension() == 3 ? ": volume " : ": area ") +
                rounded(least->region.volume, 6) + " (frame " + std::to_string(least->frame) + ") to " +
                rounded(most->region.volume, 6) + " (frame " + std::to_string(most->frame) + ")");
  }
}

std::vector<TrackedMeasure> sizes_of(const std::vector<Row>& rows) {
  constexpr int most = 4;  // regions: plots of as many fit on a screen
  std::vector<TrackedMeasure> measures;
  for (int label = 1; label <= most; ++label) {
    TrackedMeasure measure{label, {}};
    for (const Row& row : rows)
      if (row.region.label == label) measure.sizes.push_back(row.region.volume);
    if (!measure.sizes.empty()) measures.push_back(measure);
  }
  return measures;
}

// Frames that are shown with their contours: all, or every few, and the last one.
bool is_shown(Index frame, Index frames) {
  constexpr Index most = 40;  // pictures of some 10,000 bytes each
  const Index stride = (frames + most - 1) / most;
  return frame % stride == 0 || frame == frames - 1;
}

template <int Dim>
void run_track(const TrackCommand& command, TrackOptions options, const Frames& frames, const Volume<float>& first,
               Session& session) {
  const Grid& grid = first.grid;
  if (!command.mask.empty())
    options.segment.mask = session.timed("read", [&] { return read_mask<Dim>(command.mask, grid); });
  options.segment.seed =
      session.timed("prepare", [&] { return read_seed<Dim>(command.init, grid, session.progress()); });
  options.progress = session.progress();
  const std::string extension = label_extension(command), lines = contour_extension(command);
  if (!lines.empty()) check_contour_file("contours_0000" + lines, Dim);
  ResultFolder folder(command.output);
  std::vector<Row> rows;
  std::map<Index, RgbImage> pictures;  // of a page
  const auto take = [&](Index t, TrackedFrame<Dim>&& frame) {
    for (const RegionMeasure& region : frame.regions) rows.push_back({t, region, frame.segmentation.report.iterations});
    if (session.wants_page() && is_shown(t, frames.count()))
      pictures[t] = preview<Dim>(frames(t), inside_fields(frame.segmentation), {.size = 300});
    session.write([&] {
      write_volume(folder.draft(numbered("labels_", t, extension)), label_image(first, frame.segmentation.labels));
      write_model(folder.draft(numbered("models/frame_", t, ".csrbf")), to_function(frame.segmentation));
      if (lines.empty()) return;
      const SegmentContours<Dim> contours(frame.segmentation, grid, {});
      const std::string name = numbered("contours_", t, lines), draft = folder.draft(name);
      const std::vector<std::string> warnings = contours.write(draft);
      if (t > 0) return;  // the same in every frame
      for (std::string warning : warnings) {
        if (warning.starts_with(draft)) warning.replace(0, draft.size(), name);
        session.warn(warning);
      }
    });
  };
  const TrackReport report = session.timed("evolve", [&] {
    return track<Dim>(
        frames.count(),
        [&](Index t) {
          Volume<float> image = frames(t);
          if (image.grid.size != grid.size)
            throw UsageError(frames.name(t) + ": has " + size_text(image.grid) + " voxels, " + frames.name(0) + " " +
                             size_text(grid));
          check_finite(frames.name(t), image, options.segment.mask);
          return image;
        },
        options, take);
  });
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
    return a.frame != b.frame ? a.frame < b.frame : a.region.label < b.region.label;
  });
  add_track_result(command, rows, frames.count(), grid, report, session);
  session.add_to_page(
      [&](Page& page) { show_track(sizes_of(rows), grid.dimension() == 3 ? "volume" : "area", pictures, page); });
  session.write([&] {
    write_measures(folder.draft("measures.csv"), rows);
    folder.publish();
  });
}

}  // namespace

void run(const TrackCommand& command, Session& session) {
  TrackOptions options;
  options.segment = make_segment_options(command);
  options.persistence = command.persistence;
  options.motion = command.motion;
  options.prediction = command.prediction;
  options.sweeps = command.sweeps;
  label_extension(command);
  contour_extension(command);
  const Frames frames = session.timed("read", [&] { return Frames(command); });
  const Volume<float> first = session.timed("read", [&] { return frames(0); });
  check_image(command.inputs[0], first);
  session.input = {{"files", command.inputs},
                   {"frames", frames.count()},
                   {"size", first.grid.size},
                   {"spacing", {first.grid.spacing.x(), first.grid.spacing.y(), first.grid.spacing.z()}}};
  if (first.grid.dimension() == 2)
    run_track<2>(command, std::move(options), frames, first, session);
  else
    run_track<3>(command, std::move(options), frames, first, session);
}

}  // namespace csrbf::app
