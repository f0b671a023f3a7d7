#include "csrbf/io/samples.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/column_picker.hpp"
#include "csrbf/io/files/gzip_file.hpp"
#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/table.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/gdal/gdal.hpp"
#include "csrbf/io/sample_columns.hpp"
#include "csrbf/io/volume.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace csrbf {
namespace {

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
  std::vector<Index> left_out = {};  // not taken unless they are named
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

// Columns without a name get one; those that count the rows, such as to_csv() of pandas and write.csv() of R put before
// the others, are left out.
Source source_of(Table table) {
  Source source{std::move(table), "", {}, {}};
  std::vector<std::string>& names = source.table.names;
  for (Index column = 0; column < std::ssize(names); ++column) {
    std::string& name = names[static_cast<std::size_t>(column)];
    if (!is_unnamed(name, column)) continue;
    if (name.empty()) name = name_of_unnamed(column);
    if (counts_rows(source.table, column)) source.left_out.push_back(column);
  }
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
  return source_of(parse_table(content.bytes, name, TextCells::note));
}

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
  std::vector<Index> left_out;
  const bool by_default = values.empty() && coordinates.empty() && source.values.empty();
  if (values.empty()) values = picker.take_free(source.values);
  if (coordinates.empty()) coordinates = picker.take_free(source.coordinates);
  if (values.empty()) values = picker.take_last();
  if (coordinates.empty()) {
    left_out = picker.take_free(source.left_out);
    coordinates = picker.take_rest();
    if (coordinates.empty()) coordinates.swap(left_out);  // what counts the rows is all there is
  }
  if (values.empty() || coordinates.empty())
    throw IoError(name + ": samples need one column of coordinates and one of values at least, the file has only " +
                  std::to_string(table.values.rows()));
  if (!derivatives.empty() && derivatives.size() != coordinates.size() * values.size())
    throw IoError(name + ": found " + std::to_string(derivatives.size()) + " columns of derivatives, " +
                  in_quotes(columns.derivatives) + "; there must be one for each of " + std::to_string(values.size()) +
                  " values by each of " + std::to_string(coordinates.size()) + " coordinates");
  picker.check_numbers(derivatives, columns.remedy);
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
  picker.check_numbers(used, columns.remedy);

  const std::vector<Index> rows = complete_rows(table, used);
  SampleTable samples;
  samples.sphere = std::move(sphere);
  for (std::size_t k = coordinates.size() - drift.size(); k < coordinates.size(); ++k)
    samples.drift.push_back(static_cast<int>(k));
  samples.dropped = table.values.cols() - std::ssize(rows);
  if (samples.dropped > 0) samples.rows = rows;
  samples.coordinates = table.values(coordinates, rows);
  samples.values = table.values(values, rows).transpose();
  if (!weights.empty()) samples.weights = table.values(weights, rows).transpose();
  if (!derivatives.empty()) samples.gradients = table.values(derivatives, rows).transpose();
  check_weights(samples.weights, rows, name);
  samples.coordinate_names = names_of(table, coordinates, default_coordinate_names(samples.coordinates.rows()));
  samples.value_names = names_of(table, values, default_value_names(samples.values.cols()));
  samples.crs = source.crs;
  for (const Index column : left_out) samples.left_out.push_back(table.names[static_cast<std::size_t>(column)]);
  if (by_default) samples.misplaced = misplaced_value(table, coordinates, values.front());
  if (columns.coordinates.empty()) samples.suspicion = row_number_among(table, coordinates);
  if (columns.values.empty() && samples.suspicion.empty()) samples.suspicion = row_number_among(table, values);
  if (columns.values.empty() && coordinates.size() > 1) samples.deviation = deviation_among(table, values);
  if (columns.coordinates.empty() && columns.drift.empty() && samples.deviation.empty())
    samples.deviation = deviation_among(table, coordinates);
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

std::string left_out_warning(const std::string& column) {
  return in_quotes(column) + " has no name of its own and only counts the rows: left out; --coordinates takes it";
}

std::vector<std::string> column_warnings(const SampleTable& samples) {
  std::vector<std::string> warnings;
  for (const std::string& column : samples.left_out) warnings.push_back(left_out_warning(column));
  if (!samples.suspicion.empty())
    warnings.push_back("the column " + samples.suspicion +
                       " only numbers the rows, it seems; --coordinates and --values choose the columns to use");
  if (!samples.misplaced.empty())
    warnings.push_back("the value is " + samples.misplaced +
                       ", which has the name of a coordinate; --coordinates and --values choose the columns");
  if (!samples.deviation.empty())
    warnings.push_back(
        "the column " + samples.deviation +
        " is used as a coordinate or value, but may tell how sure values are; --values and --coordinates "
        "choose the columns to use, --weights takes inverse variances");
  return warnings;
}

SampleTable read_samples(const std::string& path, const SampleColumns& columns) {
  SampleTable samples = samples_of(read_source(path, columns.points), display_name(path), columns);
  if (samples.coordinates.cols() == 0)
    throw IoError(display_name(path) + ": no row has a finite number in every column that is used");
  return samples;
}

SampleTable parse_npy_samples(std::string_view bytes, const std::string& name, const SampleColumns& columns) {
  return samples_of({table_of(parse_npy(bytes, name), name), "", {}, {}}, name, columns);
}

SampleSource read_sample_source(const std::string& path) {
  const Source source = read_source(path, {});
  const Index last = source.table.values.rows() - 1;
  SampleSource all{source.table.names, source.table.values, source.crs, source.coordinates, source.values};
  const std::vector<Index>& left_out = source.left_out;
  for (const TextCell& cell : source.table.text_cells) all.text.push_back(cell.column);
  if (all.columns.empty()) {
    for (Index c = 0; c <= last; ++c)
      if (std::find(left_out.begin(), left_out.end(), c) == left_out.end()) all.coordinates.push_back(c);
    all.columns = {last};
    std::erase(all.coordinates, all.columns.front());
  }
  if (all.coordinates.empty()) all.coordinates = left_out;
  return all;
}

Queries read_queries(const std::string& path, const std::vector<std::string>& names) {
  const Source source = read_source(path, {});
  const Table& table = source.table;
  const std::string name = display_name(path);
  if (table.values.rows() < std::ssize(names))
    throw IoError(name + ": expected " + std::to_string(names.size()) + " coordinates (" + listed(names) + "), found " +
                  std::to_string(table.values.rows()) + " columns");
  ColumnPicker picker(table, name);
  std::vector<Index> columns;
  std::vector<std::string> missing;
  for (const std::string& wanted : names) {
    const std::optional<Index> column = picker.find_similar(wanted);
    if (column)
      columns.push_back(*column);
    else
      missing.push_back(wanted);
  }
  if (!columns.empty() && !missing.empty())
    throw IoError(name + ": no column is named " + listed(missing) + "; the coordinates are " + listed(names) +
                  ", the columns are " + listed(table.names));
  std::string warning;
  if (columns.empty()) {
    (void)picker.take_free(source.left_out);
    columns = picker.take_rest();
    if (columns.size() < names.size()) columns = picker.all();
    columns.resize(names.size());
    if (!table.names.empty())
      warning = name + ": no column has the name of a coordinate, so the columns " +
                listed(names_of(table, columns, {})) + " were taken for " + listed(names) + ", in this order";
  }
  picker.check_numbers(columns, warning.empty() ? "" : "name the columns of the coordinates " + joined(names));
  return {table.values(columns, Eigen::all), warning};
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
