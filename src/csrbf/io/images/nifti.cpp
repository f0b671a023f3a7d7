#include "csrbf/io/images/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/deflate.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

constexpr std::string_view gzip_magic = "\x1f\x8b";

// The fields of a NIfTI header that are used here, under the names of the standard.
struct NiftiHeader {
  int version = 1;
  std::endian order = std::endian::little;
  std::array<std::int64_t, 8> dim{};
  int datatype = 0;
  int bits = 0;
  std::array<double, 8> pixdim{1, 1, 1, 1, 1, 1, 1, 1};
  double data_offset = 0;  // vox_offset
  double slope = 1;
  double intercept = 0;
  int units = 2 | 8;  // mm, s
  int qform_code = 0;
  int sform_code = 0;
  std::array<double, 3> quaternion{};
  std::array<double, 3> quaternion_offset{};
  Eigen::Matrix<double, 3, 4> sform = Eigen::Matrix<double, 3, 4>::Zero();

  [[nodiscard]] bool has_position() const { return sform_code > 0 || qform_code > 0; }
  // Map from voxels to space: its matrix and its translation.
  [[nodiscard]] Eigen::Matrix3d linear(int axes) const;
  [[nodiscard]] Point<3> origin() const;
  // Writes the position of a grid as sform, and as qform when its axes are orthogonal; neither where it has none.
  void set_position(const Grid& grid);
};

constexpr std::size_t size_1 = 348;
constexpr std::size_t size_2 = 540;

// Positions of fields in the two versions of the header, whose numbers are of type Integer and Real.
struct Layout1 {
  using Integer = std::int16_t;
  using Real = float;
  using Offset = float;
  using Code = std::int16_t;
  static constexpr std::size_t size = size_1, magic = 344, dim = 40, datatype = 70, bits = 72, pixdim = 76,
                               data_offset = 108, slope = 112, intercept = 116, units = 123, qform_code = 252,
                               sform_code = 254, quaternion = 256, quaternion_offset = 268, sform = 280;
};
struct Layout2 {
  using Integer = std::int64_t;
  using Real = double;
  using Offset = std::int64_t;
  using Code = std::int32_t;
  static constexpr std::size_t size = size_2, magic = 4, dim = 16, datatype = 12, bits = 14, pixdim = 104,
                               data_offset = 168, slope = 176, intercept = 184, units = 500, qform_code = 344,
                               sform_code = 348, quaternion = 352, quaternion_offset = 376, sform = 400;
};

template <class Layout>
NiftiHeader parse_as(const char* bytes, std::endian order) {
  using Integer = typename Layout::Integer;
  using Real = typename Layout::Real;
  using Code = typename Layout::Code;
  NiftiHeader header;
  header.order = order;
  const auto real = [&](std::size_t at) { return static_cast<double>(load_scalar<Real>(bytes + at, order)); };
  for (std::size_t i = 0; i < 8; ++i) {
    header.dim[i] = load_scalar<Integer>(bytes + Layout::dim + i * sizeof(Integer), order);
    header.pixdim[i] = real(Layout::pixdim + i * sizeof(Real));
  }
  header.datatype = load_scalar<std::int16_t>(bytes + Layout::datatype, order);
  header.bits = load_scalar<std::int16_t>(bytes + Layout::bits, order);
  header.data_offset = static_cast<double>(load_scalar<typename Layout::Offset>(bytes + Layout::data_offset, order));
  header.slope = real(Layout::slope);
  header.intercept = real(Layout::intercept);
  header.units = sizeof(Code) == 2 ? bytes[Layout::units] : load_scalar<std::int32_t>(bytes + Layout::units, order);
  header.qform_code = load_scalar<Code>(bytes + Layout::qform_code, order);
  header.sform_code = load_scalar<Code>(bytes + Layout::sform_code, order);
  for (std::size_t i = 0; i < 3; ++i) {
    header.quaternion[i] = real(Layout::quaternion + i * sizeof(Real));
    header.quaternion_offset[i] = real(Layout::quaternion_offset + i * sizeof(Real));
  }
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 4; ++col) header.sform(row, col) = real(Layout::sform + (4 * row + col) * sizeof(Real));
  return header;
}

