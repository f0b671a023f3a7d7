#include "csrbf/io/images/nifti_header.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"

#include <Eigen/Geometry>

namespace csrbf {
namespace {

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
    for (int col = 0; col < 4; ++col)
      header.sform(row, col) = real(Layout::sform + static_cast<std::size_t>(4 * row + col) * sizeof(Real));
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
      put(Layout::sform + static_cast<std::size_t>(4 * row + col) * sizeof(Real),
          static_cast<Real>(header.sform(row, col)));
  const std::string_view magic =
      Layout::size == size_1 ? std::string_view("n+1\0", 4) : std::string_view("n+2\0\r\n\032\n", 8);
  magic.copy(bytes + Layout::magic, magic.size());
  return out;
}

}  // namespace

Eigen::Matrix3d NiftiHeader::linear(int axes) const {
  if (sform_code > 0) return sform.leftCols<3>();
  Point<3> size = Point<3>::Ones();
  for (int axis = 0; axis < axes; ++axis) {
    const double length = std::abs(pixdim[static_cast<std::size_t>(axis) + 1]);
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

void NiftiHeader::set_position(const Grid& grid) {
  constexpr int scanner = 1;
  sform_code = scanner;
  sform << grid.to_physical<3>().linear(), grid.origin;
  for (int axis = 0; axis < 3; ++axis) pixdim[static_cast<std::size_t>(axis) + 1] = grid.spacing(axis);
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

std::string format_nifti_header(const NiftiHeader& header) {
  return header.version == 1 ? format_as<Layout1>(header) : format_as<Layout2>(header);
}

}  // namespace csrbf
