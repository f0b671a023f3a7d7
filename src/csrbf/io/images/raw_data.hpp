#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// How the samples behind a text header are stored.
struct RawData {
  enum class Encoding { raw, ascii, deflate };
  Encoding encoding = Encoding::raw;
  std::string file;             ///< name of another file, from the header's folder; empty: behind the header
  std::size_t begin = 0;        ///< of the data in the header's own file
  std::int64_t skip_lines = 0;  ///< in front of the data
  std::int64_t skip_bytes = 0;  ///< after decompression and lines; -1: the samples end the (raw) file
};

/// Fetches the samples of raw.layout: `bytes` is the file that `data` describes. Fills raw.bytes and raw.offset; ascii
/// samples become native ones. Throws IoError, for promises that the file cannot keep before memory is taken.
void load_raw_data(RawVolume& raw, const RawData& data, std::string bytes, const std::string& path);

}  // namespace csrbf
