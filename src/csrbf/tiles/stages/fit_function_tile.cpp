#include "csrbf/tiles/stages/fit_function_tile.hpp"

#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/approx/samples/robust_weights.hpp"
#include "csrbf/approx/unity/tiled_field.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "csrbf/io/models/tile_store.hpp"
#include "csrbf/spatial/usual_extent.hpp"
#include "csrbf/tiles/folder/model_places.hpp"
#include "csrbf/tiles/stages/gather_records.hpp"
#include "csrbf/tiles/stages/sample_stream.hpp"

namespace csrbf {
namespace {

constexpr Index most_places = 60'000;  // of samples in the model: enough to say where there are some

// A field whose tiles are in the model to be written.
template <int Dim>
std::shared_ptr<const Field<Dim>> field_of_tiles(const TileWork<Dim>& work,
                                                 const std::shared_ptr<const TileStore<Dim>>& store,
                                                 typename StoredField<Dim>::Part part,
                                                 const std::vector<double>& factors) {
  std::vector<typename TiledField<Dim>::Tile> fields;
  for (Index t = 0; t < work.plan.size(); ++t)
    fields.push_back(
        {std::make_shared<const StoredField<Dim>>(store, t, part, factors[static_cast<std::size_t>(t)]), nullptr});
  return std::make_shared<const TiledField<Dim>>(work.plan, std::move(fields), work.bounds, work.spacing);
}

// Gross errors of the tile itself, by their numbers in the input; all tiles together warn of them.
template <int Dim>
void keep_own_errors(const TileWork<Dim>& work, Index tile, const Samples<Dim>& samples,
                     const std::vector<Index>& numbers, FitReport& report) {
  std::erase(report.warnings, warning_of_gross_errors(report.gross_errors, samples.size()));
  std::erase(report.warnings, warning_of_suspects(report.suspects, samples.size()));
  std::erase(report.warnings, warning_of_far_points(far_points<Dim>(samples.points), samples.size()));
  std::erase_if(report.gross_errors, [&](Index i) { return work.plan.tile_of(samples.points.col(i)) != tile; });
  for (Index& i : report.gross_errors) i = numbers[static_cast<std::size_t>(i)];
}

}  // namespace

template <int Dim>
void fit_function_tile(const TileWork<Dim>& work, const TileFolder& folder, Index tile, const FitOptions& options) {
  FunctionTile found;
  {
    Samples<Dim> samples;
    std::vector<Index> numbers;
    {
      Records<Dim> records = gather_near(work, folder, tile);
      if (work.plan.size() > 1 && has_gaps(work, tile, records)) add_far(work, folder, tile, records);
      numbers = take_numbers(records);
      samples = samples_of(records, work.notes.integer("weights") != 0);
    }
    for (Index i = 0; i < samples.size(); ++i)
      if (work.plan.tile_of(samples.points.col(i)) == tile) ++found.samples;
    FitOptions here = options;
    here.extrapolation = Extrapolation::linear;  // up to the box of all samples, which is wider than that of these
    here.missing = {};
    // Each tile would choose its own.
    here.transform = "none";
    if (work.plan.size() > 1) here.scale_axes = false;  // what the shape of a tile says about axes means nothing
    Fit<Dim> fit = csrbf::fit<Dim>(samples, here);
    fit.places = {};
    keep_own_errors(work, tile, samples, numbers, fit.report);
    samples = {};
    found.report = fit.report;
    found.has_variances = !fit.variances.empty();
    found.variance_unit = fit.variance_unit;
    write_model(folder.file("model", tile), NamedFunction{Function(std::move(fit))});
  }
  Archive archive;
  archive.kind = "function tile";
  archive.set("samples", found.samples);
  archive.set("has_variances", found.has_variances ? 1 : 0);
  archive.set("variance_unit", found.variance_unit);
  archive.set("report", report_to_archive(found.report));
  write_archive(folder.file("fit", tile), archive);
}

FunctionTile read_function_tile(const TileFolder& folder, Index tile) {
  const Archive archive = read_archive(folder.file("fit", tile));
  return {static_cast<Index>(archive.integer("samples")), report_from(archive.part("report")),
          archive.integer("has_variances") != 0, archive.number("variance_unit")};
}

template <int Dim>
void write_function(const TileWork<Dim>& work, const TileFolder& folder, const std::vector<FunctionTile>& tiles,
                    const FitReport& report, const Point<Dim>& scales, Extrapolation extrapolation,
                    const std::string& path) {
  const auto store = std::make_shared<const TileStore<Dim>>(model_places(folder, work.plan.size()));
  typename FittedField<Dim>::Frame frame;
  frame.scales = scales;
  frame.box = {work.bounds.lo.cwiseProduct(scales), work.bounds.hi.cwiseProduct(scales)};
  frame.extrapolation = extrapolation == Extrapolation::trend ? Extrapolation::linear : extrapolation;
  Points<Dim> samples = thinned_records(work, folder, most_places).matrix();
  samples.array().colwise() *= scales.array();
  if (extrapolation == Extrapolation::automatic)
    frame.rim = usual_extent<Dim>(samples) / std::pow(static_cast<double>(report.samples), 1.0 / std::min(Dim, 3));
  Fit<Dim> fit;
  fit.report = report;
  const Index components = work.notes.integer("components");
  const std::vector<double> ones(tiles.size(), 1.0);
  for (Index c = 0; c < components; ++c)
    fit.components.push_back(
        std::make_shared<const FittedField<Dim>>(field_of_tiles<Dim>(work, store, {c, false}, ones), frame));
  bool have_variances = true;
  for (const FunctionTile& tile : tiles) {
    have_variances = have_variances && tile.has_variances;
    fit.variance_unit = std::max(fit.variance_unit, tile.variance_unit);
  }
  if (have_variances) {
    std::vector<double> factors;
    factors.reserve(tiles.size());
    for (const FunctionTile& tile : tiles) factors.push_back(std::pow(tile.variance_unit / fit.variance_unit, 2));
    // Tiles know how variances grow outside of their samples.
    frame.rim.setZero();
    if (frame.extrapolation != Extrapolation::nan) frame.extrapolation = Extrapolation::trend;
    for (Index c = 0; c < components; ++c)
      fit.variances.push_back(
          std::make_shared<const FittedField<Dim>>(field_of_tiles<Dim>(work, store, {c, true}, factors), frame));
  }
  fit.places = std::make_shared<const Points<Dim>>(std::move(samples));
  const NamedFunction named{Function(std::move(fit)), texts_of(work.notes, "coordinate_name"),
                            texts_of(work.notes, "value_name"), work.notes.text("crs")};
  write_model(path, named);
}

#define CSRBF_INSTANTIATE(Dim)                                                                                 \
  template void fit_function_tile<Dim>(const TileWork<Dim>&, const TileFolder&, Index, const FitOptions&);     \
  template void write_function<Dim>(const TileWork<Dim>&, const TileFolder&, const std::vector<FunctionTile>&, \
                                    const FitReport&, const Point<Dim>&, Extrapolation, const std::string&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
