#include "csrbf/io/images/geotiff.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/gdal/gdal.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

enum Tag : std::uint32_t {
  pixel_scale = 33550,
  tie_points = 33922,
  transformation = 34264,
  geo_keys = 34735,
  no_data = 42113
};

enum Key : std::uint16_t { model_type = 1024, raster_type = 1025, geographic_system = 2048, projected_system = 3072 };

constexpr std::uint16_t is_projected_model = 1, is_geographic_model = 2, pixel_is_area = 1, pixel_is_point = 2;
constexpr std::uint16_t user_defined = 32767;

template <class T>
std::vector<T> numbers_of(TIFF* tiff, std::uint32_t tag, TIFFDataType type) {
  const TIFFField* field = TIFFFindField(tiff, tag, TIFF_ANY);
  if (field == nullptr || TIFFFieldDataType(field) != type || TIFFFieldPassCount(field) == 0) return {};
  const void* data = nullptr;
  std::uint32_t count = 0;
  if (TIFFFieldReadCount(field) == TIFF_VARIABLE2) {
    if (TIFFGetField(tiff, tag, &count, &data) == 0) return {};
  } else {
    std::uint16_t short_count = 0;
    if (TIFFGetField(tiff, tag, &short_count, &data) == 0) return {};
    count = short_count;
  }
  if (data == nullptr) return {};
  std::vector<T> numbers(count);
  if (count > 0) std::memcpy(numbers.data(), data, count * sizeof(T));
  return numbers;
}

std::string ascii_of(TIFF* tiff, std::uint32_t tag) {
  const std::vector<char> text = numbers_of<char>(tiff, tag, TIFF_ASCII);
  return {text.begin(), std::find(text.begin(), text.end(), '\0')};
}

// The value of a short key; 0 when it is not there.
std::uint16_t key_of(const std::vector<std::uint16_t>& keys, std::uint16_t wanted) {
  constexpr std::size_t entry = 4;
  for (std::size_t at = entry; at + entry <= keys.size(); at += entry)
    if (keys[at] == wanted && keys[at + 1] == 0) return keys[at + 3];
  return 0;
}

// From (column, row, page) of the raster to the map.
std::optional<Eigen::Matrix4d> map_of(TIFF* tiff) {
  const std::vector<double> matrix = numbers_of<double>(tiff, transformation, TIFF_DOUBLE);
  if (matrix.size() == 16) return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrix.data());
  const std::vector<double> scale = numbers_of<double>(tiff, pixel_scale, TIFF_DOUBLE);
  const std::vector<double> tie = numbers_of<double>(tiff, tie_points, TIFF_DOUBLE);
  if (scale.size() < 2 || tie.size() < 6) return std::nullopt;
  const Point<3> step(scale[0], -scale[1], scale.size() > 2 ? scale[2] : 0);
  Eigen::Matrix4d map = Eigen::Matrix4d::Identity();
  for (Index a = 0; a < 3; ++a) {
    map(a, a) = step[a];
    map(a, 3) = tie[static_cast<std::size_t>(3 + a)] - step[a] * tie[static_cast<std::size_t>(a)];
  }
  return map;
}

// Half a pixel lies between the corner of the first pixel and its centre.
void place(Grid& grid, Eigen::Matrix4d map, bool points_are_centers, const std::string& name) {
  if (map(2, 2) == 0 && map.block<3, 1>(0, 2).isZero(0)) map(2, 2) = 1;
  const double half = points_are_centers ? 0 : 0.5;
  grid.origin = map.topRightCorner<3, 1>() + half * (map.block<3, 1>(0, 0) + map.block<3, 1>(0, 1));
  set_axes(grid, map.topLeftCorner<3, 3>(), name + ": the place on the map");
}

std::string crs_of(const std::vector<std::uint16_t>& keys) {
  const std::uint16_t projected = key_of(keys, projected_system), geographic = key_of(keys, geographic_system);
  const std::uint16_t code = projected != 0 ? projected : geographic;
  return code == 0 || code == user_defined ? "" : "EPSG:" + std::to_string(code);
}

struct Range {
  int first, last;
};

// EPSG codes whose kind is the same over the whole range (EPSG v10). In between both kinds occur.
constexpr Range geographic_codes[] = {{3819, 3819}, {3821, 3821}, {3824, 3824}, {3889, 3889}, {3906, 3906},
                                      {4001, 4326}, {4463, 4463}, {4470, 4470}, {4475, 4475}, {4483, 4483},
                                      {4490, 4490}, {4555, 4555}, {4558, 4558}, {4600, 4646}, {4657, 4765},
                                      {4801, 4821}, {6318, 6318}, {7844, 7844}};
constexpr Range projected_codes[] = {{2000, 3818}, {3825, 3888}, {3890, 3905}, {5041, 5042}, {20004, 32766}};

template <std::size_t Count>
bool is_in(int code, const Range (&ranges)[Count]) {
  return std::any_of(std::begin(ranges), std::end(ranges),
                     [&](const Range& range) { return code >= range.first && code <= range.last; });
}

Eigen::Matrix4d corner_map(const Grid& grid) {
  Eigen::Matrix4d map = Eigen::Matrix4d::Identity();
  map.topLeftCorner<3, 3>() = grid.direction * grid.spacing.asDiagonal();
  map.topRightCorner<3, 1>() = grid.origin - 0.5 * (map.block<3, 1>(0, 0) + map.block<3, 1>(0, 1));
  return map;
}

