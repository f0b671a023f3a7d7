#include "csrbf/implicit/ridges.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/implicit/curvature.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double difference_step = 0.5;  // of the mean edge; larger: smoother lines, less accurate on fine ones
constexpr double same_direction = 0.7;   // least cosine between the principal directions of two neighbours
constexpr int newton_steps = 2;          // towards the line, from linear interpolation along an edge
// Least second derivative of the curvature k along its line of curvature, in units of k^3: less counts as constant, so
// that spheres, tubes and rounding have no ridges.
constexpr double least_bend = 1e-3;

enum class Kind { ridge = 1, valley = -1 };

// The curvature that is largest on ridges or smallest on valleys, at points; the other one; its derivative along its
// direction.
struct Extremality {
  Points<3> direction;
  Eigen::VectorXd k, other;
  Eigen::VectorXd slope;

  [[nodiscard]] bool dominates(Index i) const { return std::abs(k[i]) > std::abs(other[i]); }
};

Extremality extremality(const Field<3>& field, const PointsRef<3>& x, double step, Kind kind) {
  Curvatures at = curvature(field, x);
  const bool is_ridge = kind == Kind::ridge;
  Points<3>& direction = is_ridge ? at.direction1 : at.direction2;
  Eigen::VectorXd slope = curvature_slopes(field, x, direction, step);
  return {std::move(direction), is_ridge ? at.k1 : at.k2, is_ridge ? at.k2 : at.k1, std::move(slope)};
}

// The edges of a mesh and the three of each triangle.
struct Edges {
  std::vector<std::array<std::int32_t, 2>> ends;
  Triangles of_triangle;
};

Edges edges_of(const Mesh& mesh) {
  struct Side {
    std::array<std::int32_t, 2> ends;
    Index corner;
  };
  std::vector<Side> sides;
  sides.reserve(mesh.triangles.size());
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (Index c = 0; c < 3; ++c) {
      const auto [a, b] = std::minmax(mesh.triangles(c, t), mesh.triangles((c + 1) % 3, t));
      sides.push_back({{a, b}, 3 * t + c});
    }
  InterruptionPoint pause(1U << 13);
  std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
    pause();
    return a.ends < b.ends;
  });
  Edges edges;
  edges.of_triangle.resize(3, mesh.triangles.cols());
  for (const Side& side : sides) {
    if (edges.ends.empty() || edges.ends.back() != side.ends) edges.ends.push_back(side.ends);
    edges.of_triangle.data()[side.corner] = static_cast<std::int32_t>(edges.ends.size()) - 1;
  }
  return edges;
}

double mean_length(const Mesh& mesh, const Edges& edges) {
  double sum = 0;
  for (const auto& [a, b] : edges.ends) sum += (mesh.vertices.col(a) - mesh.vertices.col(b)).norm();
  return sum / static_cast<double>(edges.ends.size());
}

// Points where lines of one kind may cross the edges of the mesh, and for each edge its point or -1.
struct RidgeCrossings {
  Points<3> points;
  std::vector<std::int32_t> of_edge;
};

RidgeCrossings find_crossings(const Mesh& mesh, const Edges& edges, const Extremality& at) {
  RidgeCrossings found;
  found.of_edge.assign(edges.ends.size(), -1);
  std::vector<Point<3>> points;
  for (std::size_t e = 0; e < edges.ends.size(); ++e) {
    const auto [a, b] = edges.ends[e];
    if (!at.dominates(a) && !at.dominates(b)) continue;
    const double cosine = at.direction.col(a).dot(at.direction.col(b));
    if (!(std::abs(cosine) >= same_direction)) continue;
    const double ua = at.slope[a], ub = cosine < 0 ? -at.slope[b] : at.slope[b];
    if (!((ua < 0) != (ub < 0))) continue;
    const double w = ua / (ua - ub);
    found.of_edge[e] = static_cast<std::int32_t>(points.size());
    points.emplace_back((1 - w) * mesh.vertices.col(a) + w * mesh.vertices.col(b));
  }
  found.points.resize(3, std::ssize(points));
  for (Index i = 0; i < found.points.cols(); ++i) found.points.col(i) = points[i];
  return found;
}

// Moves points along the gradient towards f = level.
void project(const Field<3>& field, double level, double longest, Points<3>& x) {
  const Jet<3> jet = field.evaluate(x, Derivatives::gradient);
  for (Index i = 0; i < x.cols(); ++i) {
    const Point<3> g = jet.gradient.col(i);
    const Point<3> move = (level - jet.value[i]) / g.squaredNorm() * g;
    if (move.norm() <= longest) x.col(i) += move;
  }
}

// Extremality with the second derivative of the curvature along its line of curvature, whose sign decides.
struct Bend {
  Extremality at;
  Eigen::VectorXd second;  // derivative of the slope
};

Bend bend_at(const Field<3>& field, const Points<3>& x, double step, Kind kind) {
  Bend bend{extremality(field, x, step, kind), Eigen::VectorXd(x.cols())};
  const Points<3> reach = step * bend.at.direction;
  const Extremality ahead = extremality(field, x + reach, step, kind);
  const Extremality behind = extremality(field, x - reach, step, kind);
  for (Index i = 0; i < x.cols(); ++i) {
    const double sign_ahead = ahead.direction.col(i).dot(bend.at.direction.col(i)) < 0 ? -1 : 1;
    const double sign_behind = behind.direction.col(i).dot(bend.at.direction.col(i)) < 0 ? -1 : 1;
    bend.second[i] = (sign_ahead * ahead.slope[i] - sign_behind * behind.slope[i]) / (2 * step);
  }
  return bend;
}

