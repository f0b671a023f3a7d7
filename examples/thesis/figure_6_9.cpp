#include "figure_6_9.hpp"

#include "csrbf/spatial/voronoi_poles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace csrbf::thesis {
namespace {

constexpr Index sample_count = 60;
constexpr double a = 1.5, b = 0.8;  // semi-axes

// Places on an ellipse whose medial axis is the segment between the centres of curvature of its ends.
Points<2> ellipse(Index count) {
  Points<2> points(2, count);
  for (Index i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * (static_cast<double>(i) + 0.3) / static_cast<double>(count);
    points.col(i) << a * std::cos(angle), b * std::sin(angle);
  }
  return points;
}

double distance_to_axis(const Point<2>& p) {
  constexpr double end = (a * a - b * b) / a;
  return (p - Point<2>(std::clamp(p.x(), -end, end), 0)).norm();
}

// The larger of the distances of the negative poles to the medial axis of the ellipse.
double off_axis(const VoronoiPoles<2>& poles) {
  double largest = 0;
  for (const auto& p : poles.negative.colwise())
    if (p.allFinite()) largest = std::max(largest, std::min(distance_to_axis(p), 1e3));
  return largest;
}

// Poles inside: for samples in convex position positive and negative ones change sides with the sampling.
VoronoiPoles<2> inner(VoronoiPoles<2> poles) {
  const auto inside = [](const Point<2>& p) {
    return p.allFinite() && p.x() * p.x() / (a * a) + p.y() * p.y() / (b * b) < 1;
  };
  for (Index i = 0; i < poles.negative.cols(); ++i)
    if (!inside(poles.negative.col(i)) && inside(poles.positive.col(i))) poles.negative.col(i) = poles.positive.col(i);
  return poles;
}

}  // namespace

Figure figure_6_9() {
  Figure figure{.name = "figure-6.9",
                .title = "Fig. 6.9: Voronoi diagram, Delaunay triangulation, poles",
                .text =
                    "60 samples of an ellipse. The poles are the corners of a Voronoi cell farthest from its sample "
                    "on either side of the curve; those inside approach the medial axis of the ellipse, the segment "
                    "in the middle."};
  const Points<2> points = ellipse(sample_count);
  const VoronoiPoles<2> poles = inner(voronoi_poles<2>(points));
  Table table{.name = "samples", .columns = {"x", "y", "pole x", "pole y"}};
  for (Index i = 0; i < sample_count; ++i)
    table.rows.push_back({points(0, i), points(1, i), poles.negative(0, i), poles.negative(1, i)});
  Table distances{.name = "distance to the medial axis", .columns = {"samples", "largest distance of a pole"}};
  for (const Index n : {30, 60, 120, 240, 480})
    distances.rows.push_back({static_cast<double>(n), off_axis(inner(voronoi_poles<2>(ellipse(n))))});
  const double first = distances.rows.front()[1], last = distances.rows.back()[1];
  const Eigen::VectorXd nearest = medial_axis_distances<2>(points, poles),
                        own = (poles.negative - points).colwise().norm();
  const bool smaller = (nearest.array() <= own.array() * (1 + 1e-12)).all();
  figure.claims = {{"poles approach the medial axis as samples get denser", "yes (Amenta and Bern)",
                    "largest distance " + number(first, 2) + " with 30 samples, " + number(last, 2) + " with 480",
                    verdict(last < first / 4)},
                   {"the distance to the nearest of all poles (6.22) is at most that to the own one (6.21)", "-",
                    smaller ? "yes" : "no", verdict(smaller)}};
  figure.tables = {std::move(table), std::move(distances)};
  return figure;
}

}  // namespace csrbf::thesis
