#include "csrbf/io/images/dicom.hpp"

#include "csrbf/io/volume.hpp"
#include "io/io_testing.hpp"

#include <Eigen/Geometry>

#include <cstring>
#include <functional>

#ifdef CSRBF_HAS_GDCM
#include <gdcmImageWriter.h>
#include <gdcmReader.h>
#include <gdcmTrace.h>
#include <gdcmUIDGenerator.h>
#include <gdcmWriter.h>
#endif

namespace csrbf::dicom_test {
namespace {

using testing::io_error;
using testing::TemporaryFolder;

TEST(Dicom, IsKnownByExtensionMagicOrAsAFolder) {
  const TemporaryFolder folder;
  EXPECT_TRUE(is_dicom("a.dcm"));
  EXPECT_TRUE(is_dicom(folder.folder()));
  EXPECT_TRUE(is_dicom(folder.with("IM0001", std::string(128, '\0') + "DICM...")));
  EXPECT_FALSE(is_dicom(folder.with("IM0002", std::string(127, '\0') + "DICM...")));
  EXPECT_FALSE(is_dicom(folder.with("short", "DICM")));
  EXPECT_FALSE(is_dicom(folder.file("missing")));
  EXPECT_TRUE(is_readable_volume(folder.folder()));
  EXPECT_FALSE(is_volume_file("a.dcm")) << "they are not written";
}

#ifndef CSRBF_HAS_GDCM

TEST(Dicom, SaysHowItCouldBeRead) {
  const TemporaryFolder folder;
  EXPECT_FALSE(reads_dicom());
  EXPECT_EQ(
      io_error([] { read_volume("a.dcm"); }),
      "a.dcm: DICOM files cannot be read: this program was built without GDCM; install it (libgdcm-dev) and build "
      "again, or convert to .nii.gz");
  EXPECT_NE(io_error([&] { read_volume(folder.folder()); }).find("built without GDCM"), std::string::npos);
}

#else

// How a slice of 4 x 3 pixels is written.
struct Written {
  std::string series = "1.2.3.4";
  std::string description = "head";
  Point<3> position = Point<3>::Zero();
  Point<3> row = Point<3>::UnitX(), column = Point<3>::UnitY();
  std::array<double, 2> spacing{0.5, 0.75};  // along rows and along columns
  double slope = 1, intercept = 0;
  unsigned width = 4, height = 3, frames = 1;
  int first = 0;  // of the samples, which count up
  bool placed = true;
  const char* storage = "1.2.840.10008.5.1.4.1.1.2";  // CT
  gdcm::PixelFormat format = gdcm::PixelFormat::INT16;
  gdcm::PhotometricInterpretation colors = gdcm::PhotometricInterpretation::MONOCHROME2;
};

const Eigen::IOFormat with_backslashes(Eigen::StreamPrecision, Eigen::DontAlignCols, "\\", "\\");

template <std::uint16_t Group, std::uint16_t Element>
void set_text(gdcm::DataSet& data, gdcm::VR::VRType type, std::string text) {
  if (text.size() % 2 != 0) text += type == gdcm::VR::UI ? '\0' : ' ';
  gdcm::DataElement element(gdcm::Tag(Group, Element));
  element.SetVR(type);
  element.SetByteValue(text.data(), static_cast<std::uint32_t>(text.size()));
  data.Replace(element);
}

void write_slice(const std::string& path, const Written& w) {
  gdcm::Trace::WarningOff();
  gdcm::ImageWriter writer;
  gdcm::Image& image = writer.GetImage();
  image.SetNumberOfDimensions(w.frames > 1 ? 3 : 2);
  image.SetDimension(0, w.width);
  image.SetDimension(1, w.height);
  if (w.frames > 1) image.SetDimension(2, w.frames);
  image.SetPixelFormat(w.format);
  image.SetPhotometricInterpretation(w.colors);
  image.SetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
  image.SetSpacing(0, w.spacing[0]);
  image.SetSpacing(1, w.spacing[1]);
  for (unsigned a = 0; a < 3; ++a) {
    image.SetOrigin(a, w.position[a]);
    image.SetDirectionCosines(a, w.row[a]);
    image.SetDirectionCosines(a + 3, w.column[a]);
  }
  image.SetSlope(w.slope);
  image.SetIntercept(w.intercept);
  const std::size_t bytes = std::size_t{w.width} * w.height * w.frames * w.format.GetPixelSize();
  std::string samples(bytes, '\0');
  for (std::size_t i = 0; i < bytes; i += w.format.GetPixelSize()) {
    const auto sample = static_cast<std::int16_t>(w.first + static_cast<int>(i / w.format.GetPixelSize()));
    std::memcpy(samples.data() + i, &sample, std::min<std::size_t>(2, w.format.GetPixelSize()));
  }
  gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
  pixels.SetByteValue(samples.data(), static_cast<std::uint32_t>(bytes));
  image.SetDataElement(pixels);
  gdcm::DataSet& data = writer.GetFile().GetDataSet();
  set_text<0x0008, 0x0016>(data, gdcm::VR::UI, w.storage);
  set_text<0x0008, 0x0018>(data, gdcm::VR::UI, gdcm::UIDGenerator().Generate());
  set_text<0x0008, 0x103e>(data, gdcm::VR::LO, w.description);
  set_text<0x0020, 0x000e>(data, gdcm::VR::UI, w.series);
  writer.SetFileName(path.c_str());
  ASSERT_TRUE(writer.Write()) << path;
  // The writer takes no direction whose length is not 1 to the last digit.
  gdcm::Reader reader;
  reader.SetFileName(path.c_str());
  ASSERT_TRUE(reader.Read());
  std::ostringstream directions;
  directions << w.row.transpose().format(with_backslashes) << '\\' << w.column.transpose().format(with_backslashes);
  set_text<0x0020, 0x0037>(reader.GetFile().GetDataSet(), gdcm::VR::DS, directions.str());
  gdcm::Writer directed;
  directed.SetFile(reader.GetFile());
  directed.SetFileName(path.c_str());
  ASSERT_TRUE(directed.Write());
}

void write_stack(const TemporaryFolder& folder, const std::vector<double>& heights, Written w = {}) {
  const Point<3> normal = w.row.cross(w.column), start = w.position;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    w.position = start + heights[i] * normal;
    w.first = static_cast<int>(1000 * heights[i]);
    write_slice(folder.file("slice" + std::to_string(i)), w);
  }
}

std::string message(const TemporaryFolder& folder) {
  std::string text = io_error([&] { read_volume(folder.folder()); });
  for (std::size_t at = 0; (at = text.find(folder.folder())) != std::string::npos;)
    text.replace(at, folder.folder().size(), "F");
  return text;
}

constexpr double decimals = 1e-5;  // of positions, which files hold as text

TEST(Dicom, OrdersSlicesAlongTheirNormal) {
  const TemporaryFolder folder;
  EXPECT_TRUE(reads_dicom());
  Written w;
  w.position = {-7, 8, 9};
  w.row = Point<3>(0, 0.6, 0.8);
  w.column = Point<3>(1, 0, 0);
  write_stack(folder, {5, 2.5, 0, 7.5}, w);
  const Volume<float> volume = read_volume(folder.folder());
  const Grid& grid = volume.grid;
  EXPECT_EQ(grid.size, (std::array<Index, 3>{4, 3, 4}));
  EXPECT_EQ(grid.axes, 3);
  EXPECT_EQ(volume.type, SampleType::int16);
  EXPECT_EQ(grid.space, Space::left_posterior_superior);
  EXPECT_TRUE(grid.spacing.isApprox(Point<3>(0.5, 0.75, 2.5), decimals));
  EXPECT_TRUE(grid.origin.isApprox(w.position, decimals));
  EXPECT_TRUE(grid.direction.col(0).isApprox(w.row, decimals));
  EXPECT_TRUE(grid.direction.col(1).isApprox(w.column, decimals));
  EXPECT_TRUE(grid.direction.col(2).isApprox(w.row.cross(w.column), decimals));
  for (Index z = 0; z < 4; ++z)
    for (Index i = 0; i < 12; ++i) EXPECT_EQ(volume.values[12 * z + i], static_cast<float>(2500 * z + i));
}

TEST(Dicom, ReadsOneFile) {
  const TemporaryFolder folder;
  Written w;
  w.position = {1, 2, 3};
  write_slice(folder.file("a.dcm"), w);
  const Volume<float> volume = read_volume(folder.file("a.dcm"));
  EXPECT_EQ(volume.grid.size, (std::array<Index, 3>{4, 3, 1}));
  EXPECT_EQ(volume.grid.axes, 2);
  EXPECT_EQ(volume.grid.origin, w.position);
  EXPECT_TRUE(volume.grid.spacing.head(2).isApprox(Point<2>(0.5, 0.75), decimals));
}

TEST(Dicom, RescalesSamples) {
  const TemporaryFolder folder;
  Written w;
  w.slope = 2;
  w.intercept = -1024;
  write_slice(folder.file("a"), w);
  EXPECT_EQ(read_volume(folder.file("a")).values[5], -1014);
  // With a scale of its own in each slice.
  w.position = {0, 0, 1};
  w.slope = 0.5;
  write_slice(folder.file("b"), w);
  const Volume<float> volume = read_volume(folder.folder());
  EXPECT_EQ(volume.type, SampleType::float32);
  EXPECT_EQ(volume.values[5], -1014);
  EXPECT_EQ(volume.values[12 + 5], -1021.5F);
}

TEST(Dicom, KeepsTheShearOfATiltedGantry) {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) {
    Written w;
    w.position = Point<3>(0, 0.3 * i, 2 * i);
    write_slice(folder.file(std::to_string(i)), w);
  }
  const Grid grid = read_volume(folder.folder()).grid;
  EXPECT_TRUE((grid.to_physical<3>() * Point<3>(0, 0, 2)).isApprox(Point<3>(0, 0.6, 4), decimals));
}

