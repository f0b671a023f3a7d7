#include "csrbf/io/geometry/properties.hpp"

#include "csrbf/core/error.hpp"

namespace csrbf {
namespace {

constexpr double brightest = 255;

// Colours of floating-point type are in [0, 1].
double byte_of(const Property& p, Index i) {
  const bool unit = p.type == "float" || p.type == "double";
  return std::clamp(unit ? brightest * p.values(i) : p.values(i), 0.0, brightest);
}

}  // namespace

void check_properties(const std::vector<Property>& properties, Index points, const char* function) {
  for (const Property& p : properties)
    require(p.values.size() == points, function, "size of property " + p.name, p.values.size(),
            "must be " + std::to_string(points) + ", one value per point");
}

Point<3> ColorColumns::rgb(Index i) const {
  return {byte_of(*red, i), byte_of(*green, i), byte_of(*blue, i)};
}

Point<3> ColorColumns::unit_rgb(Index i) const {
  constexpr double steps = 1e4;  // per unit: four digits, more than 8 bits need
  return (rgb(i).array() / brightest * steps).round() / steps;
}

ColorColumns find_colors(const std::vector<Property>& properties) {
  ColorColumns columns;
  for (const Property& p : properties) {
    if (p.name == "red") columns.red = &p;
    if (p.name == "green") columns.green = &p;
    if (p.name == "blue") columns.blue = &p;
  }
  return columns;
}

void add_colors(const Eigen::Ref<const Eigen::MatrixXd>& parts, std::vector<Property>& properties) {
  const double scale = (parts.array() > 1).any() ? 1 : brightest;
  const char* names[] = {"red", "green", "blue"};
  for (int part = 0; part < 3; ++part)
    properties.push_back(
        {names[part], "uchar", (scale * parts.row(part).transpose().array()).round().max(0).min(brightest)});
}

bool are_byte_colors(const Eigen::Ref<const Eigen::MatrixXd>& parts) {
  const auto values = parts.array();
  return (values >= 0).all() && (values <= brightest).all() && (values == values.round()).all() && (values > 1).any();
}

double float_coordinate_loss(const PointsRef<3>& points) {
  Box<3> box;
  double moved = 0;
  for (const auto& point : points.colwise())
    for (int axis = 0; axis < 3; ++axis) {
      const double x = point(axis);
      if (!std::isfinite(x)) continue;
      box.lo(axis) = std::min(box.lo(axis), x);
      box.hi(axis) = std::max(box.hi(axis), x);
      moved = std::max(moved, std::abs(x - static_cast<double>(narrow_scalar<float>(x))));
    }
  constexpr double allowed = 1e-6;  // of the diagonal, chosen by hand; smaller: more files in double precision
  if (box.empty()) return 0;
  // Scaled first: the square of the extent may overflow.
  return moved > (allowed * box.hi - allowed * box.lo).stableNorm() ? moved : 0;
}

}  // namespace csrbf
