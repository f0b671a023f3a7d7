#include "csrbf/io/samples.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/table.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/gdal/gdal.hpp"
#include "csrbf/io/volume.hpp"

#include <numeric>

namespace csrbf {
namespace {

std::string listed(const std::vector<std::string>& words) {
  std::vector<std::string> quoted;
  for (const std::string& word : words) quoted.push_back(in_quotes(word));
  return joined(quoted);
}

Table table_of(const NpyArray& array, const std::string& name) {
  if (array.shape.size() != 2 || array.shape[0] == 0)
    throw IoError(name + ": the array has " + std::to_string(array.shape.size()) +
                  " axes or no rows, samples need an (n, d+1) array of one row per sample");
  Table table;
  table.values = Eigen::Map<const Eigen::MatrixXd>(array.values.data(), array.shape[1], array.shape[0]);
  return table;
}

// A table, and what of it counts as coordinates and values by default: all but the last column, and that one, unless
// said otherwise.
struct Source {
  Table table;
  std::string crs;
  std::vector<Index> coordinates, values;
};

constexpr const char* table_formats = ".csv .txt .tsv .dat .xyz .npy";
constexpr const char* other_formats = " .ply .pts .obj .off .vtp .stl .las .laz .e57 .pcd .ptx";

// z over x and y.
Source source_of(const PointCloud& all, const PointSelection& selection) {
  const PointCloud cloud = select_points(all, selection);
  Source source{{}, "", {0, 1}, {2}};
  source.table.names = {"x", "y", "z"};
  source.table.values.resize(3 + std::ssize(cloud.properties), cloud.size());
  source.table.values.topRows(3) = cloud.points;
  for (Index p = 0; p < std::ssize(cloud.properties); ++p) {
    const Property& property = cloud.properties[static_cast<std::size_t>(p)];
    source.table.names.push_back(property.name);
    source.table.values.row(3 + p) = property.values.transpose();
  }
  return source;
}

// The last field over x and y.
Source source_of_map(const std::string& path) {
  Source source;
  source.table = read_gdal_table(path, source.crs);
  source.coordinates = {0, 1};
  source.values = {source.table.values.rows() - 1};
  if (source.table.values.rows() < 3) throw IoError(path + ": the points have neither a numeric field nor a height");
  return source;
}

// One row per pixel, with the coordinates of its centre.
Source source_of_image(const std::string& path) {
  const Volume<double> image = read_volume<double>(path);
  const Index d = image.grid.dimension() > 2 ? 3 : 2;
  if (image.frames > 1) throw IoError(path + ": samples of a sequence of images are not supported");
  Source source;
  source.crs = image.crs;
  source.table.names = default_coordinate_names(d);
  for (const std::string& name : default_value_names(image.components)) source.table.names.push_back(name);
  source.table.values.resize(d + image.components, image.grid.voxels());
  const Points<3> centers = image.grid.centers<3>();
  source.table.values.topRows(d) = centers.topRows(d);
  source.table.values.bottomRows(image.components) = image.frame();
  for (Index c = 0; c < d + image.components; ++c) (c < d ? source.coordinates : source.values).push_back(c);
  return source;
}

bool is_image_of_samples(const std::string& path) {
  const std::string extension = content_extension(path);
  return extension != ".npy" && is_readable_volume(path) && !is_picture_file(path);
}

Source read_source(const std::string& path, const PointSelection& selection) {
  const std::string extension = content_extension(path);
  const auto expect_all = [&] {
    if (!selection.is_all()) throw IoError(path + ": only points of a scanner have classes and returns");
  };
  if (is_gdal_table(extension)) {
    expect_all();
    return source_of_map(path);
  }
  if (path != "-" && !extension.empty() && !is_listed(extension, table_formats)) {
    if (is_readable_point_file(path)) return source_of(read_points(path), selection);
    if (is_image_of_samples(path)) {
      expect_all();
      return source_of_image(path);
    }
  }
  const std::string name = display_name(path);
  const Content content =
      read_with_format(path, std::string(table_formats) + other_formats, ".csv", "files of samples");
  if (!selection.is_all() || !is_listed(content.extension, table_formats))
    return source_of(parse_points(content.extension, content.bytes, name), selection);
  if (content.extension == ".npy") return {table_of(parse_npy(content.bytes, name), name), "", {}, {}};
  return {parse_table(content.bytes, name, TextCells::note), "", {}, {}};
}

class ColumnPicker {
 public:
  ColumnPicker(const Table& table, std::string name)
      : table_(table), name_(std::move(name)), used_(table.values.rows(), false) {}

