#pragma once

#include "csrbf/io/files/bytes.hpp"

namespace csrbf {

/// An n-dimensional array of numbers as NumPy saves it.
struct NpyArray {
  std::vector<Index> shape;
  std::vector<double> values;  ///< in C order: the last index runs fastest
};

/// The header of a .npy file.
struct NpyHeader {
  SampleType type = SampleType::float64;
  std::endian order = std::endian::little;
  bool fortran = false;  ///< the first index runs fastest
  std::vector<Index> shape;
};

/// Removes the header from `bytes` and leaves the data, whose size is not checked. Throws IoError as parse_npy does.
NpyHeader parse_npy_header(std::string_view& bytes, const std::string& name);

/// The elements of a `header.fortran` array with the last index running fastest. Throws IoError when data are missing.
std::string npy_bytes_in_c_order(const NpyHeader& header, std::string_view data, const std::string& name);

/// A version 1 header of little-endian elements in C order.
std::string format_npy_header(SampleType type, const std::vector<Index>& shape);

/// Reads the bytes of a .npy file (versions 1 to 3): floats of 4 and 8 bytes, integers and booleans, either byte order,
/// C or Fortran order. Throws IoError for other types and for files whose data do not match their header.
NpyArray parse_npy(std::string_view bytes, const std::string& name);

/// The bytes of a version 1 .npy file of little-endian doubles in C order. values.size() is the product of `shape`.
std::string format_npy(const NpyArray& array);

}  // namespace csrbf
