#include "csrbf/implicit/contour_lines.hpp"

#include "csrbf/implicit/curves/contour_network.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

using namespace contouring;

constexpr int largest_grid = 16384;  // cells along the longest side: 4 GB of memory in a square
// Chosen by hand.
constexpr double coincident = 1e-9;  // of a cell: closer points are merged
constexpr double steepest_arc = 1;   // largest slope against the chord: arcs that start steeper are kinks

// Adds the length and area of the arc over a chord of length c; its slope is a at the start, b at the end; up is left,
// where the inside is. With the cubic Hermite interpolant y: integral of y = c^2 / 12 (a - b), of y'^2 / 2 =
// c / 30 (2 a^2 - a b + 2 b^2).
void add_arc(double c, double a, double b, ContourLines& to) {
  const double bulge = c * c / 12 * (b - a), stretch = c / 30 * (2 * a * a - a * b + 2 * b * b);
  to.length += c + stretch;
  to.area += bulge;
  to.length_error += stretch;
  to.area_error += std::abs(bulge);
}

// Slope of the contour against the chord from its gradient; 0 where undefined.
double slope_against(const Point<2>& chord, const Point<2>& gradient) {
  const Point<2> tangent(gradient[1], -gradient[0]);
  const double along = chord.dot(tangent), across = chord[0] * tangent[1] - chord[1] * tangent[0];
  const double slope = across / along;
  if (!(along > 0)) return 0;
  return std::clamp(slope, -steepest_arc, steepest_arc);
}

class LineCollector {
 public:
  LineCollector(const Lattice& lattice, const Network& network) : lattice_(lattice), network_(network) {
    for (std::size_t a = 0; a < 2; ++a) {
      origin_[a] = 0.5 * (lattice.axes[a][0] + lattice.axes[a][lattice.cells(a)]);
      cell_[a] = lattice.axes[a][1] - lattice.axes[a][0];
    }
  }

  // Adds a closed line with its area, in parts if it may not follow the border.
  void add(const std::vector<std::int32_t>& loop, ContourEnds ends) {
    const double before = found_.area;
    bool touches_border = false;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      measure_segment(loop[k], loop[(k + 1) % loop.size()]);
      touches_border = touches_border || network_.on_border(loop[k]);
    }
    if (ends == ContourEnds::closed || !touches_border) {
      for (const std::int32_t v : loop)
        if (!network_.on_border(v) || is_corner_of_box(v)) append(position(v));
      finish({.closed = true, .area = found_.area - before});
      return;
    }
    const auto at_border = [&](std::int32_t v) { return network_.on_border(v); };
    const Index first = std::find_if(loop.begin(), loop.end(), at_border) - loop.begin();
    for (Index k = 1; k <= std::ssize(loop); ++k) {
      const std::int32_t v = loop[(first + k) % std::ssize(loop)];
      if (!network_.on_border(v))
        append(position(v));
      else
        finish({.closed = false});
    }
  }

  ContourLines result() {
    found_.points = Eigen::Map<const Points<2>>(coordinates_.data(), 2, size());
    return std::move(found_);
  }

 private:
  [[nodiscard]] const EdgeRoot& root(std::int32_t v) const { return network_.roots[v]; }
  [[nodiscard]] Index border_corner(std::int32_t v) const {
    return network_.border_corners[static_cast<std::size_t>(v) - network_.roots.size()];
  }
  [[nodiscard]] Point<2> position(std::int32_t v) const {
    return network_.on_border(v) ? lattice_.position(border_corner(v)) : root(v).position();
  }
  [[nodiscard]] bool is_corner_of_box(std::int32_t v) const {
    const Index corner = border_corner(v), i = corner % lattice_.axes[0].size(), j = corner / lattice_.axes[0].size();
    return (i == 0 || i == lattice_.cells(0)) && (j == 0 || j == lattice_.cells(1));
  }

  void measure_segment(std::int32_t u, std::int32_t v) {
    const Point<2> p = position(u) - origin_, q = position(v) - origin_;
    found_.area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
    if (network_.on_border(u) || network_.on_border(v)) return;
    const Point<2> chord = q - p;
    add_arc(chord.norm(), slope_against(chord, root(u).gradient), slope_against(chord, root(v).gradient), found_);
  }

  [[nodiscard]] Point<2> point(Index i) const { return {coordinates_[2 * i], coordinates_[2 * i + 1]}; }
  [[nodiscard]] Index size() const { return std::ssize(coordinates_) / 2; }
  [[nodiscard]] bool coincide(const Point<2>& p, const Point<2>& q) const {
    return ((p - q).array().abs() <= coincident * cell_.array()).all();
  }

  void append(const Point<2>& p) {
    if (size() > begin_ && coincide(p, point(size() - 1))) return;
    coordinates_.insert(coordinates_.end(), {p[0], p[1]});
  }

  // The points since the last line become one, unless they are a point or a straight segment back and forth.
  void finish(ContourLine line) {
    while (line.closed && size() - 1 > begin_ && coincide(point(begin_), point(size() - 1)))
      coordinates_.resize(coordinates_.size() - 2);
    line.begin = begin_;
    line.size = size() - begin_;
    if (line.size >= (line.closed ? 3 : 2))
      found_.lines.push_back(line);
    else
      coordinates_.resize(2 * begin_);
    begin_ = size();
  }

  const Lattice& lattice_;
  const Network& network_;
  Point<2> origin_, cell_;
  ContourLines found_;
  std::vector<double> coordinates_;
  Index begin_ = 0;
};