TEST(Dicom, TakesFramesOfUltrasoundForTime) {
  const TemporaryFolder folder;
  Written w;
  w.frames = 5;
  w.storage = "1.2.840.10008.5.1.4.1.1.3.1";
  w.format = gdcm::PixelFormat::UINT8;
  write_slice(folder.file("a.dcm"), w);
  const Volume<float> volume = read_volume(folder.file("a.dcm"));
  EXPECT_EQ(volume.frames, 5);
  EXPECT_EQ(volume.grid.size, (std::array<Index, 3>{4, 3, 1}));
  EXPECT_EQ(volume.type, SampleType::uint8);
  EXPECT_EQ(volume.frame(4)(0, 11), 59);
}

TEST(Dicom, LeavesOtherFilesAside) {
  const TemporaryFolder folder;
  write_stack(folder, {0, 1});
  (void)folder.with("readme.txt", "not an image");
  std::filesystem::create_directory(folder.file("more"));
  EXPECT_EQ(read_volume(folder.folder()).grid.size[2], 2);
}

TEST(Dicom, NamesTheSeriesOfAMixedFolder) {
  const TemporaryFolder folder;
  write_stack(folder, {0, 1});
  Written other;
  other.series = "1.2.3.5";
  other.description = "chest";
  write_slice(folder.file("z"), other);
  EXPECT_EQ(
      message(folder),
      "F: the folder holds images of 2 series: head = 1.2.3.4 (2 files), chest = 1.2.3.5 (1 file); move each to a "
      "folder of its own");
}

