#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/geometry/formats.hpp"

namespace csrbf {
namespace {

constexpr unsigned between_pauses = 1U << 13;  // points
constexpr std::size_t least_header = 227, header_of_1_4 = 375;

// Where a point format has what (ASPRS LAS 1.4 R15, tables 7 to 17); 0: nowhere.
struct RecordLayout {
  std::size_t size, classification, source, gps_time, color;
};
constexpr RecordLayout layouts[] = {{20, 15, 18, 0, 0},   {28, 15, 18, 20, 0},  {26, 15, 18, 0, 20},
                                    {34, 15, 18, 20, 28}, {57, 15, 18, 20, 0},  {63, 15, 18, 20, 28},
                                    {30, 16, 20, 22, 0},  {36, 16, 20, 22, 30}, {38, 16, 20, 22, 30},
                                    {59, 16, 20, 22, 0},  {67, 16, 20, 22, 30}};
constexpr unsigned first_long_format = 6;  // from here on, classes and returns have more bits

struct Header {
  RecordLayout layout;
  bool is_long;
  std::size_t begin, stride;  // of the records
  Index count;
  Point<3> scale, offset;
};

Header parse_header(std::string_view bytes, const std::string& name) {
  const auto fail = [&](const std::string& message) { throw IoError(name + ": " + message); };
  if (!bytes.starts_with("LASF")) fail("not a LAS file: it does not begin with LASF");
  if (bytes.size() < least_header) fail("the file is truncated: its header has 227 bytes at least");
  const auto at = [&]<class T>(std::size_t place, T /*type*/) { return load_scalar<T>(bytes.data() + place); };
  const unsigned major = at(24, std::uint8_t{}), minor = at(25, std::uint8_t{});
  if (major != 1 || minor > 4)
    fail("LAS version " + std::to_string(major) + "." + std::to_string(minor) + "; 1.0 to 1.4 can be read");
  const unsigned format = at(104, std::uint8_t{});
  constexpr unsigned compressed = 0x80;  // LASzip marks its files so
  if ((format & compressed) != 0)
    fail("its points are compressed (LAZ); convert it to .las, as by `laszip`, PDAL or CloudCompare");
  if (format >= std::size(layouts)) fail("point format " + std::to_string(format) + "; 0 to 10 can be read");

  Header header{
      layouts[format], format >= first_long_format, at(96, std::uint32_t{}), at(105, std::uint16_t{}), 0, {}, {}};
  if (header.stride < header.layout.size)
    fail("its points have " + std::to_string(header.stride) + " bytes, those of format " + std::to_string(format) +
         " have " + std::to_string(header.layout.size));
  std::uint64_t count = at(107, std::uint32_t{});
  if (minor == 4) {
    if (bytes.size() < header_of_1_4) fail("the file is truncated: a header of version 1.4 has 375 bytes");
    count = std::max(count, at(247, std::uint64_t{}));
  }
  const std::size_t room = header.begin < bytes.size() ? (bytes.size() - header.begin) / header.stride : 0;
  if (count > room)
    fail("the file is truncated: it has room for " + std::to_string(room) + " of its " + std::to_string(count) +
         " points");
  header.count = static_cast<Index>(count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.scale[static_cast<Index>(axis)] = at(131 + 8 * axis, double{});
    header.offset[static_cast<Index>(axis)] = at(155 + 8 * axis, double{});
  }
  if (!header.scale.allFinite() || !header.offset.allFinite() || (header.scale.array() == 0).any())
    fail("the scale of the coordinates is zero or not finite");
  return header;
}

bool is_withheld(const Header& header, const char* record) {
  const unsigned flags = load_scalar<std::uint8_t>(record + 15);
  return (flags & (header.is_long ? 4U : 0x80U)) != 0;
}

// The records that are not withheld.
std::vector<const char*> records_of(const Header& header, std::string_view bytes) {
  std::vector<const char*> records;
  records.reserve(static_cast<std::size_t>(header.count));
  InterruptionPoint pause(between_pauses);
  for (Index i = 0; i < header.count; ++i) {
    pause();
    const char* record = bytes.data() + header.begin + static_cast<std::size_t>(i) * header.stride;
    if (!is_withheld(header, record)) records.push_back(record);
  }
  return records;
}

template <class Value>
Property property(const std::string& name, const std::string& type, const std::vector<const char*>& records,
                  const Value& value) {
  Property result{name, type, Eigen::VectorXd(std::ssize(records))};
  for (Index i = 0; i < result.values.size(); ++i)
    result.values[i] = static_cast<double>(value(records[static_cast<std::size_t>(i)]));
  return result;
}

// Colours have 16 bits; many writers use 8 of them.
void add_las_colors(const Header& header, const std::vector<const char*>& records, std::vector<Property>& properties) {
  double largest = 0;
  std::vector<Property> colors;
  for (const char* name : {"red", "green", "blue"}) {
    const std::size_t place = header.layout.color + 2 * colors.size();
    colors.push_back(property(name, "uchar", records,
                              [&](const char* record) { return load_scalar<std::uint16_t>(record + place); }));
    if (!records.empty()) largest = std::max(largest, colors.back().values.maxCoeff());
  }
  constexpr double most = 255, per_byte = 257;
  for (Property& color : colors) {
    if (largest > most) color.values = (color.values / per_byte).array().round();
    properties.push_back(std::move(color));
  }
}

}  // namespace

PointCloud parse_las(std::string_view bytes, const std::string& name) {
  const Header header = parse_header(bytes, name);
  const std::vector<const char*> records = records_of(header, bytes);
  PointCloud cloud;
  cloud.points.resize(3, std::ssize(records));
  for (Index i = 0; i < cloud.size(); ++i)
    for (Index axis = 0; axis < 3; ++axis)
      cloud.points(axis, i) =
          header.offset[axis] +
          header.scale[axis] * load_scalar<std::int32_t>(records[static_cast<std::size_t>(i)] + 4 * axis);

  const auto add = [&](const char* what, const char* type, const auto& value) {
    cloud.properties.push_back(property(what, type, records, value));
  };
  const unsigned bits = header.is_long ? 4 : 3, mask = (1U << bits) - 1;  // of the numbers of returns
  const unsigned classes = header.is_long ? 0xFFU : 0x1FU;
  add("intensity", "ushort", [](const char* p) { return load_scalar<std::uint16_t>(p + 12); });
  add("return_number", "uchar", [&](const char* p) { return load_scalar<std::uint8_t>(p + 14) & mask; });
  add("number_of_returns", "uchar", [&](const char* p) { return (load_scalar<std::uint8_t>(p + 14) >> bits) & mask; });
  add("classification", "uchar",
      [&](const char* p) { return load_scalar<std::uint8_t>(p + header.layout.classification) & classes; });
  add("point_source_id", "ushort", [&](const char* p) { return load_scalar<std::uint16_t>(p + header.layout.source); });
  if (header.layout.gps_time > 0)
    add("gps_time", "double", [&](const char* p) { return load_scalar<double>(p + header.layout.gps_time); });
  if (header.layout.color > 0) add_las_colors(header, records, cloud.properties);
  return cloud;
}

}  // namespace csrbf
