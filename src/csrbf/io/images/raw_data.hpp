#pragma once

#include "csrbf/io/images/sample_codec.hpp"

namespace csrbf {

/// How the samples that belong to a text header are stored.
struct RawData {
  enum class Encoding { raw, ascii, deflate };
  Encoding encoding = Encoding::raw;
  std::string file;             ///< name of another file, from the header's folder; empty: after the header
  std::size_t begin = 0;        ///< of the data in the header's own file
  std::int64_t skip_lines = 0;  ///< before the data
  std::int64_t skip_bytes = 0;  ///< after decompression and lines; -1: the samples end the (raw) file
};

/// Fetches the samples of raw.layout: `bytes` is the file that `data` describes. Fills raw.bytes and raw.offset; ascii
/// samples become native ones. Throws IoError; for more samples than the file can hold, before memory is allocated.
void load_raw_data(RawVolume& raw, const RawData& data, std::string bytes, const std::string& path);

}  // namespace csrbf
