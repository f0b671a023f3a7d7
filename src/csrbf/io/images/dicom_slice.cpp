#ifdef CSRBF_HAS_GDCM

#include "csrbf/io/images/dicom_slice.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/images/dicom_structure.hpp"
#include "csrbf/io/images/sample_codec.hpp"

#include <gdcmAttribute.h>
#include <gdcmImageReader.h>
#include <gdcmMediaStorage.h>
#include <gdcmTrace.h>

#include <sstream>

namespace csrbf::dicom {
namespace {

const gdcm::Tag series_description(0x0008, 0x103e);
const gdcm::Tag series_uid(0x0020, 0x000e);
const gdcm::Tag rows(0x0028, 0x0010);
const gdcm::Tag pixel_data(0x7fe0, 0x0010);

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw IoError(path + ": " + message);
}

// A library does not print.
void silence() {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
}

std::string text_of(const gdcm::DataSet& data, const gdcm::Tag& tag) {
  if (!data.FindDataElement(tag)) return "";
  const gdcm::ByteValue* const bytes = data.GetDataElement(tag).GetByteValue();
  if (bytes == nullptr) return "";
  std::string text(bytes->GetPointer(), bytes->GetLength());
  text.erase(std::find(text.begin(), text.end(), '\0'), text.end());
  return std::string(trimmed(text));
}

// Refuses values with which GDCM would abort the program.
void check_numbers(const gdcm::DataSet& data, const std::string& path) {
  const auto number = [&](std::uint16_t element) -> unsigned {
    const gdcm::ByteValue* const bytes = data.GetDataElement(gdcm::Tag(0x0028, element)).GetByteValue();
    return bytes != nullptr && bytes->GetLength() == 2 ? load_scalar<std::uint16_t>(bytes->GetPointer()) : 0;
  };
  const unsigned columns = number(0x0011), samples = number(0x0002), bits = number(0x0100);
  if (number(rows.GetElement()) == 0 || columns == 0) fail(path, "the image has no pixels");
  if (samples != 1 && samples != 3 && samples != 4)
    fail(path, "pixels of " + std::to_string(samples) + " samples are not supported");
  constexpr std::array<unsigned, 5> known{8, 12, 16, 32, 64};
  if (std::find(known.begin(), known.end(), bits) == known.end())
    fail(path, "samples of " + std::to_string(bits) + " bits are not supported");
}

void read_place(const gdcm::DataSet& data, Slice& slice) {
  gdcm::Attribute<0x0020, 0x0032> position;
  gdcm::Attribute<0x0020, 0x0037> orientation;
  if (text_of(data, position.GetTag()).empty() || text_of(data, orientation.GetTag()).empty()) return;
  position.SetFromDataSet(data);
  orientation.SetFromDataSet(data);
  for (unsigned i = 0; i < 3; ++i) {
    slice.origin[i] = position.GetValue(i);
    slice.axes(i, 0) = orientation.GetValue(i);
    slice.axes(i, 1) = orientation.GetValue(i + 3);
  }
  constexpr double singular = 1e-6;
  if (!slice.origin.allFinite() || !(slice.normal().norm() > singular))
    fail(slice.path, "position or orientation of the image are not valid numbers");
  slice.axes.colwise().normalize();
  slice.placed = true;
}

SampleType type_of(const gdcm::PixelFormat& format, const std::string& path) {
  using Format = gdcm::PixelFormat;
  using enum SampleType;
  constexpr std::pair<Format::ScalarType, SampleType> types[] = {
      {Format::UINT8, uint8},   {Format::INT8, int8},   {Format::UINT16, uint16},   {Format::INT16, int16},
      {Format::UINT32, uint32}, {Format::INT32, int32}, {Format::FLOAT32, float32}, {Format::FLOAT64, float64},
  };
  for (const auto& [scalar, type] : types)
    if (scalar == format.GetScalarType()) return type;
  fail(path, std::string("samples of type ") + format.GetScalarTypeAsString() + " are not supported");
}

void read_frames(const gdcm::File& file, Image& image) {
  gdcm::MediaStorage storage;
  storage.SetFromFile(file);
  constexpr std::array<gdcm::MediaStorage::MSType, 4> sequences{
      gdcm::MediaStorage::UltrasoundMultiFrameImageStorage, gdcm::MediaStorage::UltrasoundMultiFrameImageStorageRetired,
      gdcm::MediaStorage::XRayAngiographicImageStorage, gdcm::MediaStorage::XRayRadiofluoroscopingImageStorage};
  image.is_sequence = std::find(sequences.begin(), sequences.end(), storage) != sequences.end();
  gdcm::Attribute<0x0018, 0x1063> frame_time;  // ms
  if (text_of(file.GetDataSet(), frame_time.GetTag()).empty()) return;
  frame_time.SetFromDataSet(file.GetDataSet());
  if (frame_time.GetValue() > 0) image.time_step = frame_time.GetValue() / 1000;
}

}  // namespace

std::optional<Slice> read_header(const std::string& path) {
  const std::string bytes = read_file(path);
  if (!has_preamble(bytes)) return std::nullopt;
  if (!is_whole(bytes)) fail(path, "the file is damaged or truncated");
  silence();
  std::istringstream stream(bytes);
  gdcm::Reader reader;
  reader.SetStream(stream);
  if (!reader.ReadUpToTag(pixel_data)) return std::nullopt;
  const gdcm::DataSet& data = reader.GetFile().GetDataSet();
  if (!data.FindDataElement(rows)) return std::nullopt;
  check_numbers(data, path);
  Slice slice;
  slice.path = path;
  slice.series = text_of(data, series_uid);
  slice.description = text_of(data, series_description);
  read_place(data, slice);
  return slice;
}

Image read_image(const std::string& path) {
  silence();
  gdcm::ImageReader reader;
  reader.SetFileName(path.c_str());
  if (!reader.Read()) fail(path, "the image cannot be read: the file is damaged or of an unsupported kind");
  const gdcm::Image& source = reader.GetImage();
  const gdcm::PhotometricInterpretation& colors = source.GetPhotometricInterpretation();
  if (source.GetPixelFormat().GetSamplesPerPixel() != 1 || colors == gdcm::PhotometricInterpretation::PALETTE_COLOR)
    fail(path, "pictures in colour (" + std::string(trimmed(gdcm::PhotometricInterpretation::GetPIString(colors))) +
                   ") are not supported; convert to grey values");
  Image image;
  for (unsigned a = 0; a < source.GetNumberOfDimensions() && a < 3; ++a) {
    image.size[a] = source.GetDimension(a);
    image.spacing[a] = source.GetSpacing(a);
  }
  if (!(image.spacing.allFinite() && image.spacing.minCoeff() > 0))
    fail(path, "the spacing of the image is not positive");
  read_frames(reader.GetFile(), image);
  image.type = type_of(source.GetPixelFormat(), path);
  image.slope = source.GetSlope();
  image.intercept = source.GetIntercept();
  const Index samples = image.size[0] * image.size[1] * image.size[2];
  image.samples.resize(source.GetBufferLength());
  if (image.samples.size() != static_cast<std::size_t>(samples) * sample_size(image.type) ||
      !source.GetBuffer(image.samples.data()))
    fail(path, "the samples cannot be decompressed: the file is damaged or compressed in an unsupported way");
  return image;
}

}  // namespace csrbf::dicom

#endif