  // The columns of a list of names and numbers, which count as used from now on.
  std::vector<Index> take(std::string_view list) {
    std::vector<Index> columns;
    while (!trimmed(list).empty()) {
      const std::size_t comma = std::min(list.find(','), list.size());
      columns.push_back(take_one(trimmed(list.substr(0, comma))));
      list.remove_prefix(std::min(list.size(), comma + 1));
    }
    return columns;
  }

  // The same, but they do not count as used.
  [[nodiscard]] std::vector<Index> find(std::string_view list) const {
    ColumnPicker other(table_, name_);
    return other.take(list);
  }

  // Those of the columns that are not used yet.
  std::vector<Index> take_free(const std::vector<Index>& wanted) {
    std::vector<Index> columns;
    for (const Index i : wanted)
      if (!used(i)) {
        use(i);
        columns.push_back(i);
      }
    return columns;
  }

  // All unused columns, or the last of them.
  std::vector<Index> take_rest() {
    std::vector<Index> columns;
    for (Index i = 0; i < size(); ++i)
      if (!used(i)) columns.push_back(i);
    for (const Index i : columns) use(i);
    return columns;
  }
  std::vector<Index> take_last() {
    for (Index i = size() - 1; i >= 0; --i)
      if (!used(i)) {
        use(i);
        return {i};
      }
    return {};
  }

  // Throws when one of the columns holds text.
  void check_numbers(const std::vector<Index>& columns) const {
    for (const TextCell& cell : table_.text_cells)
      if (std::find(columns.begin(), columns.end(), cell.column) != columns.end())
        throw IoError(name_ + ":" + std::to_string(cell.line) + ": " + in_quotes(cell.text) +
                      " is not a number (column " + std::to_string(cell.column + 1) + ")");
  }

 private:
  [[nodiscard]] Index size() const { return table_.values.rows(); }
  [[nodiscard]] bool used(Index column) const { return used_[column]; }
  void use(Index column) { used_[column] = true; }

  Index take_one(std::string_view word) {
    const auto found = std::find(table_.names.begin(), table_.names.end(), word);
    const auto number = parse_integer(word);
    Index column = 0;
    if (found != table_.names.end())
      column = found - table_.names.begin();
    else if (number && *number >= 1 && *number <= size())
      column = static_cast<Index>(*number) - 1;
    else if (number)
      throw IoError(name_ + ": there is no column " + in_quotes(word) + "; the file has " + std::to_string(size()) +
                    " columns");
    else
      throw IoError(name_ + ": no column is named " + in_quotes(word) + "; " + did_you_mean(word, table_.names) +
                    (table_.names.empty()
                         ? "the columns have no names, give numbers from 1 to " + std::to_string(size())
                         : "the columns are " + listed(table_.names)));
    if (used(column)) throw IoError(name_ + ": column " + in_quotes(word) + " is used twice");
    use(column);
    return column;
  }

