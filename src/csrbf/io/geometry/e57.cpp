#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/geometry/formats.hpp"
#include "csrbf/io/geometry/properties.hpp"

#ifdef CSRBF_HAS_E57
#include <E57Format.h>

#include <Eigen/Geometry>
#endif

namespace csrbf {
namespace {

#ifdef CSRBF_HAS_E57

constexpr std::size_t block = std::size_t{1} << 16;  // points read at a time

double number(const e57::StructureNode& node, const std::string& name, double otherwise) {
  if (!node.isDefined(name)) return otherwise;
  const e57::Node value = node.get(name);
  try {
    return e57::FloatNode(value).value();
  } catch (const e57::E57Exception&) {  // some programs write whole numbers as such
    return static_cast<double>(e57::IntegerNode(value).value());
  }
}

// Where a scan was: from its own coordinates to those common to all.
Eigen::Isometry3d pose_of(const e57::StructureNode& scan) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (!scan.isDefined("pose")) return pose;
  const e57::StructureNode node(scan.get("pose"));
  if (node.isDefined("rotation")) {
    const e57::StructureNode q(node.get("rotation"));
    pose.linear() = Eigen::Quaterniond(number(q, "w", 1), number(q, "x", 0), number(q, "y", 0), number(q, "z", 0))
                        .normalized()
                        .matrix();
  }
  if (node.isDefined("translation")) {
    const e57::StructureNode t(node.get("translation"));
    pose.translation() << number(t, "x", 0), number(t, "y", 0), number(t, "z", 0);
  }
  return pose;
}

// The numbers of a scan: one column per name, where the scan has them.
struct ScanColumns {
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;
};

ScanColumns read_columns(e57::ImageFile& file, e57::CompressedVectorNode& points,
                         const std::vector<std::string>& wanted) {
  const e57::StructureNode prototype(points.prototype());
  ScanColumns columns;
  for (const std::string& name : wanted)
    if (prototype.isDefined(name)) columns.names.push_back(name);
  columns.values.resize(columns.names.size());
  std::vector<std::vector<double>> buffers(columns.names.size(), std::vector<double>(block));
  std::vector<e57::SourceDestBuffer> targets;
  for (std::size_t c = 0; c < columns.names.size(); ++c)
    targets.emplace_back(file, columns.names[c], buffers[c].data(), block, true, true);
  e57::CompressedVectorReader reader = points.reader(targets);
  while (const unsigned count = reader.read()) {
    stop_if_interrupted();
    for (std::size_t c = 0; c < buffers.size(); ++c)
      columns.values[c].insert(columns.values[c].end(), buffers[c].begin(), buffers[c].begin() + count);
  }
  reader.close();
  return columns;
}

const std::vector<double>* find(const ScanColumns& columns, const std::string& name) {
  for (std::size_t c = 0; c < columns.names.size(); ++c)
    if (columns.names[c] == name) return &columns.values[c];
  return nullptr;
}

// Appends the points of a scan that are valid, in the common coordinates, and their intensity and colours.
class E57Points {
 public:
  void add(const ScanColumns& columns, const Eigen::Isometry3d& pose) {
    const auto *x = find(columns, "cartesianX"), *y = find(columns, "cartesianY"), *z = find(columns, "cartesianZ");
    const auto *range = find(columns, "sphericalRange"), *azimuth = find(columns, "sphericalAzimuth"),
               *elevation = find(columns, "sphericalElevation");
    const bool is_cartesian = x != nullptr && y != nullptr && z != nullptr;
    if (!is_cartesian && (range == nullptr || azimuth == nullptr || elevation == nullptr)) return;
    const auto* invalid = find(columns, is_cartesian ? "cartesianInvalidState" : "sphericalInvalidState");
    const std::size_t count = is_cartesian ? x->size() : range->size();
    for (std::size_t i = 0; i < count; ++i) {
      if (invalid != nullptr && (*invalid)[i] != 0) continue;
      Point<3> p;
      if (is_cartesian)
        p << (*x)[i], (*y)[i], (*z)[i];
      else
        p = (*range)[i] * Point<3>(std::cos((*elevation)[i]) * std::cos((*azimuth)[i]),
                                   std::cos((*elevation)[i]) * std::sin((*azimuth)[i]), std::sin((*elevation)[i]));
      points_.push_back(pose * p);
      for (std::size_t k = 0; k < std::size(extras); ++k) {
        const auto* column = find(columns, extras[k]);
        has_[k] = has_[k] || column != nullptr;
        values_[k].push_back(column != nullptr ? (*column)[i] : 0);
      }
    }
  }