// The points of the crossings that are extrema of the right kind, moved onto the line; curvature NaN for the others.
Eigen::VectorXd settle(const Field<3>& field, double level, double edge, Kind kind, Points<3>& x) {
  const double step = difference_step * edge;
  const double sign = kind == Kind::ridge ? 1 : -1;
  const Points<3> start = x;
  Bend bend;
  for (int i = 0; i <= newton_steps; ++i) {
    project(field, level, edge, x);
    bend = bend_at(field, x, step, kind);
    if (i == newton_steps) break;
    for (Index p = 0; p < x.cols(); ++p) {
      const double move = -bend.at.slope[p] / bend.second[p];
      if (std::abs(move) <= edge) x.col(p) += move * bend.at.direction.col(p);
    }
  }
  Eigen::VectorXd curvature = sign * bend.at.k;
  for (Index p = 0; p < x.cols(); ++p) {
    const double k = curvature[p];
    const bool is_line = k > std::abs(bend.at.other[p]) && -sign * bend.second[p] > least_bend * k * k * k &&
                         (x.col(p) - start.col(p)).norm() <= edge;
    if (!is_line) curvature[p] = std::numeric_limits<double>::quiet_NaN();
  }
  return sign * curvature;
}

using Segment = std::array<std::int32_t, 2>;

// Triangles that a line enters through one edge and leaves through another.
std::vector<Segment> segments_of(const Edges& edges, const RidgeCrossings& crossings, const Eigen::VectorXd& k) {
  std::vector<Segment> segments;
  for (Index t = 0; t < edges.of_triangle.cols(); ++t) {
    std::array<std::int32_t, 3> cut{};
    int count = 0;
    for (Index c = 0; c < 3; ++c) {
      const std::int32_t point = crossings.of_edge[edges.of_triangle(c, t)];
      if (point >= 0) cut[count++] = point;
    }
    if (count == 2 && std::isfinite(k[cut[0]]) && std::isfinite(k[cut[1]])) segments.push_back({cut[0], cut[1]});
  }
  return segments;
}

// The segments of lines with enough total curvature.
std::vector<Segment> strong(const std::vector<Segment>& segments, const Points<3>& x, const Eigen::VectorXd& k,
                            double least_turning) {
  DisjointSets lines(x.cols());
  for (const auto& [a, b] : segments) lines.unite(a, b);
  Eigen::VectorXd turning = Eigen::VectorXd::Zero(x.cols());
  for (const auto& [a, b] : segments)
    turning[lines.find(a)] += 0.5 * std::abs(k[a] + k[b]) * (x.col(a) - x.col(b)).norm();
  std::vector<Segment> kept;
  for (const Segment& segment : segments)
    if (turning[lines.find(segment[0])] >= least_turning) kept.push_back(segment);
  return kept;
}

void append(const std::vector<Segment>& segments, const Points<3>& x, const Eigen::VectorXd& k, Kind kind,
            Polylines& lines) {
  std::vector<std::int32_t> number(x.cols(), -1);
  const Index before = lines.vertices.cols(), edges = lines.edges.cols();
  Index count = before;
  for (const Segment& segment : segments)
    for (const std::int32_t p : segment)
      if (number[p] < 0) number[p] = static_cast<std::int32_t>(count++);
  lines.vertices.conservativeResize(3, count);
  for (Property& property : lines.properties) property.values.conservativeResize(count);
  for (Index p = 0; p < x.cols(); ++p) {
    if (number[p] < 0) continue;
    lines.vertices.col(number[p]) = x.col(p);
    lines.properties[0].values[number[p]] = static_cast<double>(kind);
    lines.properties[1].values[number[p]] = k[p];
  }
  lines.edges.conservativeResize(2, edges + std::ssize(segments));
  for (Index s = 0; s < std::ssize(segments); ++s)
    lines.edges.col(edges + s) << number[segments[s][0]], number[segments[s][1]];
}

}  // namespace

Polylines ridges(const Field<3>& field, const Mesh& mesh, const RidgeLineOptions& options) {
  require(std::isfinite(options.level), "ridges", "level", options.level, "must be finite");
  require(options.least_turning >= 0, "ridges", "least_turning", options.least_turning, "must not be negative");
  require(mesh.triangles.cols() > 0, "ridges", "triangles", mesh.triangles.cols(), "the mesh has none");
  require(mesh.triangles.minCoeff() >= 0 && mesh.triangles.maxCoeff() < mesh.vertices.cols(), "ridges",
          "largest vertex index", mesh.triangles.maxCoeff(), "indices must be in [0, number of vertices)");
  const Edges edges = edges_of(mesh);
  const double edge = mean_length(mesh, edges);
  require(edge > 0 && std::isfinite(edge), "ridges", "mean length of the edges", edge, "must be positive and finite");

  Polylines lines;
  lines.properties = {{"kind", "char", Eigen::VectorXd(0)}, {"curvature", "float", Eigen::VectorXd(0)}};
  for (const Kind kind : {Kind::ridge, Kind::valley}) {
    report(options.progress, "ridges", kind == Kind::ridge ? 0 : 0.5);
    RidgeCrossings crossings =
        find_crossings(mesh, edges, extremality(field, mesh.vertices, difference_step * edge, kind));
    const Eigen::VectorXd k = settle(field, options.level, edge, kind, crossings.points);
    const std::vector<Segment> segments = segments_of(edges, crossings, k);
    append(strong(segments, crossings.points, k, options.least_turning), crossings.points, k, kind, lines);
  }
  report(options.progress, "ridges", 1);
  return lines;
}

}  // namespace csrbf
