#include "figure_4_1.hpp"

#include "csrbf/core/mesh.hpp"
#include "csrbf/surface/reconstruct_contours.hpp"
#include "surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace csrbf::thesis {
namespace {

// Millimetres: an epicardium is about half an ellipsoid, oval and twisted.
constexpr double radius = 33, apex = 65, base = 25, slice_spacing = 9;
constexpr int slices = 10, contour_points = 48;
constexpr Index picture_side = 161;
constexpr double half_width = 48, lowest = -75, highest = 40;

double radius_at(double angle, double z) {
  const double along = z / (z < 0 ? apex : 2.5 * base), twist = 0.9 * z / apex;
  return radius * std::sqrt(std::max(0.0, 1 - along * along)) * (1 + 0.06 * std::cos(2 * (angle - twist)));
}

Polylines drawn_contours() {
  Polylines lines;
  lines.vertices.resize(3, slices * contour_points);
  lines.edges.resize(2, slices * contour_points);
  for (int k = 0; k < slices; ++k)
    for (int i = 0; i < contour_points; ++i) {
      const double angle = 2 * std::numbers::pi * i / contour_points, z = base - slice_spacing * k;
      const double r = radius_at(angle, z);
      const int at = k * contour_points + i;
      lines.vertices.col(at) << r * std::cos(angle), r * std::sin(angle), z;
      lines.edges.col(at) << at, k * contour_points + (i + 1) % contour_points;
    }
  return lines;
}

// f on the plane y = 0 (x to the right, z upwards) or z = 0 (x to the right, y upwards), rows from below.
Picture section(const Field<3>& f, const std::string& name, bool upright) {
  Points<3> x(3, picture_side * picture_side);
  for (Index i = 0; i < x.cols(); ++i) {
    const double u = static_cast<double>(i % picture_side) / (picture_side - 1),
                 v = static_cast<double>(i / picture_side) / (picture_side - 1);
    const double across = half_width * (2 * u - 1);
    if (upright)
      x.col(i) << across, 0, lowest + v * (highest - lowest);
    else
      x.col(i) << across, half_width * (2 * v - 1), 0;
  }
  return {name, picture_side, picture_side, f.evaluate(x).value};
}

}  // namespace

Figure figure_4_1() {
  Figure figure{.name = "figure-4.1",
                .title = "Figs. 3.18, 4.1: from contours on slices to an implicit surface",
                .text =
                    "Ten contours of an epicardium, made by a formula (the thesis has the hand-made ones of a "
                    "physician on magnetic resonance images), 9 mm apart; the function that reconstruct_contours() "
                    "finds on two planes, and its zero set. f > 0 inside."};
  const Polylines contours = drawn_contours();
  const Reconstruction made = reconstruct_contours(contours);
  MeasuredSurface surface;
  surface.field = made.field;
  const MeshedSurface mesh = meshed(surface);
  const Look look{{35, 20}, UpAxis::z};
  figure.renders = {{"contours (Fig. 3.18 e)", picture(PointCloud{contours.vertices, {}, {}}, look)},
                    {"implicit surface (Fig. 4.1 b)", picture(mesh.mesh, look)}};
  figure.pictures = {section(*made.field, "plane y = 0", true), section(*made.field, "plane z = 0", false)};
  double sum = 0;
  Index count = 0;
  for (const auto& p : mesh.mesh.vertices.colwise())
    if (p.z() < base && p.z() > base - slice_spacing * (slices - 1)) {
      sum += std::pow(radius_at(std::atan2(p.y(), p.x()), p.z()) - std::hypot(p.x(), p.y()), 2);
      ++count;
    }
  const double off = std::sqrt(sum / static_cast<double>(count));
  figure.claims = {{"an implicit surface through contours", "yes (picture)",
                    mesh.words() + "; rms distance " + number(made.report.rms_distance, 2) +
                        " of the diagonal from the contours, within the slices " + number(off, 2) +
                        " mm from the true surface",
                    verdict(mesh.whole() && off < 0.5)}};
  return figure;
}

}  // namespace csrbf::thesis