TEST(Dicom, RefusesSlicesThatDoNotMakeAStack) {
  {
    const TemporaryFolder folder;
    write_stack(folder, {0, 1, 2, 4});
    EXPECT_NE(message(folder).find("mm from where even distances of 1.333333 mm would put it; is a slice missing?"),
              std::string::npos);
  }
  {
    const TemporaryFolder folder;
    write_stack(folder, {0, 1, 1, 2});
    EXPECT_EQ(
        message(folder),
        "F/slice2: the slice has the same position as F/slice1; sequences of volumes are not supported: move each to "
        "a folder of its own");
  }
  const auto with_second = [](const std::function<void(Written&)>& change) {
    const TemporaryFolder folder;
    Written w;
    write_slice(folder.file("a"), w);
    w.position[2] = 1;
    change(w);
    write_slice(folder.file("b"), w);
    return message(folder);
  };
  EXPECT_EQ(with_second([](Written& w) { w.column = Point<3>(0, 0.8, 0.6); }), "F/b: the slice is not parallel to F/a");
  EXPECT_EQ(with_second([](Written& w) { w.width = 5; }), "F/b: the size of the image differs from that of F/a");
  EXPECT_EQ(with_second([](Written& w) { w.spacing[0] = 1; }), "F/b: the spacing differs from that of F/a");
  EXPECT_EQ(with_second([](Written& w) { w.format = gdcm::PixelFormat::UINT16; }),
            "F/b: the type of the samples differs from that of F/a");
}

TEST(Dicom, RefusesColourDamageAndOtherFiles) {
  const TemporaryFolder folder;
  EXPECT_EQ(message(folder), "F: the folder holds no DICOM image");
  Written w;
  w.storage = "1.2.840.10008.5.1.4.1.1.7";
  w.format = gdcm::PixelFormat::UINT8;
  w.format.SetSamplesPerPixel(3);
  w.colors = gdcm::PhotometricInterpretation::RGB;
  write_slice(folder.file("color.dcm"), w);
  EXPECT_EQ(message(folder), "F/color.dcm: pictures in colour (RGB) are not supported; convert to grey values");
  const std::string text = folder.with("text.dcm", "not a picture"), empty = folder.with("empty.dcm", "");
  EXPECT_EQ(io_error([&] { read_volume(text); }), text + ": not a DICOM file, or one without an image");
  EXPECT_EQ(io_error([&] { read_volume(empty); }), empty + ": not a DICOM file, or one without an image");
  EXPECT_EQ(io_error([] { read_volume("missing.dcm"); }),
            "missing.dcm: cannot read the file: No such file or directory");
  write_slice(folder.file("whole.dcm"), {});
  const std::string bytes = testing::content(folder.file("whole.dcm"));
  for (std::size_t size = 1; size < bytes.size(); size += 7) {
    const std::string cut = folder.with("cut.dcm", bytes.substr(0, size));
    EXPECT_TRUE(io_error([&] { read_volume(cut); }).starts_with(cut)) << size << " of " << bytes.size();
  }
}

#endif

}  // namespace
}  // namespace csrbf::dicom_test
