#pragma once

#include "csrbf/io/points.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// The roles of the columns of a table: names or 1-based numbers, separated by commas; empty takes the default.
struct SampleColumns {
  std::string coordinates = {};  ///< default: all columns that are neither values nor weights
  std::string values = {};       ///< default: the last column that is neither a coordinate nor the weight
  std::string weights = {};      ///< one column; default: none, all samples weigh 1
  std::string sphere = {};       ///< those of longitude and latitude, among the coordinates; default: none
  std::string derivatives = {};  ///< of each value by each coordinate, value by value; default: none
  std::string drift = {};        ///< covariates: further coordinates, after the others; default: none
  PointSelection points = {};    ///< of points of a scanner, as which tables are read then, too: z over x and y
};

/// Scattered samples as read from a file, for any dimension.
struct SampleTable {
  Eigen::MatrixXd coordinates;     ///< d x n
  Eigen::MatrixXd values;          ///< n x k
  Eigen::VectorXd weights;         ///< n, or empty
  Eigen::MatrixXd gradients = {};  ///< n x (k d), or empty; missing numbers are NaN
  std::vector<std::string> coordinate_names, value_names;
  std::vector<int> sphere = {}, drift = {};  ///< these coordinates, numbered from 0
  Index dropped = 0;                         ///< rows left out because one of their numbers is missing or not finite
  std::string crs = {};                      ///< reference system of the coordinates, where the file names one
  std::vector<std::string> left_out = {};    ///< columns without a name of their own that count the rows: not taken
  std::string suspicion = {};  ///< a column that is used and looks like a mere number of the rows; else empty
  std::string deviation = {};  ///< a column that is used, though its name is that of a deviation; else empty
};

/// Names of d coordinates: x y z, or x1 x2 ... from four on.
std::vector<std::string> default_coordinate_names(Index d);
/// Names of k values: value, or value1 value2 ...
std::vector<std::string> default_value_names(Index k);

/// What to say of one of SampleTable::left_out.
std::string left_out_warning(const std::string& column);

/// Reads samples: .csv .txt .tsv .dat .xyz and "-" for standard input (numbers separated by commas, semicolons, tabs or
/// blanks, with a line of column names or without, see io/files/table.hpp) or .npy (an (n, d+1) array). Columns that
/// are not used may hold text; empty cells, NA and null are missing numbers. Columns without names get the default
/// ones; one without a name among others is called "column 1", and is no coordinate by default if it counts the rows
/// from 0 or 1 (as pandas and R write them). Point clouds (.las, .ply and the others that read_points() reads) have the
/// columns x, y, z and their properties: z as a function of x and y by default. Points on maps (.gpkg .shp .geojson
/// .fgb, by GDAL) have x, y, z and their numeric fields: the last field by default, or z, as a function of x and y.
/// Images on maps (.tif, .asc, .nc) have x, y, which are the centres of the pixels, and value. Throws IoError
/// "file:line: ..." for unreadable text, unknown columns (listing those there are), negative weights and when no row is
/// left.
SampleTable read_samples(const std::string& path, const SampleColumns& columns = {});

/// The same for the bytes of a .npy file, or of a part of one behind a header of its own.
SampleTable parse_npy_samples(std::string_view bytes, const std::string& name, const SampleColumns& columns = {});

/// Reads faults: polylines in the plane, see FitOptions::faults, in the formats of samples: the coordinates of vertices
/// are the two columns of the names of `coordinates`, whether in capitals or not, or the first two where there is
/// neither; a third one is the number of the line, which vertices of one line share; their order is that along the
/// line. Without it all are of one line. Throws IoError, also for lines of a single vertex.
std::vector<Eigen::Matrix2Xd> read_faults(const std::string& path, const std::vector<std::string>& coordinates = {});

/// All numbers of a file of samples.
struct SampleSource {
  std::vector<std::string> names = {};  ///< of the columns; empty: they have none
  Eigen::MatrixXd values = {};          ///< columns x rows, NaN where there is none
  std::string crs = {};                 ///< reference system of the coordinates, where the file names one
  std::vector<Index> coordinates = {};  ///< the columns that read_samples() takes by default
  std::vector<Index> columns = {};      ///< and those for values
};

/// The files that read_samples() reads, whole, to describe them. Throws IoError.
SampleSource read_sample_source(const std::string& path);

/// Points to evaluate at.
struct Queries {
  Eigen::MatrixXd coordinates;  ///< d x m; missing numbers are NaN, so that every row has a result
  std::string warning = {};     ///< the file has other names than the coordinates, and order decided; else empty
};

/// Reads points to evaluate at, in the formats of samples: the columns of these names, whether in capitals or not;
/// when there is none of them, the first names.size() columns. Throws IoError, also when there are some of the names
/// but not all.
Queries read_queries(const std::string& path, const std::vector<std::string>& names);

/// Values at queried points.
struct ResultTable {
  std::vector<std::string> coordinate_names, value_names;
  Eigen::MatrixXd coordinates;  ///< d x m
  Eigen::MatrixXd values;       ///< m x k
  std::string crs = {};         ///< reference system of the coordinates, for files of maps
};

/// Writes one row per query, complete or not at all (AtomicFile): .csv and "-" for standard output hold names,
/// coordinates and values, .txt the same with blanks and the names in a comment; .npy holds the values alone, as (m,)
/// or (m, k); .gpkg .shp .geojson .fgb, by GDAL, points with the values as fields. Throws IoError, InvalidInput when
/// numbers of names, rows or columns do not match.
void write_table(const std::string& path, const ResultTable& table);

}  // namespace csrbf
