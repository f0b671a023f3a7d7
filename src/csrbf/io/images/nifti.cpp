#include "csrbf/io/images/nifti.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/images/nifti_header.hpp"

namespace csrbf {
namespace {

constexpr std::size_t header_1 = 348;
constexpr std::size_t header_2 = 540;
constexpr std::string_view gzip_magic = "\x1f\x8b";

struct Datatype {
  int code;
  SampleType type;
  Index components;
};

constexpr std::array<Datatype, 12> datatypes{{{2, SampleType::uint8, 1},
                                              {4, SampleType::int16, 1},
                                              {8, SampleType::int32, 1},
                                              {16, SampleType::float32, 1},
                                              {64, SampleType::float64, 1},
                                              {256, SampleType::int8, 1},
                                              {512, SampleType::uint16, 1},
                                              {768, SampleType::uint32, 1},
                                              {1024, SampleType::int64, 1},
                                              {1280, SampleType::uint64, 1},
                                              {128, SampleType::uint8, 3},
                                              {2304, SampleType::uint8, 4}}};

[[noreturn]] void fail(const std::string& name, const std::string& message) {
  throw IoError(name + ": " + message);
}

void set_shape(const NiftiHeader& header, RawVolume& raw, const std::string& name) {
  const std::int64_t axes = header.dim[0];
  if (axes < 1 || axes > 7) fail(name, "field dim[0] is " + std::to_string(axes) + ", it must be 1 to 7");
  std::array<Index, 7> size{1, 1, 1, 1, 1, 1, 1};
  for (std::size_t i = 0; i < static_cast<std::size_t>(axes); ++i) {
    size[i] = static_cast<Index>(header.dim[i + 1]);
    if (size[i] < 1) fail(name, "field dim[" + std::to_string(i + 1) + "] is " + std::to_string(size[i]));
  }
  if (size[5] > 1 || size[6] > 1) fail(name, "images of more than five axes are not supported");
  VolumeLayout& layout = raw.layout;
  layout.grid.axes = static_cast<int>(std::min<std::int64_t>(axes, 3));
  layout.grid.size = {size[0], size[1], size[2]};
  layout.frames = size[3];
  for (const Datatype& datatype : datatypes)
    if (datatype.code == header.datatype) {
      layout.type = datatype.type;
      layout.components = datatype.components;
    }
  if (layout.components > 1 && size[4] > 1) fail(name, "vectors of colours are not supported");
  if (size[4] > 1) {
    layout.components = size[4];
    raw.planar = true;
  }
}

void set_position(const NiftiHeader& header, VolumeLayout& layout, const std::string& name) {
  constexpr int units_of_space = 0x07;
  constexpr int units_of_time = 0x38;
  const int space_unit = header.units & units_of_space;
  const int time_unit = header.units & units_of_time;
  const double mm = space_unit == 1 ? 1e3 : space_unit == 3 ? 1e-3 : 1;
  const double seconds = time_unit == 16 ? 1e-3 : time_unit == 24 ? 1e-6 : 1;
  layout.grid.origin = mm * header.origin();
  set_axes(layout.grid, mm * header.linear(layout.grid.axes), name);
  layout.grid.space = header.has_position() ? Space::right_anterior_superior : Space::unknown;
  if (header.pixdim[4] > 0) layout.time_step = seconds * header.pixdim[4];
}

}  // namespace

RawVolume parse_nifti(std::string bytes, const std::string& name) {
  const bool compressed = bytes.starts_with(gzip_magic);
  const std::string inflated = compressed ? inflate_head(bytes, header_2, name) : std::string();
  const std::string_view head = compressed ? std::string_view(inflated) : std::string_view(bytes);
  const NiftiHeader header = parse_nifti_header(head, name);

  RawVolume raw;
  raw.order = header.order;
  if (std::none_of(datatypes.begin(), datatypes.end(), [&](const Datatype& d) { return d.code == header.datatype; }))
    fail(name, "samples of NIfTI datatype " + std::to_string(header.datatype) +
                   " are not supported; integers, float32, float64 and RGB are");
  set_shape(header, raw, name);
  set_position(header, raw.layout, name);
  if (std::isfinite(header.slope) && header.slope != 0 && std::isfinite(header.intercept)) {
    raw.slope = header.slope;
    raw.intercept = header.intercept;
  }
  const auto least = static_cast<double>(header.version == 1 ? header_1 : header_2);
  constexpr double farthest = 1e15;  // bytes, a limit on damaged files
  if (header.data_offset != 0 && !(header.data_offset >= least && header.data_offset < farthest))
    fail(name, "field vox_offset is " + std::to_string(header.data_offset) + ", the header alone is " +
                   std::to_string(static_cast<int>(least)) + " bytes long");
  // Some writers leave the field 0: the samples follow the header and four bytes that announce extensions.
  raw.offset = static_cast<std::size_t>(header.data_offset != 0 ? header.data_offset : least + 4);
  if (compressed) {
    const std::size_t size = raw.offset + checked_deflated_bytes(raw.layout, bytes.size(), name);
    if (raw.offset / 1100 > bytes.size()) fail(name, "field vox_offset lies beyond the end of the file");
    raw.bytes = inflate_bytes(bytes, size, name);
  } else {
    checked_sample_bytes(raw.layout, bytes.size() - std::min(bytes.size(), raw.offset), name);
    raw.bytes = std::move(bytes);
  }
  return raw;
}

FileParts format_nifti(const VolumeLayout& layout, std::string samples) {
  NiftiHeader header;
  const Grid grid = in_space(layout.grid, Space::right_anterior_superior);
  std::int64_t axes = layout.components > 1 ? 5 : layout.frames > 1 ? 4 : layout.grid.axes;
  header.dim = {axes, grid.size[0], grid.size[1], grid.size[2], layout.frames, layout.components, 1, 1};
  header.version = *std::max_element(header.dim.begin(), header.dim.end()) > 32767 ? 2 : 1;
  for (const Datatype& datatype : datatypes)
    if (datatype.type == layout.type && datatype.components == 1) header.datatype = datatype.code;
  header.bits = static_cast<int>(8 * sample_size(layout.type));
  header.pixdim[4] = layout.time_step;
  header.set_position(grid);
  std::string body = std::move(samples);
  if (layout.components > 1) {
    // NIfTI stores one component after the other.
    const std::size_t size = sample_size(layout.type);
    const auto components = static_cast<std::size_t>(layout.components);
    const std::size_t voxels = body.size() / size / components;
    std::string planar(body.size(), '\0');
    for (std::size_t c = 0; c < components; ++c)
      for (std::size_t i = 0; i < voxels; ++i)
        body.copy(planar.data() + (c * voxels + i) * size, size, (i * components + c) * size);
    body = std::move(planar);
  }
  return {format_nifti_header(header), std::move(body)};
}

}  // namespace csrbf
