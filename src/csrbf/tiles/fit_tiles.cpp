#include "csrbf/tiles/fit_tiles.hpp"

#include "csrbf/approx/samples/robust_weights.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/core/seconds_since.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "csrbf/spatial/usual_extent.hpp"
#include "csrbf/tiles/stages/fit_function_tile.hpp"
#include "csrbf/tiles/stages/prepare_tiles.hpp"
#include "csrbf/tiles/stages/sample_stream.hpp"

#include <set>
#include <sstream>

namespace csrbf {
namespace {

constexpr Index fewest_tile_samples = 1000;        // smaller tiles consist of borders
constexpr double number_disk = 50;                 // bytes of files for each number of a sample; measured: 17 to 49
constexpr Index looks = 64, rows_per_look = 1024;  // at the input, for the extents

// In spacings, chosen by hand: tiles blend over the width of a patch, and see the samples of all patches there.
constexpr double blend_spacings = 3;
constexpr double patch_spacings = 6;

// Memory as measured with two threads for three kinds of functions (smooth, rough, noisy), 1 to 4 variables and 1 to 3
// values: of the program with the libraries of all formats (DICOM takes 12 MB), and for each sample that a tile sees.
// It says nothing of threads, which must not change tiles.
constexpr double program_bytes = 172e6, sample_bytes = 100, variable_bytes = 70, value_bytes = 60;

// Peak memory of n samples in so many tiles, which see those of others beyond one face for each cut.
double bytes_of_tiles(double n, Index tiles, int variables, Index values) {
  const double samples = n / static_cast<double>(tiles), side = std::pow(samples, 1.0 / variables);
  const double faces = std::min(2.0 * variables, std::ceil(std::log2(static_cast<double>(tiles))));
  const double seen = samples * std::pow(1 + (blend_spacings + patch_spacings) / side, faces);
  return program_bytes + std::min(seen, n) * (sample_bytes + variable_bytes * variables +
                                              value_bytes * static_cast<double>(values - 1));
}

// Samples of each of the fewest tiles that fit in the memory.
Index samples_within(double memory, Index n, int variables, Index values) {
  constexpr double mega = 1e6;
  constexpr Index fewest = 10 * fewest_tile_samples;  // with fewer, tiles see more samples around them than in them
  const Index most = std::max<Index>(1, n / fewest);
  for (Index tiles = 1; tiles <= most; tiles = std::max(tiles + 1, tiles * 17 / 16))
    if (bytes_of_tiles(static_cast<double>(n), tiles, variables, values) <= memory) return (n + tiles - 1) / tiles;
  const double least = bytes_of_tiles(static_cast<double>(n), most, variables, values);
  throw InvalidInput("fit_tiles: memory = " + std::to_string(static_cast<Index>(memory / mega)) +
                     " MB: is too little; give at least " +
                     std::to_string(static_cast<Index>(std::ceil(least / mega))) + " MB");
}

void check_fit_tiles(const FitTileOptions& options) {
  constexpr auto where = "fit_tiles";
  const FitOptions& fit = options.fit;
  require(options.tile_points >= fewest_tile_samples, where, "tile_points", options.tile_points,
          "must be at least 1000");
  require(fit.centers == 0, where, "centers", fit.centers, "tiles cannot share a budget of centres");
  require(fit.periods.empty(), where, "periods", fit.periods.size(), "tiles do not repeat");
  require(fit.sphere.empty(), where, "sphere", fit.sphere.size(), "tiles are boxes, not parts of a sphere");
  require(fit.drift.empty(), where, "drift", fit.drift.size(), "tiles cannot share a drift");
  require(fit.gradients.size() == 0, where, "gradients", fit.gradients.rows(), "tiles take values only");
  require(fit.faults.empty(), where, "faults", fit.faults.size(), "tiles do not know them");
  require(fit.transform == "auto" || fit.transform == "none", where, "transform", fit.transform,
          "tiles take values as they are");
}

std::string fit_options_text(const FitTileOptions& options, Index tile_points) {
  const FitOptions& fit = options.fit;
  std::ostringstream text;
  text.precision(17);
  text << "tile_points " << tile_points << " columns " << options.columns.coordinates << "|" << options.columns.values
       << "|" << options.columns.weights << " method " << fit.method << " kernel " << fit.kernel << " "
       << fit.kernel_parameter << " tolerance " << fit.tolerance << " smoothing " << fit.smoothing.value_or(-1)
       << " degree " << fit.degree.value_or(-2) << " loss " << fit.loss << " missing " << fit.missing.value_or(0)
       << (fit.missing ? "" : " none") << " extrapolation " << name_of(fit.extrapolation)
       << (fit.standard_deviation ? " standard_deviation" : "");
  return text.str();
}

// What one process does.
template <int Dim>
class FunctionInTiles {
 public:
  FunctionInTiles(const std::string& samples, const std::string& model, const FitTileOptions& options,
                  SampleStream& stream)
      : samples_(samples),
        model_(model),
        options_(options),
        tile_points_(options.memory > 0
                         ? samples_within(options.memory, stream.size(), Dim, stream.head().values.cols())
                         : options.tile_points),
        team_(options.folder, options.share, options.fit.progress),
        folder_(team_.folder()),
        stream_(stream) {}