template <class Layout>
std::string format_as(const NiftiHeader& header) {
  using Integer = typename Layout::Integer;
  using Real = typename Layout::Real;
  using Code = typename Layout::Code;
  std::string out(Layout::size + 4, '\0');
  char* bytes = out.data();
  const auto put = [&](std::size_t at, auto value) { store_scalar(bytes + at, value); };
  put(0, static_cast<std::int32_t>(Layout::size));
  for (std::size_t i = 0; i < 8; ++i) {
    put(Layout::dim + i * sizeof(Integer), static_cast<Integer>(header.dim[i]));
    put(Layout::pixdim + i * sizeof(Real), static_cast<Real>(header.pixdim[i]));
  }
  put(Layout::datatype, static_cast<std::int16_t>(header.datatype));
  put(Layout::bits, static_cast<std::int16_t>(header.bits));
  put(Layout::data_offset, static_cast<typename Layout::Offset>(out.size()));
  put(Layout::slope, static_cast<Real>(header.slope));
  put(Layout::intercept, static_cast<Real>(header.intercept));
  bytes[Layout::units] = static_cast<char>(header.units);
  put(Layout::qform_code, static_cast<Code>(header.qform_code));
  put(Layout::sform_code, static_cast<Code>(header.sform_code));
  for (std::size_t i = 0; i < 3; ++i) {
    put(Layout::quaternion + i * sizeof(Real), static_cast<Real>(header.quaternion[i]));
    put(Layout::quaternion_offset + i * sizeof(Real), static_cast<Real>(header.quaternion_offset[i]));
  }
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 4; ++col)
      put(Layout::sform + (4 * row + col) * sizeof(Real), static_cast<Real>(header.sform(row, col)));
  const std::string_view magic =
      Layout::size == size_1 ? std::string_view("n+1\0", 4) : std::string_view("n+2\0\r\n\032\n", 8);
  magic.copy(bytes + Layout::magic, magic.size());
  return out;
}

Eigen::Matrix3d NiftiHeader::linear(int axes) const {
  if (sform_code > 0) return sform.leftCols<3>();
  Point<3> size = Point<3>::Ones();
  for (int axis = 0; axis < axes; ++axis) {
    const double length = std::abs(pixdim[axis + 1]);
    if (length > 0) size(axis) = length;
  }
  if (qform_code <= 0) return size.asDiagonal();
  const double b = quaternion[0], c = quaternion[1], d = quaternion[2];
  const double a = std::sqrt(std::max(0.0, 1 - (b * b + c * c + d * d)));
  Eigen::Matrix3d rotation = Eigen::Quaterniond(a, b, c, d).normalized().toRotationMatrix();
  if (pixdim[0] < 0) rotation.col(2) *= -1;  // qfac
  return rotation * size.asDiagonal();
}

Point<3> NiftiHeader::origin() const {
  if (sform_code > 0) return sform.col(3);
  if (qform_code > 0) return {quaternion_offset[0], quaternion_offset[1], quaternion_offset[2]};
  return Point<3>::Zero();
}

void NiftiHeader::set_position(const Grid& given) {
  for (int axis = 0; axis < 3; ++axis) pixdim[axis + 1] = given.spacing(axis);
  // Programs place images without a position in ways of their own: labels have to be placed as their image is.
  if (given.space == Space::unknown && given.origin.isZero(0) && given.direction.isIdentity(0)) return;
  const Grid grid = in_space(given, Space::right_anterior_superior);
  constexpr int scanner = 1;
  sform_code = scanner;
  sform << grid.to_physical<3>().linear(), grid.origin;
  Eigen::Matrix3d rotation = grid.direction;
  pixdim[0] = rotation.determinant() < 0 ? -1 : 1;
  rotation.col(2) *= pixdim[0];
  constexpr double orthogonal = 1e-6;  // cosine of axes: above the rounding of float headers
  if (!(rotation.transpose() * rotation).isIdentity(orthogonal)) return;
  qform_code = scanner;
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0) q.coeffs() *= -1;
  quaternion = {q.x(), q.y(), q.z()};
  quaternion_offset = {grid.origin(0), grid.origin(1), grid.origin(2)};
}

