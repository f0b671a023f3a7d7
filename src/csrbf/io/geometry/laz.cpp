#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/geometry/formats.hpp"

#if defined(CSRBF_HAS_LAZPERF)
#include <lazperf/readers.hpp>
#elif defined(CSRBF_HAS_LASZIP)
#include <laszip/laszip_api.h>

#include <memory>
#include <sstream>
#endif

namespace csrbf {
namespace {

constexpr std::size_t place_of_header_size = 94, place_of_begin = 96, place_of_format = 104, place_of_size = 105;
constexpr std::size_t smallest_header = 227;
constexpr unsigned compressed = 0x80;  // the bit of the format by which compressed files are known

bool is_compressed(std::string_view bytes) {
  return (static_cast<unsigned char>(bytes[place_of_format]) & compressed) != 0;
}

#if defined(CSRBF_HAS_LAZPERF) || defined(CSRBF_HAS_LASZIP)

constexpr unsigned points_between_pauses = 1U << 13;  // points

// The same points without compression: the header, with the format and the size of a record, and the records, which
// `next` writes one by one.
template <class Next>
std::string uncompressed(std::string_view bytes, std::uint64_t count, unsigned format, std::size_t size,
                         const std::string& name, const Next& next) {
  constexpr std::uint64_t most_per_byte = 64;  // far above what compressors reach; a limit on damaged files
  if (count > most_per_byte * bytes.size())
    throw IoError(name + ": the file is truncated: it has no room for its " + std::to_string(count) + " points");
  const std::size_t head = load_scalar<std::uint16_t>(bytes.data() + place_of_header_size);
  std::string las(bytes.substr(0, std::max(head, smallest_header)));
  const std::size_t begin = las.size();
  store_scalar(las.data() + place_of_begin, static_cast<std::uint32_t>(begin));
  store_scalar(las.data() + place_of_format, static_cast<std::uint8_t>(format));
  store_scalar(las.data() + place_of_size, static_cast<std::uint16_t>(size));
  las.resize(begin + count * size);
  InterruptionPoint pause(points_between_pauses);
  for (std::uint64_t i = 0; i < count; ++i) {
    pause();
    next(las.data() + begin + i * size);
  }
  return las;
}

#endif

#if defined(CSRBF_HAS_LAZPERF)

std::string decompress(std::string_view bytes, const std::string& name) {
  try {
    std::string file(bytes);
    lazperf::reader::mem_file reader(file.data(), file.size());
    constexpr unsigned marks = 0xC0;
    const unsigned format = static_cast<unsigned char>(bytes[place_of_format]) & ~marks;
    const std::size_t size = load_scalar<std::uint16_t>(bytes.data() + place_of_size);
    return uncompressed(bytes, reader.pointCount(), format, size, name, [&](char* out) { reader.readPoint(out); });
  } catch (const IoError&) {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception& error) {
    throw IoError(name + ": the compressed points cannot be read: " + error.what());
  }
}

#elif defined(CSRBF_HAS_LASZIP)

// A reader of LASzip, closed in the end.
class LaszipReader {
 public:
  LaszipReader(std::string_view bytes, std::string name) : stream_(std::string(bytes)), name_(std::move(name)) {
    laszip_BOOL has_compression = 0;
    laszip_POINTER made = nullptr;
    const laszip_I32 failed = laszip_create(&made);
    reader_.reset(made);
    check(failed);
    check(laszip_open_reader_stream(reader_.get(), stream_, &has_compression));
    check(laszip_get_point_pointer(reader_.get(), &point_));
  }

  [[nodiscard]] std::uint64_t count() const {
    laszip_header_struct* header = nullptr;
    check(laszip_get_header_pointer(reader_.get(), &header));
    return std::max<std::uint64_t>(header->number_of_point_records,
                                   header->version_minor >= 4 ? header->extended_number_of_point_records : 0);
  }

  // Reads the next point.
  const laszip_point_struct& next() {
    check(laszip_read_point(reader_.get()));
    return *point_;
  }

 private:
  void check(laszip_I32 failed) const {
    if (failed == 0) return;
    laszip_CHAR* message = nullptr;
    if (reader_ != nullptr) laszip_get_error(reader_.get(), &message);
    throw IoError(name_ +
                  ": the compressed points cannot be read: " + (message != nullptr ? message : "no reason given"));
  }

  std::istringstream stream_;
  std::string name_;
  struct Close {
    void operator()(void* reader) const {
      laszip_close_reader(reader);
      laszip_destroy(reader);
    }
  };
  std::unique_ptr<void, Close> reader_;
  laszip_point_struct* point_ = nullptr;
};

// Writes a record of format 3 (short) or 7 (long), which have time and colours.
void store_point(const laszip_point_struct& p, bool is_long, char* out) {
  store_scalar(out, p.X);
  store_scalar(out + 4, p.Y);
  store_scalar(out + 8, p.Z);
  store_scalar(out + 12, p.intensity);
  const std::size_t time = is_long ? 22 : 20;
  if (is_long) {
    const unsigned returns = p.extended_return_number | p.extended_number_of_returns << 4U;
    store_scalar(out + 14, static_cast<std::uint8_t>(returns));
    store_scalar(out + 15, static_cast<std::uint8_t>(p.extended_classification_flags));
    store_scalar(out + 16, p.extended_classification);
    store_scalar(out + 20, p.point_source_ID);
  } else {
    const unsigned returns = p.return_number | p.number_of_returns << 3U;
    store_scalar(out + 14, static_cast<std::uint8_t>(returns));
    store_scalar(out + 15, static_cast<std::uint8_t>(p.classification | p.withheld_flag << 7U));
    store_scalar(out + 18, p.point_source_ID);
  }
  store_scalar(out + time, p.gps_time);
  for (std::size_t c = 0; c < 3; ++c) store_scalar(out + time + 8 + 2 * c, p.rgb[c]);
}

std::string decompress(std::string_view bytes, const std::string& name) {
  LaszipReader reader(bytes, name);
  constexpr unsigned marks = 0xC0, first_long_format = 6;
  const bool is_long = (static_cast<unsigned char>(bytes[place_of_format]) & ~marks) >= first_long_format;
  return uncompressed(bytes, reader.count(), is_long ? 7 : 3, is_long ? 36 : 34, name,
                      [&](char* out) { store_point(reader.next(), is_long, out); });
}

#else

std::string decompress(std::string_view /*bytes*/, const std::string& name) {
  throw IoError(name +
                ": its points are compressed (LAZ), which this build cannot read; convert it, as by `pdal translate "
                "a.laz a.las`, `las2las -i a.laz -o a.las` or CloudCompare, or build csrbf where laz-perf or LASzip is "
                "installed");
}

#endif

}  // namespace

bool reads_laz() {
#if defined(CSRBF_HAS_LAZPERF) || defined(CSRBF_HAS_LASZIP)
  return true;
#else
  return false;
#endif
}

PointCloud parse_laz(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("LASF")) throw IoError(name + ": not a LAS or LAZ file: it does not begin with LASF");
  if (bytes.size() < smallest_header)
    throw IoError(name + ": the file is truncated: its header has 227 bytes at least");
  return is_compressed(bytes) ? parse_las(decompress(bytes, name), name) : parse_las(bytes, name);
}

}  // namespace csrbf