  const Table& table_;
  std::string name_;
  std::vector<bool> used_;
};

std::vector<std::string> numbered(const std::string& stem, Index count) {
  std::vector<std::string> names;
  for (Index i = 1; i <= count; ++i) names.push_back(stem + std::to_string(i));
  return names;
}

std::vector<std::string> names_of(const Table& table, const std::vector<Index>& columns,
                                  const std::vector<std::string>& defaults) {
  if (table.names.empty()) return defaults;
  std::vector<std::string> names;
  for (const Index column : columns) names.push_back(table.names[column]);
  return names;
}

// Rows in which all used numbers are finite.
std::vector<Index> complete_rows(const Table& table, const std::vector<Index>& used) {
  std::vector<Index> rows;
  for (Index row = 0; row < table.values.cols(); ++row)
    if (std::all_of(used.begin(), used.end(), [&](Index c) { return std::isfinite(table.values(c, row)); }))
      rows.push_back(row);
  return rows;
}

// A column among these whose name or content says that it only numbers the rows; empty when there is none. The only
// coordinate of equidistant samples may be their number.
std::string row_number_among(const Table& table, const std::vector<Index>& columns) {
  constexpr std::string_view names = "id fid oid objectid index idx nr no row number point_id pointid station_id gid";
  constexpr Index enough = 5;  // rows
  for (const Index column : columns) {
    const bool has_name = !table.names.empty();
    const std::string name = has_name ? table.names[static_cast<std::size_t>(column)] : "";
    if (has_name && is_listed(lower_case(name), names)) return name;
    const Index rows = table.values.cols();
    if (columns.size() < 2 || rows < enough) continue;
    const double first = table.values(column, 0);
    bool counts = (first == 0 || first == 1) && !(has_name && is_listed(lower_case(name), "x y z t time lon lat"));
    for (Index row = 0; counts && row < rows; ++row)
      counts = table.values(column, row) == first + static_cast<double>(row);
    if (counts) return has_name ? name : "number " + std::to_string(column + 1);
  }
  return "";
}

void check_weights(const Eigen::VectorXd& weights, const std::vector<Index>& rows, const std::string& name) {
  for (Index i = 0; i < weights.size(); ++i)
    if (!(weights(i) >= 0))
      throw IoError(name + ": row " + std::to_string(rows[i] + 1) + " has the weight " + std::to_string(weights(i)) +
                    "; weights must not be negative");
}

SampleTable samples_of(const Source& source, const std::string& name, const SampleColumns& columns) {
  const Table& table = source.table;
  ColumnPicker picker(table, name);
  const std::vector<Index> weights = picker.take(columns.weights);
  if (weights.size() > 1) throw IoError(name + ": weights must be one column, found " + in_quotes(columns.weights));
  const std::vector<Index> drift = picker.take(columns.drift);
  const std::vector<Index> derivatives = picker.take(columns.derivatives);
  std::vector<Index> values = picker.take(columns.values);
  std::vector<Index> coordinates = picker.take(columns.coordinates);
  if (values.empty()) values = picker.take_free(source.values);
  if (coordinates.empty()) coordinates = picker.take_free(source.coordinates);
  if (values.empty()) values = picker.take_last();
  if (coordinates.empty()) coordinates = picker.take_rest();
  if (values.empty() || coordinates.empty())
    throw IoError(name + ": samples need one column of coordinates and one of values at least, the file has only " +
                  std::to_string(table.values.rows()));
  if (!derivatives.empty() && derivatives.size() != coordinates.size() * values.size())
    throw IoError(name + ": found " + std::to_string(derivatives.size()) + " columns of derivatives, " +
                  in_quotes(columns.derivatives) + "; there must be one for each of " + std::to_string(values.size()) +
                  " values by each of " + std::to_string(coordinates.size()) + " coordinates");
  picker.check_numbers(derivatives);
  std::vector<int> sphere;
  for (const Index column : picker.find(columns.sphere)) {
    const auto found = std::find(coordinates.begin(), coordinates.end(), column);
    if (found == coordinates.end())
      throw IoError(name + ": the columns of a sphere, " + in_quotes(columns.sphere) + ", must be coordinates");
    sphere.push_back(static_cast<int>(found - coordinates.begin()));
  }
  coordinates.insert(coordinates.end(), drift.begin(), drift.end());
  std::vector<Index> used = coordinates;
  used.insert(used.end(), values.begin(), values.end());
  used.insert(used.end(), weights.begin(), weights.end());
  picker.check_numbers(used);

  const std::vector<Index> rows = complete_rows(table, used);
  if (rows.empty()) throw IoError(name + ": no row has a finite number in every column that is used");
  SampleTable samples;
  samples.sphere = std::move(sphere);
  for (std::size_t k = coordinates.size() - drift.size(); k < coordinates.size(); ++k)
    samples.drift.push_back(static_cast<int>(k));
  samples.dropped = table.values.cols() - std::ssize(rows);
  samples.coordinates = table.values(coordinates, rows);
  samples.values = table.values(values, rows).transpose();
  if (!weights.empty()) samples.weights = table.values(weights, rows).transpose();
  if (!derivatives.empty()) samples.gradients = table.values(derivatives, rows).transpose();
  check_weights(samples.weights, rows, name);
  samples.coordinate_names = names_of(table, coordinates, default_coordinate_names(samples.coordinates.rows()));
  samples.value_names = names_of(table, values, default_value_names(samples.values.cols()));
  samples.crs = source.crs;
  if (columns.coordinates.empty()) samples.suspicion = row_number_among(table, coordinates);
  if (columns.values.empty() && samples.suspicion.empty()) samples.suspicion = row_number_among(table, values);
  return samples;
}

}  // namespace

std::vector<std::string> default_coordinate_names(Index d) {
  const std::vector<std::string> axes{"x", "y", "z"};
  if (d <= std::ssize(axes)) return {axes.begin(), axes.begin() + d};
  return numbered("x", d);
}

std::vector<std::string> default_value_names(Index k) {
  return k == 1 ? std::vector<std::string>{"value"} : numbered("value", k);
}

SampleTable read_samples(const std::string& path, const SampleColumns& columns) {
  return samples_of(read_source(path, columns.points), display_name(path), columns);
}

SampleTable parse_npy_samples(std::string_view bytes, const std::string& name, const SampleColumns& columns) {
  return samples_of({table_of(parse_npy(bytes, name), name), "", {}, {}}, name, columns);
}

SampleSource read_sample_source(const std::string& path) {
  const Source source = read_source(path, {});
  const Index last = source.table.values.rows() - 1;
  SampleSource all{source.table.names, source.table.values, source.crs, source.coordinates, source.values};
  if (all.columns.empty()) all.columns = {last};
  if (all.coordinates.empty())
    for (Index c = 0; c < last; ++c) all.coordinates.push_back(c);
  return all;
}

Eigen::MatrixXd read_queries(const std::string& path, const std::vector<std::string>& names) {
  const Table table = read_source(path, {}).table;
  const std::string name = display_name(path);
  if (table.values.rows() < std::ssize(names))
    throw IoError(name + ": expected " + std::to_string(names.size()) + " coordinates (" + listed(names) + "), found " +
                  std::to_string(table.values.rows()) + " columns");
  std::vector<Index> columns;
  for (const std::string& wanted : names) {
    const auto found = std::find(table.names.begin(), table.names.end(), wanted);
    if (found != table.names.end()) columns.push_back(found - table.names.begin());
  }
  if (columns.size() < names.size()) {
    columns.resize(names.size());
    std::iota(columns.begin(), columns.end(), 0);
  }
  ColumnPicker(table, name).check_numbers(columns);
  return table.values(columns, Eigen::all);
}

void write_table(const std::string& path, const ResultTable& table) {
  const Index rows = table.values.rows();
  require(table.coordinates.cols() == rows, "write_table", "coordinates", table.coordinates.cols(),
          "one column per row of values is needed");
  require(std::ssize(table.coordinate_names) == table.coordinates.rows() &&
              std::ssize(table.value_names) == table.values.cols(),
          "write_table", "names", table.coordinate_names.size() + table.value_names.size(),
          "one per coordinate and value is needed");
  std::string extension = content_extension(path);
  if (path == "-" && extension.empty()) extension = ".csv";
  if (extension == ".npy") {
    NpyArray array{{rows}, {}};
    if (table.values.cols() != 1) array.shape.push_back(table.values.cols());
    array.values.resize(table.values.size());
    Eigen::Map<Eigen::MatrixXd>(array.values.data(), table.values.cols(), rows) = table.values.transpose();
    return write_content(path, format_npy(array));
  }
  const bool is_map = is_gdal_table(extension);
  if (!is_map && extension != ".csv" && extension != ".txt")
    refuse_extension(path, extension, "tables of results are .csv .txt .npy, and .gpkg .shp .geojson .fgb");
  Eigen::MatrixXd columns(table.coordinates.rows() + table.values.cols(), rows);
  columns << table.coordinates, table.values.transpose();
  std::vector<std::string> names = table.coordinate_names;
  names.insert(names.end(), table.value_names.begin(), table.value_names.end());
  if (is_map) {
    require(table.coordinates.rows() == 2 || table.coordinates.rows() == 3, "write_table", "coordinates",
            table.coordinates.rows(), "points on maps have two or three");
    if (table.coordinates.rows() == 3) names[2] = "z";
    return write_gdal_table(path, names, columns, table.crs);
  }
  write_content(path,
                extension == ".csv" ? format_table(names, columns, ',') : format_table(names, columns, ' ', "# "));
}

}  // namespace csrbf