  FitTileReport run() {
    report_.tile_points = tile_points_;
    report_.coordinate_names = stream_.head().coordinate_names;
    report_.value_names = stream_.head().value_names;
    team_.run([this] {
      prepare();
      fit();
      if (team_.leads()) {
        report(team_.progress(), "write", 0);
        write_function<Dim>(work_, folder_, tiles_, report_.fit, scales_, options_.fit.extrapolation, model_);
      }
      team_.finish("work");
    });
    return report_;
  }

 private:
  [[nodiscard]] Index count() const { return work_.plan.size(); }

  [[nodiscard]] RecordSource<Dim> source() {
    const SampleTable& head = stream_.head();
    const auto columns = static_cast<std::size_t>(head.values.cols() + (has_weights() ? 1 : 0));
    return {.size = stream_.size(), .payload = sizeof(double) * columns, .read = [this](Index begin, Index end) {
              return stream_.read<Dim>(begin, end, scales_);
            }};
  }
  [[nodiscard]] bool has_weights() const { return !options_.columns.weights.empty(); }

  // Axes of different units, by samples from all over the file.
  Point<Dim> choose_scales() {
    Point<Dim> scales = Point<Dim>::Ones();
    if (Dim == 1 || !options_.fit.scale_axes) return scales;
    std::vector<Point<Dim>> seen;
    for (Index look = 0; look < looks; ++look) {
      const Index begin = stream_.size() * look / looks;
      const Records<Dim> some = stream_.read<Dim>(begin, std::min(begin + rows_per_look, stream_.size()), scales);
      for (Index i = 0; i < some.size(); ++i)
        if (some.matrix().col(i).allFinite()) seen.emplace_back(some.matrix().col(i));
    }
    const Eigen::Map<const Points<Dim>> points(seen.empty() ? nullptr : seen.front().data(), Dim, std::ssize(seen));
    const Point<Dim> extent = usual_extent<Dim>(points);
    if (!(ratio_of_extents<Dim>(extent) > different_units)) return scales;
    return (extent.array() > 0).select(extent, scales);
  }

  void prepare() {
    scales_ = choose_scales();
    const TileRules rules{.tile_points = tile_points_,
                          .dimension = Dim,
                          .blend = [](double spacing, double) { return blend_spacings * spacing; },
                          .reach = patch_spacings,
                          .boxed = true};  // fits take the empty corners of other shapes for gaps
    work_ = prepare_tiles<Dim>(
        team_, {.open = [this] { return source(); },
                .rules = rules,
                .numbered = true,
                .fingerprint = tile_fingerprint(samples_, fit_options_text(options_, tile_points_)),
                .notes = [this] { return notes(); },
                .disk = number_disk * static_cast<double>(Dim + stream_.head().values.cols() + (has_weights() ? 1 : 0)),
                .warn = [this](const std::string& text) { warn(text); }});
    for (const std::string& text : column_warnings(stream_.head())) warn(text);
    report_.tiles = count();
    report_.dropped = work_.non_finite;
  }

  void warn(const std::string& text) {
    if (options_.warn)
      options_.warn(text);
    else
      report_.fit.warnings.push_back(text);
  }