ContourLines collect(const Lattice& lattice, const Network& network, ContourEnds ends) {
  LineCollector collector(lattice, network);
  std::vector<bool> visited(network.next.size(), false);
  std::vector<std::int32_t> loop;
  for (std::size_t first = 0; first < network.next.size(); ++first) {
    loop.clear();
    for (std::size_t v = first; !visited[v]; v = static_cast<std::size_t>(network.next[v])) {
      visited[v] = true;
      loop.push_back(static_cast<std::int32_t>(v));
    }
    if (!loop.empty()) collector.add(loop, ends);
  }
  return collector.result();
}

Box<2> checked_bounds(const Field<2>& field, int resolution, const Box<2>& given) {
  require(resolution >= 0 && resolution <= largest_grid, "contour_lines", "resolution", resolution,
          "must be between 1 and 16384 cells along the longest side, or 0 for automatic");
  const bool own = given.lo == Box<2>().lo && given.hi == Box<2>().hi;
  Box<2> bounds = own ? field.bounds() : given;
  require(!bounds.empty() && bounds.extent().allFinite() && bounds.extent().minCoeff() > 0, "contour_lines",
          own ? "field.bounds()" : "bounds",
          bounds.extent().transpose().format(Eigen::IOFormat(Eigen::StreamPrecision, 0, " x ")),
          own ? "must have positive, finite extent along both axes; give bounds in the options"
              : "must have positive, finite extent along both axes; leave them out for those of the field");
  return bounds;
}

// The values of the field at the corners of the cells.
Lattice make_lattice(const Field<2>& field, int given, const Box<2>& box) {
  const Box<2> bounds = checked_bounds(field, given, box);
  const int resolution = given > 0 ? given : automatic_resolution(field);
  const double size = bounds.extent().maxCoeff() / resolution;
  Lattice lattice;
  for (Index a = 0; a < 2; ++a) {
    const Index cells = std::max<Index>(1, std::llround(bounds.extent()[a] / size));
    lattice.axes[a] = Eigen::VectorXd::LinSpaced(cells + 1, bounds.lo[a], bounds.hi[a]);
  }
  lattice.value = field.evaluate_grid(lattice.axes);
  for (Index c = 0; c < lattice.value.size(); ++c)
    if (!std::isfinite(lattice.value[c])) refuse(lattice.value[c], lattice.position(c));
  return lattice;
}

std::vector<double> checked_levels(const LevelLinesOptions& options, double lo, double hi) {
  constexpr std::size_t most = 10000;
  constexpr double usual = 10;
  require(options.step >= 0 && std::isfinite(options.step), "level_lines", "step", options.step,
          "must be positive, or 0 for automatic");
  require(options.step == 0 || options.levels.empty(), "level_lines", "step", options.step, "levels are given as well");
  if (!options.levels.empty()) {
    require(options.levels.size() <= most, "level_lines", "levels", options.levels.size(),
            "at most 10000 are possible");
    for (std::size_t i = 0; i < options.levels.size(); ++i)
      require(std::isfinite(options.levels[i]) && (i == 0 || options.levels[i] > options.levels[i - 1]), "level_lines",
              "levels", options.levels[i], "must be finite and ascending");
    return options.levels;
  }
  if (!(hi > lo)) return {};
  double step = options.step;
  if (step == 0) {
    const double wanted = (hi - lo) / usual, power = std::pow(10, std::floor(std::log10(wanted)));
    for (const double factor : {1, 2, 5, 10}) {
      step = factor * power;
      if (step >= wanted) break;
    }
  }
  const double first = std::ceil(lo / step), last = std::floor(hi / step);
  require(last - first < static_cast<double>(most), "level_lines", "step", step,
          "makes more than 10000 levels between the smallest and the largest value");
  const double per_unit = std::round(1 / step);  // 3 / 10 is 0.3, 3 * 0.1 is not
  const bool divides = per_unit > 1 && std::abs(per_unit * step - 1) < 1e-12;
  std::vector<double> levels;
  for (double k = first; k <= last; ++k) levels.push_back(divides ? k / per_unit : k * step);
  return levels;
}

