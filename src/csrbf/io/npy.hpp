#pragma once

#include "csrbf/core/types.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// An n-dimensional array of numbers as NumPy saves it.
struct NpyArray {
  std::vector<Index> shape;
  std::vector<double> values;  ///< in C order: the last index runs fastest
};

/// Reads the bytes of a .npy file (versions 1 to 3): floats of 4 and 8 bytes, integers and booleans, either byte order,
/// C or Fortran order. Throws IoError for other types and for files that do not hold what their header says.
NpyArray parse_npy(std::string_view bytes, const std::string& name);

/// The bytes of a version 1 .npy file of little-endian doubles in C order. values.size() is the product of `shape`.
std::string format_npy(const NpyArray& array);

}  // namespace csrbf
