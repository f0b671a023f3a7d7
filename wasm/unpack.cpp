// Unpacks the modules of the package, which are compressed by LZMA: a third less to download than by gzip. A module of
// its own, without a run-time library.
#include <lzma.h>

#include <cstdint>
#include <cstdlib>

extern "C" {

/** The unpacked bytes, whose number is written to `size`: they are the caller's; null where the packed ones are
 * damaged. */
std::uint8_t* csrbf_unpack(const std::uint8_t* packed, std::uint32_t count, std::uint32_t* size) {
  lzma_stream stream = LZMA_STREAM_INIT;
  if (lzma_alone_decoder(&stream, UINT64_MAX) != LZMA_OK) return nullptr;
  stream.next_in = packed;
  stream.avail_in = count;
  std::uint8_t* unpacked = nullptr;
  lzma_ret state = LZMA_OK;
  while (state == LZMA_OK) {
    if (stream.avail_out == 0) {
      stream.avail_out = 2 * stream.total_out + 2 * count;  // at least half of them are not used yet
      auto* more = static_cast<std::uint8_t*>(std::realloc(unpacked, stream.total_out + stream.avail_out));
      if (more == nullptr) break;
      unpacked = more;
      stream.next_out = unpacked + stream.total_out;
    }
    state = lzma_code(&stream, LZMA_FINISH);
  }
  lzma_end(&stream);
  *size = static_cast<std::uint32_t>(stream.total_out);
  if (state == LZMA_STREAM_END) return unpacked;
  std::free(unpacked);
  return nullptr;
}
}
