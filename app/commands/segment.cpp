#include "commands/formats.hpp"
#include "commands/segment_contours.hpp"
#include "commands/segment_options.hpp"
#include "report/segment_page.hpp"

#include "csrbf/implicit/preview.hpp"
#include "csrbf/io/contour_lines.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/image.hpp"
#include "csrbf/io/images/sample_codec.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/volume.hpp"

#include <algorithm>
#include <chrono>
#include <span>

namespace csrbf::app {
namespace {

void expect_outputs(const SegmentCommand& command, Session& session) {
  session.expect_output("--output", command.output,
                        is_volume_file(command.output) && file_extension(command.output) != ".ppm",
                        std::string("label images are ") + label_formats);
  if (!command.contour.empty())
    session.expect_output(
        "--contour", command.contour, is_contour_lines_file(command.contour) || is_mesh_file(command.contour),
        std::string("contours are ") + plane_contour_formats + " in the plane, " + written_mesh_formats + " in space");
  if (!command.model.empty()) session.expect_output("--model", command.model, ".csrbf", "models");
  if (!command.preview.empty()) session.expect_output("--preview", command.preview, ".png", "pictures");
}

void add_options(const SegmentCommand& command, const SegmentSettings& used, Session& session) {
  session.options = {{"output", command.output}};
  add_segment_options(command, used, session);
  session.options.update({{"contour", or_null(command.contour)},
                          {"model", or_null(command.model)},
                          {"preview", or_null(command.preview)}});
}

void add_result(const SegmentCommand& command, const SegmentReport& r, const Grid& grid, Session& session) {
  Json regions = Json::array();
  for (const RegionReport& region : r.regions)
    regions.push_back({{"label", region.label},
                       {"voxels", region.voxels},
                       {"volume", region.volume},
                       {"mean", region.mean},
                       {"sd", region.sd}});
  session.result = {{"iterations", r.iterations}, {"converged", r.converged},   {"energy", r.energy},
                    {"regions", regions},         {"components", r.components}, {"noise", r.noise}};
  if (!r.prices.empty()) {
    Json prices = Json::array();
    for (const EnergyPrice& each : r.prices)
      prices.push_back({{"energy", name_of(each.energy)}, {"shading", name_of(each.shading)}, {"nats", each.nats}});
    session.result["prices"] = prices;
  }
  if (r.speckle) session.result["speckle"] = *r.speckle;
  session.warn(r.warnings);
  session.say(command.output + ": " + size_text(grid) + " voxels in " + counted(r.options.regions, "region") +
              ", the inside in " + counted(r.components, "component"));
  session.say("energy: " + std::string(name_of(r.options.energy)) +
              (r.prices.empty() || r.options.shading == Shading::none
                   ? ""
                   : ", shading " + std::string(name_of(r.options.shading))) +
              (r.prices.empty() ? ", " : ", chosen; ") + std::string(name_of(r.options.mode)) + "; " +
              counted(r.iterations, "iteration") + (r.converged ? ", converged" : ", not converged") +
              (r.options.center_spacing ? "; centers every " + rounded(*r.options.center_spacing) + " voxels" : ""));
  constexpr Index most_lines = 5;  // of the summary; the report has every region
  for (const RegionReport& region : std::span(r.regions).first(std::min(std::ssize(r.regions), most_lines)))
    session.say("label " + std::to_string(region.label) + ": " + counted(region.voxels, "voxel") +
                (grid.dimension() == 3 ? ", volume " : ", area ") + rounded(region.volume, 6) + ", mean " +
                rounded(region.mean) + ", sd " + rounded(region.sd));
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
void run_segment(const SegmentCommand& command, SegmentOptions options, const Volume<float>& image, Session& session) {
  const Grid& grid = image.grid;
  if (!command.contour.empty()) check_contour_file(command.contour, Dim);
  session.timed("read", [&] {
    if (!command.mask.empty()) options.mask = read_voxels("--mask", command.mask, grid);
  });
  check_finite(command.input, image, options.mask);
  options.seed = session.timed("prepare", [&] { return read_seed<Dim>(command.init, grid, session.progress()); });
  const Segmentation<Dim> segmentation = timed_segment<Dim>(image, std::move(options), session);
  add_options(command, segmentation.report.options, session);
  add_result(command, segmentation.report, grid, session);
  const SegmentContours<Dim> contours(segmentation, grid, session);
  session.add_to_page([&](Page& page) {
    const auto mesh_at = [&](int resolution) { return contours.mesh(resolution); };
    show<Dim>(image, segmentation, session.result["contour"], mesh_at, page);
  });
  session.write([&] {
    write_volume(command.output, label_image(image, segmentation.labels));
    if (!command.contour.empty()) session.warn(contours.write(command.contour));
    if (!command.model.empty()) write_model(command.model, to_function(segmentation));
    if (!command.preview.empty()) write_png(command.preview, preview<Dim>(image, inside_fields(segmentation)));
  });
}

}  // namespace

void run(const SegmentCommand& command, Session& session) {
  const SegmentOptions options = make_segment_options(command);
  expect_outputs(command, session);
  const Volume<float> image = session.timed("read", [&] { return read_volume(command.input); });
  check_image(command.input, image);
  const Grid& grid = image.grid;
  session.input = {{"file", command.input},
                   {"size", grid.size},
                   {"type", sample_name(image.type)},
                   {"spacing", {grid.spacing.x(), grid.spacing.y(), grid.spacing.z()}},
                   {"origin", {grid.origin.x(), grid.origin.y(), grid.origin.z()}}};
  if (grid.dimension() == 2)
    run_segment<2>(command, options, image, session);
  else
    run_segment<3>(command, options, image, session);
}

}  // namespace csrbf::app