  [[nodiscard]] PointCloud cloud() const {
    PointCloud cloud;
    cloud.points.resize(3, std::ssize(points_));
    for (Index i = 0; i < cloud.size(); ++i) cloud.points.col(i) = points_[static_cast<std::size_t>(i)];
    if (has_[0]) cloud.properties.push_back({"intensity", "float", map(0)});
    if (has_[1] && has_[2] && has_[3] && cloud.size() > 0) {
      Eigen::MatrixXd colors(3, cloud.size());
      for (Index c = 0; c < 3; ++c) colors.row(c) = map(static_cast<std::size_t>(c) + 1).transpose();
      constexpr double most = 255, per_byte = 257;
      if (colors.maxCoeff() > most) colors /= per_byte;
      add_colors(colors, cloud.properties);
    }
    return cloud;
  }

  static constexpr const char* extras[] = {"intensity", "colorRed", "colorGreen", "colorBlue"};

 private:
  [[nodiscard]] Eigen::VectorXd map(std::size_t k) const {
    return Eigen::Map<const Eigen::VectorXd>(values_[k].data(), std::ssize(values_[k]));
  }

  std::vector<Point<3>> points_;
  std::array<std::vector<double>, std::size(extras)> values_;
  std::array<bool, std::size(extras)> has_{};
};

#endif

void require_e57(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("ASTM-E57")) throw IoError(name + ": not an E57 file: it does not begin with ASTM-E57");
}

}  // namespace

#ifdef CSRBF_HAS_E57

bool reads_e57() {
  return true;
}

PointCloud parse_e57(std::string_view bytes, const std::string& name) {
  require_e57(bytes, name);
  constexpr std::size_t page = 1024;  // bytes; libE57Format reads whole ones
  if (bytes.size() % page != 0)
    throw IoError(name + ": the file is truncated: it has " + std::to_string(bytes.size()) +
                  " bytes, and E57 files have pages of 1024");
  std::vector<std::string> wanted = {
      "cartesianX",     "cartesianY",       "cartesianZ",         "cartesianInvalidState",
      "sphericalRange", "sphericalAzimuth", "sphericalElevation", "sphericalInvalidState"};
  wanted.insert(wanted.end(), std::begin(E57Points::extras), std::end(E57Points::extras));
  try {
    e57::ImageFile file(bytes.data(), bytes.size());
    const e57::VectorNode scans(file.root().get("/data3D"));
    E57Points points;
    for (std::int64_t i = 0; i < scans.childCount(); ++i) {
      const e57::StructureNode scan(scans.get(i));
      e57::CompressedVectorNode compressed(scan.get("points"));
      points.add(read_columns(file, compressed, wanted), pose_of(scan));
    }
    file.close();
    return points.cloud();
  } catch (const e57::E57Exception& error) {
    throw IoError(name + ": the E57 file cannot be read: " + error.what() + " " + error.context());
  }
}

#else

bool reads_e57() {
  return false;
}

PointCloud parse_e57(std::string_view bytes, const std::string& name) {
  require_e57(bytes, name);
  throw IoError(name +
                ": this build cannot read E57; convert the file to .las or .ply, as with CloudCompare or `pdal "
                "translate a.e57 a.las`, or build csrbf where libE57Format is installed");
}

#endif

}  // namespace csrbf
