#pragma once

#include "csrbf/io/points.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// Which columns of a table to use: names or numbers from 1, separated by commas; empty: the default.
struct SampleColumns {
  std::string coordinates = {};  ///< default: all columns that are neither values nor weights
  std::string values = {};       ///< default: the last column that is neither a coordinate nor the weight
  std::string weights = {};      ///< one column; default: none, all weights are 1
  std::string sphere = {};       ///< longitude and latitude, among the coordinates; default: none
  std::string derivatives = {};  ///< of each value by each coordinate, value by value; default: none
  std::string drift = {};        ///< covariates: further coordinates, after the others; default: none
  PointSelection points = {};    ///< of laser scans, which are read as tables too: z as a function of x and y
  std::string remedy = {};       ///< how to choose others, for the message about text in a column that is used
};

/// Samples as read from a file, in any dimension.
struct SampleTable {
  Eigen::MatrixXd coordinates;     ///< d x n
  Eigen::MatrixXd values;          ///< n x k
  Eigen::VectorXd weights;         ///< n, or empty
  Eigen::MatrixXd gradients = {};  ///< n x (k d), or empty; missing numbers are NaN
  std::vector<std::string> coordinate_names, value_names;
  std::vector<int> sphere = {}, drift = {};  ///< numbers of these coordinates, from 0
  Index dropped = 0;                         ///< rows left out because a number is missing or not finite
  std::vector<Index> rows = {};              ///< if any were: which row of the file each sample is, from 0; else empty
  std::string crs = {};                      ///< reference system of the coordinates, where the file names one
  std::vector<std::string> left_out = {};    ///< columns without a name that count the rows; not used
  std::string suspicion = {};                ///< a column that is used but looks like a row number; else empty
  std::string deviation = {};                ///< a column that is used but named like a standard deviation; else empty
  std::string misplaced = {};  ///< the column of values, where its name is that of a coordinate; else empty
};

/// Names of d coordinates: x y z, or x1 x2 ... from four on.
std::vector<std::string> default_coordinate_names(Index d);
/// Names of k values: value, or value1 value2 ...
std::vector<std::string> default_value_names(Index k);

/// The warning about a column of SampleTable::left_out.
std::string left_out_warning(const std::string& column);

/// Warnings about the columns that were left out, or were used but may not be meant to be.
std::vector<std::string> column_warnings(const SampleTable& samples);

/// Reads samples from a file; its extension determines the format:
/// - .csv .txt .tsv .dat .xyz, and "-" for standard input: numbers separated by commas, semicolons, tabs or blanks,
///   with or without a line of column names. Columns that are not used may hold text; empty cells, NA and null are
///   missing numbers. Columns without names get the default ones. A single column without a name is called "column 1"
///   after its number; if it counts the rows from 0 or 1, as pandas and R write it, it is no coordinate by default.
/// - .npy: an (n, d + 1) array.
/// - .las, .ply and the other point clouds of read_points(): x, y, z and their properties; by default z is a function
///   of x and y.
/// - .gpkg .shp .geojson .fgb, points on maps, by GDAL: x, y, z and their numeric fields; by default the last field, or
///   z, is a function of x and y.
/// - .tif .asc .nc, images on maps: x and y of the centres of the pixels, and value.
///
/// Throws IoError "file:line: ..." for unreadable text, unknown columns (with the list of columns), negative weights,
/// and if no row is left.
SampleTable read_samples(const std::string& path, const SampleColumns& columns = {});

/// The same for the bytes of a .npy file, or for a part of one with a header of its own, of which no row may be left.
SampleTable parse_npy_samples(std::string_view bytes, const std::string& name, const SampleColumns& columns = {});

/// Reads faults: polylines in the plane, see FitOptions::faults. From .gpkg .shp .geojson .fgb the lines, by GDAL.
/// Else from a table, in the formats of samples: the coordinates of the vertices are the two columns with the names
/// `coordinates`, in upper or lower case, or the first two columns if neither exists. A third column is the number of
/// the line; without it there is one line. Vertices are in order along the line. Throws IoError, also for lines with a
/// single vertex.
std::vector<Eigen::Matrix2Xd> read_faults(const std::string& path, const std::vector<std::string>& coordinates = {});

/// All numbers in a file of samples.
struct SampleSource {
  std::vector<std::string> names = {};  ///< of the columns; empty if they have none
  Eigen::MatrixXd values = {};          ///< columns x rows; NaN where a number is missing
  std::string crs = {};                 ///< reference system of the coordinates, where the file names one
  std::vector<Index> coordinates = {};  ///< the columns that read_samples() takes by default
  std::vector<Index> columns = {};      ///< the columns that it takes for values
  std::vector<Index> text = {};         ///< the columns in which there is text, which it refuses
};

/// Reads all columns of a file that read_samples() can read, to describe it. Throws IoError.
SampleSource read_sample_source(const std::string& path);

/// Points to evaluate at.
struct Queries {
  Eigen::MatrixXd coordinates;  ///< d x m; missing numbers are NaN, so that every row has a result
  std::string warning = {};     ///< set if the file has other column names, so that their order decided; else empty
};

/// Reads points to evaluate at, in the formats of samples: the columns with these names, in upper or lower case, or the
/// first names.size() columns if none of the names exists. Throws IoError, also if only some of the names exist.
Queries read_queries(const std::string& path, const std::vector<std::string>& names);

/// Values at queried points.
struct ResultTable {
  std::vector<std::string> coordinate_names, value_names;
  Eigen::MatrixXd coordinates;  ///< d x m
  Eigen::MatrixXd values;       ///< m x k
  std::string crs = {};         ///< coordinate reference system, for files of maps
};

/// Writes one row per query, completely or not at all:
/// - .csv, and "-" for standard output: names, coordinates and values.
/// - .txt: the same with blanks, and with the names in a comment.
/// - .npy: the values alone, as (m,) or (m, k).
/// - .gpkg .shp .geojson .fgb, by GDAL: points, with the values as fields.
///
/// Throws IoError; InvalidInput if the numbers of names, rows or columns do not match.
void write_table(const std::string& path, const ResultTable& table);

}  // namespace csrbf