// The runs of points that are wanted, as open lines.
void add_wanted(const LevelLine& line, const std::vector<bool>& wanted, std::vector<LevelLine>& to) {
  const Index n = line.points.cols();
  const Index unwanted = std::find(wanted.begin(), wanted.end(), false) - wanted.begin();
  if (unwanted == n) return to.push_back(line);
  std::vector<Index> run;
  const auto finish = [&] {
    if (run.size() > 1) to.push_back({line.level, false, line.points(Eigen::all, run)});
    run.clear();
  };
  // A closed line is followed from a point that is not wanted, to which it comes back.
  const Index start = line.closed ? unwanted : 0;
  for (Index k = 0; k < n; ++k) {
    const Index i = (start + k) % n;
    if (wanted[static_cast<std::size_t>(i)])
      run.push_back(i);
    else
      finish();
  }
  finish();
}

}  // namespace

int automatic_resolution(const Field<2>& field) {
  constexpr double fewest = 32, most = 2048;  // enough for any shape, at most a few seconds; chosen by hand
  constexpr int unknown = 256;                // a compromise
  const double cells = field.bounds().extent().maxCoeff() / field.feature_size();
  return std::isfinite(cells) && cells > 0 ? static_cast<int>(std::clamp(std::ceil(cells), fewest, most)) : unknown;
}

ContourLines contour_lines(const Field<2>& field, const ContourLinesOptions& options) {
  require(std::isfinite(options.level), "contour_lines", "level", options.level, "must be finite");
  report(options.progress, "contour lines", 0);
  Lattice lattice = make_lattice(field, options.resolution, options.bounds);
  lattice.value.array() -= options.level;
  report(options.progress, "contour lines", 0.5);
  Network network = make_network(lattice);
  solve_roots(field, options.level, network.roots);
  report(options.progress, "contour lines", 0.9);
  ContourLines contours = collect(lattice, network, options.ends);
  report(options.progress, "contour lines", 1);
  return contours;
}

std::vector<LevelLine> level_lines(const Field<2>& field, const LevelLinesOptions& options) {
  report(options.progress, "contour lines", 0);
  Lattice lattice = make_lattice(field, options.resolution, options.bounds);
  const Eigen::VectorXd values = lattice.value;
  const std::vector<double> levels = checked_levels(options, values.minCoeff(), values.maxCoeff());
  std::vector<LevelLine> lines;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    report(options.progress, "contour lines", 0.5 + 0.5 * static_cast<double>(k) / static_cast<double>(levels.size()));
    lattice.value = values.array() - levels[k];
    Network network = make_network(lattice);
    solve_roots(field, levels[k], network.roots);
    const ContourLines contours = collect(lattice, network, ContourEnds::open);
    const std::vector<bool> wanted = options.wanted
                                         ? options.wanted(contours.points)
                                         : std::vector<bool>(static_cast<std::size_t>(contours.points.cols()), true);
    for (const ContourLine& line : contours.lines)
      add_wanted({levels[k], line.closed, contours.points.middleCols(line.begin, line.size)},
                 {wanted.begin() + line.begin, wanted.begin() + line.begin + line.size}, lines);
  }
  report(options.progress, "contour lines", 1);
  return lines;
}

Polylines to_polylines(const ContourLines& contours, const Eigen::Matrix<double, 3, 4>& placement) {
  Polylines lines;
  const Index n = contours.points.cols();
  Points<3> flat = Points<3>::Zero(3, n);
  flat.topRows<2>() = contours.points;
  lines.vertices = Eigen::Affine3d(placement) * flat;
  lines.properties = {{"contour", "int", Eigen::VectorXd(n)}};
  Index edges = 0;
  for (const ContourLine& line : contours.lines) edges += line.closed ? line.size : line.size - 1;
  lines.edges.resize(2, edges);
  Index e = 0;
  double number = 0;
  for (const ContourLine& line : contours.lines) {
    const Index end = line.begin + line.size;
    for (Index i = line.begin; i < end; ++i) {
      const Index to = i + 1 < end ? i + 1 : line.begin;
      if (to > i || line.closed) lines.edges.col(e++) << static_cast<std::int32_t>(i), static_cast<std::int32_t>(to);
    }
    lines.properties[0].values.segment(line.begin, line.size).setConstant(number++);
  }
  return lines;
}

Polylines to_polylines(const std::vector<LevelLine>& lines) {
  ContourLines all;
  Index size = 0;
  for (const LevelLine& line : lines) {
    all.lines.push_back({.begin = size, .size = line.points.cols(), .closed = line.closed});
    size += line.points.cols();
  }
  all.points.resize(2, size);
  Eigen::RowVectorXd levels(size);
  for (std::size_t n = 0; n < lines.size(); ++n) {
    all.points.middleCols(all.lines[n].begin, all.lines[n].size) = lines[n].points;
    levels.segment(all.lines[n].begin, all.lines[n].size).setConstant(lines[n].level);
  }
  Polylines result = to_polylines(all);
  result.vertices.row(2) = levels;
  return result;
}

}  // namespace csrbf
