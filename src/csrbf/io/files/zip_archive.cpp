#include "csrbf/io/files/zip_archive.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/deflate.hpp"

#include <zlib.h>

namespace csrbf {
namespace {

constexpr std::uint32_t local_mark = 0x04034B50, central_mark = 0x02014B50, end_mark = 0x06054B50;
constexpr std::uint16_t version = 20, deflated = 8, date = 0x21;  // the first of January 1980: the same file every time

// What the header of a file and its entry in the directory at the end have in common.
void append_facts(std::string& out, const ZipEntry& entry, std::size_t compressed) {
  const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(entry.content.data()), entry.content.size());
  append_scalar(out, version);
  append_scalar(out, std::uint16_t{0});
  append_scalar(out, deflated);
  append_scalar(out, std::uint16_t{0});  // time
  append_scalar(out, date);
  append_scalar(out, static_cast<std::uint32_t>(crc));
  append_scalar(out, static_cast<std::uint32_t>(compressed));
  append_scalar(out, static_cast<std::uint32_t>(entry.content.size()));
  append_scalar(out, static_cast<std::uint16_t>(entry.name.size()));
  append_scalar(out, std::uint16_t{0});
}

// Without the header and the checksum of zlib.
std::string deflated_bytes(std::string_view content) {
  constexpr std::size_t head = 2, checksum = 4;
  const std::string stream = deflate_bytes({content}, DeflateFormat::zlib);
  return stream.substr(head, stream.size() - head - checksum);
}

}  // namespace

std::string zip_archive(const std::vector<ZipEntry>& entries, const std::string& name) {
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();
  std::string files, directory;
  for (const ZipEntry& entry : entries) {
    const std::string bytes = deflated_bytes(entry.content);
    append_scalar(directory, central_mark);
    append_scalar(directory, version);
    append_facts(directory, entry, bytes.size());
    directory.append(10, '\0');  // comment, disk, attributes
    append_scalar(directory, static_cast<std::uint32_t>(files.size()));
    directory += entry.name;
    append_scalar(files, local_mark);
    append_facts(files, entry, bytes.size());
    files += entry.name;
    files += bytes;
    if (entry.content.size() > most || files.size() > most)
      throw IoError(name + ": more than 4 GB, which the format cannot hold; write .ply, or a coarser mesh");
  }
  const auto begin = static_cast<std::uint32_t>(files.size());
  files += directory;
  append_scalar(files, end_mark);
  append_scalar(files, std::uint32_t{0});  // disks
  for (int i = 0; i < 2; ++i) append_scalar(files, static_cast<std::uint16_t>(entries.size()));
  append_scalar(files, static_cast<std::uint32_t>(directory.size()));
  append_scalar(files, begin);
  append_scalar(files, std::uint16_t{0});
  return files;
}

}  // namespace csrbf
