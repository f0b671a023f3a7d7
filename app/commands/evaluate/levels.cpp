#include "commands/evaluate/levels.hpp"

#include "report/image_page.hpp"

#include "csrbf/io/contour_lines.hpp"
#include "csrbf/io/files/read_file.hpp"

#include <algorithm>

namespace csrbf::app {
namespace {

constexpr std::string_view by_step = "every:";

// The levels or the step that --levels gives, or neither.
LevelLinesOptions parse_levels(const std::string& text) {
  LevelLinesOptions options;
  if (text == about_ten_levels) return options;
  if (text.starts_with(by_step)) {
    options.step = parse_numbers(text.substr(by_step.size()), ',', 1, "--levels " + text + ":")[0];
    if (!(options.step > 0)) throw UsageError("--levels " + text + ": expected a positive step, as --levels every:10");
    return options;
  }
  const Eigen::VectorXd levels = parse_list(text, ',', "--levels");
  options.levels.assign(levels.begin(), levels.end());
  std::sort(options.levels.begin(), options.levels.end());
  options.levels.erase(std::unique(options.levels.begin(), options.levels.end()), options.levels.end());
  return options;
}

// Pairs of ends for a picture: of many points, every few.
Points<2> segments_of(std::vector<LevelLine> lines, Index points) {
  constexpr Index most = 40000;
  const Index stride = 1 + points / most;
  for (LevelLine& line : lines) {
    std::vector<Index> kept;
    const Index last = line.points.cols() - 1;
    for (Index i = 0; i < last; i += stride) kept.push_back(i);
    kept.push_back(last);
    line.points = Points<2>(line.points(Eigen::all, kept));
  }
  const Polylines curves = to_polylines(lines);
  return curves.vertices.topRows<2>()(Eigen::all, curves.edges.reshaped());
}

}  // namespace

void check_levels(EvaluateCommand& command) {
  (void)parse_levels(command.levels);
  if (!command.points.empty() || !command.like.empty())
    throw UsageError("--levels: contour lines are found on a grid; give --grid instead of --points and --like");
  if (command.gradient || command.hessian || command.standard_deviation || command.labels || command.float32)
    throw UsageError(
        "--levels: contour lines have no other columns; leave out --gradient, --hessian, --standard-deviation, "
        "--labels and --float32");
  if (!is_level_lines_file(command.output))
    throw UsageError("--output " + command.output +
                     ": contour lines go to .csv .ply .vtp, or .gpkg .shp .geojson .fgb");
  if (command.grid.empty() && command.cell.empty() && command.extent.empty()) command.grid = grid_without_numbers;
  check_grid(command);
}

void write_levels(const EvaluateCommand& command, const NamedFunction& model, const Places& places, Session& session) {
  const Function& f = model.function;
  if (f.dimension() != 2 || f.components() != 1)
    throw UsageError("--levels: contour lines are those of one value over two variables; the model has " +
                     counted(f.components(), "value") + " over " + std::to_string(f.dimension()));
  if (const std::vector<int>& drift = f.report().drift_axes; !drift.empty())
    throw UsageError("--levels: contour lines are those over two coordinates; " +
                     model.coordinate_names[static_cast<std::size_t>(drift.front())] + " is a covariate of the model");
  LevelLinesOptions options = parse_levels(command.levels);
  options.progress = session.progress();
  for (Index a = 0; a < 2; ++a) {
    const Eigen::VectorXd& nodes = places.axes[static_cast<std::size_t>(a)];
    options.bounds.lo[a] = nodes[0];
    options.bounds.hi[a] = nodes[nodes.size() - 1];
    options.resolution = std::max(options.resolution, static_cast<int>(nodes.size()) - 1);
  }
  if (!command.mask.empty())
    options.wanted = [&](const PointsRef<2>& points) { return f.covered(points, mask_of(command.mask)); };
  const std::vector<LevelLine> lines =
      session.timed("evaluate", [&] { return level_lines(*f.fit<2>().components.front(), options); });

  Index points = 0;
  std::vector<double> levels;
  for (const LevelLine& line : lines) {
    points += line.points.cols();
    if (levels.empty() || levels.back() != line.level) levels.push_back(line.level);
  }
  session.result = {{"lines", lines.size()}, {"points", points}, {"levels", levels}};
  if (lines.empty())
    session.warn("no contour lines: the function does not take these levels on the grid" +
                 std::string(command.mask.empty() ? "" : ", where the mask wants values"));
  session.say(command.output + ": " + counted(std::ssize(lines), "contour line") + " at " +
              counted(std::ssize(levels), "level") +
              (levels.empty() ? "" : ", from " + readable(levels.front()) + " to " + readable(levels.back())));
  session.add_to_page([&](Page& page) {
    page.facts = {{grouped(std::ssize(lines)), "contour lines"}, {grouped(std::ssize(levels)), "levels"}};
    show_values(f.evaluate_grid(places.axes).col(0).transpose(), places.axes, model.coordinate_names,
                model.value_names.front(), page, segments_of(lines, points));
  });
  session.write([&] {
    write_level_lines(command.output, lines,
                      {{model.coordinate_names[0], model.coordinate_names[1]}, model.value_names[0], places.crs});
  });
}

}  // namespace csrbf::app
