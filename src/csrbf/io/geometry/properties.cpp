#include "csrbf/io/geometry/properties.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/text.hpp"

namespace csrbf {
namespace {

constexpr double brightest = 255;

// Of colours to [0, 255], by the largest of their components: above 255 they have 16 bits, and unless whole numbers are
// meant, [0, 1] is their range.
double color_scale(double largest, bool whole) {
  constexpr double per_byte = 257;
  if (largest > brightest) return 1 / per_byte;
  return whole || largest > 1 ? 1 : brightest;
}

using Spellings = std::array<std::string_view, 4>;  // in lower case; the first is the one used here

constexpr Spellings known_names[][3] = {
    {{"x", "//x", "easting", "east"}, {"y", "northing", "north"}, {"z", "height", "elevation", "altitude"}},
    {{"nx", "normal_x", "normalx"}, {"ny", "normal_y", "normaly"}, {"nz", "normal_z", "normalz"}},
    {{"red", "r", "diffuse_red"}, {"green", "g", "diffuse_green"}, {"blue", "b", "diffuse_blue"}}};

// The name with the earliest of the spellings, or none.
std::string* find_spelled(std::vector<std::string>& names, const Spellings& spellings) {
  for (const std::string_view spelling : spellings)
    for (std::string& name : names)
      if (!spelling.empty() && lower_case(name) == spelling) return &name;
  return nullptr;
}

}  // namespace

void check_properties(const std::vector<Property>& properties, Index points, const char* function) {
  for (const Property& p : properties)
    require(p.values.size() == points, function, "size of property " + p.name, p.values.size(),
            "must be " + std::to_string(points) + ", one value per point");
}

void standardize_names(std::vector<std::string>& names) {
  for (const auto& three : known_names) {
    std::array<std::string*, 3> found{};
    for (std::size_t i = 0; i < 3; ++i) found[i] = find_spelled(names, three[i]);
    if (std::count(found.begin(), found.end(), nullptr) > 0) continue;
    for (std::size_t i = 0; i < 3; ++i) *found[i] = three[i][0];
  }
}

Point<3> ColorColumns::rgb(Index i) const {
  const Point<3> color(red->values(i), green->values(i), blue->values(i));
  return (scale * color.array()).max(0).min(brightest);
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
  if (!columns.complete()) return columns;
  double largest = 0;
  for (const Property* p : {columns.red, columns.green, columns.blue})
    for (const double value : p->values) largest = std::max(largest, value);
  const std::string& type = columns.red->type;
  columns.scale = color_scale(largest, type != "float" && type != "double");
  return columns;
}

void add_colors(const Eigen::Ref<const Eigen::MatrixXd>& parts, std::vector<Property>& properties) {
  const double scale = color_scale(parts.maxCoeff<Eigen::PropagateNumbers>(), false);
  const char* names[] = {"red", "green", "blue"};
  for (int part = 0; part < 3; ++part)
    properties.push_back(
        {names[part], "uchar", (scale * parts.row(part).transpose().array()).round().max(0).min(brightest)});
}

bool are_whole_colors(const Eigen::Ref<const Eigen::MatrixXd>& parts) {
  const auto values = parts.array();
  return (values >= 0).all() && (values <= 65535).all() && (values == values.round()).all() && (values > 1).any();
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
