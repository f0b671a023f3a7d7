#include "csrbf/io/images/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/npy.hpp"

namespace csrbf {
namespace {

bool has_components(const std::vector<Index>& shape) {
  constexpr Index most = 4;  // components: grey or colours, with transparency
  const Index last = shape.empty() ? 0 : shape.back();
  if (shape.size() == 3) return (last == 3 || last == most) && shape[0] > most && shape[1] > most;
  return shape.size() == 5 || (shape.size() == 4 && last >= 2 && last <= most);
}

void set_shape(VolumeLayout& layout, std::vector<Index> shape, const std::string& name) {
  if (shape.empty() || shape.size() > 5)
    throw IoError(name + ": an array of " + std::to_string(shape.size()) +
                  " axes is no image; images are [x], [y, x], [z, y, x] or [t, z, y, x], then components");
  if (has_components(shape)) {
    layout.components = shape.back();
    shape.pop_back();
  }
  if (shape.size() == 4) {
    layout.frames = shape.front();
    shape.erase(shape.begin());
  }
  layout.grid.axes = static_cast<int>(shape.size());
  std::copy(shape.rbegin(), shape.rend(), layout.grid.size.begin());
}

RawVolume head_of(const NpyHeader& header, const std::string& name) {
  RawVolume raw;
  set_shape(raw.layout, header.shape, name);
  raw.layout.type = header.type;
  raw.order = header.order;
  return raw;
}

}  // namespace

std::optional<RawVolume> parse_npy_volume_head(std::string_view head, const std::string& name) {
  std::string_view data = head;
  const NpyHeader header = parse_npy_header(data, name);
  if (header.fortran && header.shape.size() > 1) return std::nullopt;
  RawVolume raw = head_of(header, name);
  raw.offset = head.size() - data.size();
  return raw;
}

RawVolume parse_npy_volume(std::string bytes, const std::string& name) {
  std::string_view data = bytes;
  const NpyHeader header = parse_npy_header(data, name);
  RawVolume raw = head_of(header, name);
  checked_sample_bytes(raw.layout, data.size(), name);
  if (header.fortran && header.shape.size() > 1) {
    raw.bytes = npy_bytes_in_c_order(header, data, name);
  } else {
    raw.offset = bytes.size() - data.size();
    raw.bytes = std::move(bytes);
  }
  return raw;
}

FileParts format_npy_volume(const VolumeLayout& layout, std::string samples) {
  std::vector<Index> shape;
  if (layout.frames > 1) shape.push_back(layout.frames);
  for (int axis = layout.grid.axes - 1; axis >= 0; --axis) shape.push_back(layout.grid.size[axis]);
  if (layout.components > 1) shape.push_back(layout.components);
  return {format_npy_header(layout.type, shape), std::move(samples)};
}

}  // namespace csrbf
