#pragma once

#include "csrbf/io/files/table.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// Whether a column has a usual name of longitudes, of latitudes, or of either of them or distances to the east or to
/// the north, in capitals or not.
bool is_longitude(std::string_view name);
bool is_latitude(std::string_view name);
bool is_eastward(std::string_view name);
bool is_northward(std::string_view name);

/// "column 3" for the third one.
std::string name_of_unnamed(Index column);

/// As programs write the numbers of rows: no name, which pandas reads as one of its own.
bool is_unnamed(const std::string& name, Index column);

/// Is the column 0, 1, 2 ... or 1, 2, 3 ...?
bool counts_rows(const Table& table, Index column);

/// A column among these whose name or content says that it only numbers the rows; empty when there is none. The only
/// coordinate of equidistant samples may be their number.
std::string row_number_among(const Table& table, const std::vector<Index>& columns);

/// A column among these whose name says that it tells how sure a value is; empty when there is none.
std::string deviation_among(const Table& table, const std::vector<Index>& columns);

/// The name of the column of values, if it is that of a coordinate whose partner is among the coordinates.
std::string misplaced_value(const Table& table, const std::vector<Index>& coordinates, Index value);

}  // namespace csrbf