// Reads the header at the beginning of `bytes`, of either version and byte order.
NiftiHeader parse_nifti_header(std::string_view bytes, const std::string& name) {
  const auto has_size = [&](std::size_t size, std::endian order) {
    return bytes.size() >= 4 && load_scalar<std::uint32_t>(bytes.data(), order) == size;
  };
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const bool second = has_size(size_2, order);
    if (!second && !has_size(size_1, order)) continue;
    if (bytes.size() < (second ? size_2 : size_1)) throw IoError(name + ": the file ends within its header");
    const std::string_view magic = bytes.substr(second ? Layout2::magic : Layout1::magic, 3);
    if (magic == "ni1" || magic == "ni2")
      throw IoError(name + ": only the header of a .hdr and .img pair; convert it to a single .nii file");
    if (magic != (second ? "n+2" : "n+1"))
      throw IoError(name + ": not a NIfTI file: its magic word is neither n+1 nor n+2 (Analyze files have none)");
    NiftiHeader header = second ? parse_as<Layout2>(bytes.data(), order) : parse_as<Layout1>(bytes.data(), order);
    header.version = second ? 2 : 1;
    return header;
  }
  throw IoError(name + ": not a NIfTI file: it must begin with the header's size, 348 or 540");
}

struct Datatype {
  int code;
  SampleType type;
  Index components;
};

using enum SampleType;
constexpr Datatype datatypes[] = {
    {2, uint8, 1},    {4, int16, 1},    {8, int32, 1},    {16, float32, 1},  {64, float64, 1}, {256, int8, 1},
    {512, uint16, 1}, {768, uint32, 1}, {1024, int64, 1}, {1280, uint64, 1}, {128, uint8, 3},  {2304, uint8, 4},
};

[[noreturn]] void fail(const std::string& name, const std::string& message) {
  throw IoError(name + ": " + message);
}

void set_nifti_shape(const NiftiHeader& header, RawVolume& raw, const std::string& name) {
  const std::int64_t axes = header.dim[0];
  if (axes < 1 || axes > 7) fail(name, "field dim[0] is " + std::to_string(axes) + ", it must be 1 to 7");
  std::array<Index, 7> size{1, 1, 1, 1, 1, 1, 1};
  for (Index i = 0; i < axes; ++i) {
    size[i] = header.dim[i + 1];
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

RawVolume parse_nifti_head(std::string_view head, const std::string& name) {
  const NiftiHeader header = parse_nifti_header(head, name);
  RawVolume raw;
  raw.order = header.order;
  if (std::none_of(std::begin(datatypes), std::end(datatypes),
                   [&](const Datatype& d) { return d.code == header.datatype; }))
    fail(name, "samples of NIfTI datatype " + std::to_string(header.datatype) +
                   " are not supported; integers, float32, float64 and RGB are");
  set_nifti_shape(header, raw, name);
  set_position(header, raw.layout, name);
  if (std::isfinite(header.slope) && header.slope != 0 && std::isfinite(header.intercept)) {
    raw.slope = header.slope;
    raw.intercept = header.intercept;
  }
  const auto least = static_cast<double>(header.version == 1 ? size_1 : size_2);
  constexpr double farthest = 1e15;  // bytes, a limit on damaged files
  if (header.data_offset != 0 && !(header.data_offset >= least && header.data_offset < farthest))
    fail(name, "field vox_offset is " + std::to_string(header.data_offset) + ", the header alone is " +
                   std::to_string(static_cast<int>(least)) + " bytes long");
  // Some writers leave the field 0: the samples follow the header and four bytes that announce extensions.
  raw.offset = static_cast<std::size_t>(header.data_offset != 0 ? header.data_offset : least + 4);
  return raw;
}

RawVolume parse_nifti(std::string bytes, const std::string& name) {
  const bool compressed = bytes.starts_with(gzip_magic);
  const std::string inflated = compressed ? inflate_head(bytes, size_2, name) : std::string();
  RawVolume raw = parse_nifti_head(compressed ? std::string_view(inflated) : std::string_view(bytes), name);
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
  const Grid& grid = layout.grid;
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
    const std::size_t components = layout.components;
    const std::size_t voxels = body.size() / size / components;
    std::string planar(body.size(), '\0');
    for (std::size_t c = 0; c < components; ++c)
      for (std::size_t i = 0; i < voxels; ++i)
        body.copy(planar.data() + (c * voxels + i) * size, size, (i * components + c) * size);
    body = std::move(planar);
  }
  return {header.version == 1 ? format_as<Layout1>(header) : format_as<Layout2>(header), std::move(body)};
}

}  // namespace csrbf