bool is_north_up(const Grid& grid) {
  return grid.size[2] == 1 &&
         grid.direction.topLeftCorner<2, 2>() == Eigen::Vector2d(1, -1).asDiagonal().toDenseMatrix() &&
         grid.direction.block<2, 1>(0, 2).isZero(0);
}

// Registers the tags; every page starts without them.
void know_geo_tags(TIFF* tiff) {
  static std::array<char, 5> names[] = {{"geo1"}, {"geo2"}, {"geo3"}, {"geo4"}, {"geo5"}};  // for messages of libtiff
  static const std::array<TIFFFieldInfo, 5> fields{
      TIFFFieldInfo{pixel_scale, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, names[0].data()},
      TIFFFieldInfo{tie_points, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, names[1].data()},
      TIFFFieldInfo{transformation, -1, -1, TIFF_DOUBLE, FIELD_CUSTOM, 1, 1, names[2].data()},
      TIFFFieldInfo{geo_keys, -1, -1, TIFF_SHORT, FIELD_CUSTOM, 1, 1, names[3].data()},
      TIFFFieldInfo{no_data, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, names[4].data()}};
  TIFFMergeFieldInfo(tiff, fields.data(), static_cast<std::uint32_t>(fields.size()));
}

}  // namespace

void read_geo_tags(TIFF* tiff, RawVolume& raw, const std::string& name) {
  const std::vector<std::uint16_t> keys = numbers_of<std::uint16_t>(tiff, geo_keys, TIFF_SHORT);
  if (const auto map = map_of(tiff)) place(raw.layout.grid, *map, key_of(keys, raster_type) == pixel_is_point, name);
  raw.layout.crs = crs_of(keys);
  raw.no_data = parse_number(trimmed(ascii_of(tiff, no_data)));
}

void write_geo_tags(TIFF* tiff, const VolumeLayout& layout, const std::string& name) {
  if (!is_placed(layout)) return;
  know_geo_tags(tiff);
  const Grid& grid = layout.grid;
  const Eigen::Matrix4d map = corner_map(grid);
  if (is_north_up(grid)) {
    const std::array<double, 3> scale{grid.spacing[0], grid.spacing[1], 0};
    const std::array<double, 6> tie{0, 0, 0, map(0, 3), map(1, 3), 0};
    TIFFSetField(tiff, pixel_scale, static_cast<int>(scale.size()), scale.data());
    TIFFSetField(tiff, tie_points, static_cast<int>(tie.size()), tie.data());
  } else {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = map;
    TIFFSetField(tiff, transformation, 16, rows.data());
  }
  std::vector<std::uint16_t> keys{1, 1, 0, 1, raster_type, 0, 1, pixel_is_area};
  if (!layout.crs.empty()) {
    const std::optional<int> code = epsg_code(layout.crs);
    const std::optional<bool> geographic = is_geographic(layout.crs);
    if (!code || !geographic)
      throw IoError(name + ": the reference system " + in_quotes(layout.crs) + " is not known here; " +
                    (code ? "builds with GDAL know all of EPSG" : "name it as EPSG:32633"));
    keys = {1,           1, 0, 3,
            model_type,  0, 1, *geographic ? is_geographic_model : is_projected_model,
            raster_type, 0, 1, pixel_is_area};
    for (const std::uint16_t part : {*geographic ? std::uint16_t{geographic_system} : std::uint16_t{projected_system},
                                     std::uint16_t{0}, std::uint16_t{1}, static_cast<std::uint16_t>(*code)})
      keys.push_back(part);
  }
  TIFFSetField(tiff, geo_keys, static_cast<int>(keys.size()), keys.data());
  if (is_floating(layout.type)) TIFFSetField(tiff, no_data, "nan");
}

bool is_placed(const VolumeLayout& layout) {
  const Grid& grid = layout.grid;
  return !layout.crs.empty() || !grid.origin.isZero(0) || (grid.spacing.array() != 1).any() ||
         !grid.direction.isIdentity(0);
}

std::optional<bool> is_geographic(const std::string& crs) {
  if (const std::optional<bool> known = gdal_is_geographic(crs)) return known;
  const std::optional<int> code = epsg_code(crs);
  if (!code) return std::nullopt;
  if (is_in(*code, geographic_codes)) return true;
  return is_in(*code, projected_codes) ? std::optional(false) : std::nullopt;
}

std::string format_world_file(const Grid& grid) {
  const Eigen::Matrix3d linear = grid.direction * grid.spacing.asDiagonal();
  std::string text;
  for (const double number :
       {linear(0, 0), linear(1, 0), linear(0, 1), linear(1, 1), grid.origin.x(), grid.origin.y()}) {
    append_number(text, number);
    text += '\n';
  }
  return text;
}

void parse_world_file(std::string_view text, Grid& grid, const std::string& name) {
  LineReader reader(text, name);
  std::array<double, 6> numbers{};
  for (double& number : numbers) {
    if (!reader.next()) throw IoError(name + ": a world file has six lines with a number each");
    number = reader.number(reader.line());
  }
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  linear.topLeftCorner<2, 2>() << numbers[0], numbers[2], numbers[1], numbers[3];
  grid.origin << numbers[4], numbers[5], 0;
  set_axes(grid, linear, name);
}

}  // namespace csrbf