  [[nodiscard]] Archive notes() const {
    Archive notes;
    notes.kind = "function";
    notes.set("components", stream_.head().values.cols());
    notes.set("weights", has_weights() ? 1 : 0);
    set_texts(notes, "coordinate_name", report_.coordinate_names);
    set_texts(notes, "value_name", report_.value_names);
    notes.set("crs", stream_.head().crs);
    return notes;
  }

  void fit() {
    const auto start = std::chrono::steady_clock::now();
    report_.continued = team_.for_own("fit", count(), [&](Index t) {
      FitOptions here = options_.fit;
      here.progress = team_.part_of("fit", t, count());
      fit_function_tile(work_, folder_, t, here);
    });
    team_.wait_for_all("fit", count());
    for (Index t = 0; t < count(); ++t) tiles_.push_back(read_function_tile(folder_, t));
    summarise();
    report_.fit.fit_seconds = seconds_since(start);
  }

  // The reports of all tiles in one.
  void summarise() {
    FitReport& out = report_.fit;
    std::set<std::string> methods, kernels;
    TileWarnings warnings;
    out.partition.emplace();
    double squares = 0, left_out = 0, smoothing = 0;
    std::vector<double> noise(report_.value_names.size(), 0.0);
    bool noise_known = true;
    for (const FunctionTile& tile : tiles_) {
      const FitReport& r = tile.report;
      const auto share = static_cast<double>(tile.samples) / static_cast<double>(work_.points);
      methods.insert(r.method);
      kernels.insert(r.kernel);
      out.centers += r.centers;
      out.merged_duplicates += r.merged_duplicates;
      if (r.partition) out.partition->patches += r.partition->patches;
      out.degree = std::max(out.degree, r.degree);
      squares += share * r.rmse * r.rmse;
      out.max_error = std::max(out.max_error, r.max_error);
      left_out += share * r.cross_validation_rmse * r.cross_validation_rmse;
      smoothing += share * r.smoothing;
      out.gross_errors.insert(out.gross_errors.end(), r.gross_errors.begin(), r.gross_errors.end());
      noise_known = noise_known && r.noise.size() == noise.size();
      for (std::size_t c = 0; c < noise.size() && noise_known; ++c) noise[c] += share * r.noise[c] * r.noise[c];
      warnings.add(r.warnings);
    }
    out.method = joined({methods.begin(), methods.end()});
    out.kernel = joined({kernels.begin(), kernels.end()});
    out.samples = out.samples_fitted = work_.points;
    out.rmse = std::sqrt(squares);
    out.cross_validation_rmse = std::sqrt(left_out);
    out.smoothing = smoothing;
    if (noise_known)
      for (const double n : noise) out.noise.push_back(std::sqrt(n));
    out.axis_scales.assign(scales_.begin(), scales_.end());
    std::sort(out.gross_errors.begin(), out.gross_errors.end());
    if (!out.gross_errors.empty() && options_.fit.loss == "auto")
      out.warnings.push_back(warning_of_gross_errors(out.gross_errors, work_.points));
    warnings.append_to(out.warnings);
  }

  const std::string& samples_;
  const std::string& model_;
  const FitTileOptions& options_;
  const Index tile_points_;
  TileTeam team_;
  const TileFolder& folder_;
  SampleStream& stream_;
  Point<Dim> scales_ = Point<Dim>::Ones();
  TileWork<Dim> work_;
  std::vector<FunctionTile> tiles_;
  FitTileReport report_;
};

}  // namespace

FitTileReport fit_tiles(const std::string& samples, const std::string& model, const FitTileOptions& options) {
  check_fit_tiles(options);
  SampleStream stream(samples, options.columns, options.fit.missing);
  switch (stream.head().coordinates.rows()) {
#define CSRBF_CASE(Dim) \
  case Dim:             \
    return FunctionInTiles<Dim>(samples, model, options, stream).run();
    CSRBF_FOR_EACH_DIM(CSRBF_CASE)
#undef CSRBF_CASE
    default:
      throw InvalidInput("fit_tiles: coordinates = " + std::to_string(stream.head().coordinates.rows()) +
                         ": must be 1 to " + std::to_string(largest_dimension) + "; choose fewer");
  }
}

}  // namespace csrbf
