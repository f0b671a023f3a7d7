#include "csrbf/io/volume.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/io/image.hpp"

#include "io/io_testing.hpp"

#include <Eigen/Geometry>

namespace csrbf::volume_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

constexpr std::array<SampleType, 10> all_types{
    SampleType::uint8, SampleType::int8,   SampleType::uint16, SampleType::int16,   SampleType::uint32,
    SampleType::int32, SampleType::uint64, SampleType::int64,  SampleType::float32, SampleType::float64};

VolumeLayout layout_of(std::array<Index, 3> size, int axes, SampleType type) {
  VolumeLayout layout;
  layout.grid.size = size;
  layout.grid.axes = axes;
  layout.type = type;
  return layout;
}

// Values 0, 3, 6, ... 120, 0, ...: every type holds them.
Volume<double> counting(const VolumeLayout& layout) {
  Volume<double> volume(layout);
  for (std::size_t i = 0; i < volume.values.size(); ++i) volume.values[i] = static_cast<double>(3 * i % 123);
  return volume;
}

void expect_same(const Volume<double>& read, const Volume<double>& written, const std::string& what) {
  EXPECT_EQ(read.grid.size, written.grid.size) << what;
  EXPECT_EQ(read.grid.axes, written.grid.axes) << what;
  EXPECT_EQ(read.frames, written.frames) << what;
  EXPECT_EQ(read.components, written.components) << what;
  EXPECT_EQ(read.type, written.type) << what;
  EXPECT_EQ(read.values, written.values) << what;
}

Volume<double> round_trip(const std::string& path, const Volume<double>& volume) {
  write_volume(path, volume);
  return read_volume<double>(path);
}

TEST(WriteVolume, KeepsEverySampleTypeInEveryFormatOfNumbers) {
  const TemporaryFolder folder;
  for (const char* name : {"a.nii", "a.nii.gz", "a.nrrd", "a.mha", "a.mhd", "a.npy", "a.tif", "a.vti"})
    for (const SampleType type : all_types) {
      const Volume<double> volume = counting(layout_of({7, 5, 3}, 3, type));
      expect_same(round_trip(folder.file(name), volume), volume, name);
    }
  EXPECT_EQ(folder.files(), 9);  // .mhd comes with .raw; no temporary is left
}

TEST(WriteVolume, KeepsPicturesOf8And16Bits) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, Index>> formats{{"a.png", 1}, {"a.png", 2}, {"a.png", 3}, {"a.png", 4},
                                                           {"a.pgm", 1}, {"a.ppm", 3}, {"a.tif", 1}, {"a.tif", 2},
                                                           {"a.tif", 3}, {"a.tif", 4}};
  for (const auto& [name, components] : formats)
    for (const SampleType type : {SampleType::uint8, SampleType::uint16}) {
      VolumeLayout layout = layout_of({9, 4, 1}, 2, type);
      layout.components = components;
      Volume<double> volume = counting(layout);
      volume.values[5] = type == SampleType::uint8 ? 255 : 65535;
      expect_same(round_trip(folder.file(name), volume), volume, name + " of " + std::to_string(components));
    }
}

TEST(WriteVolume, KeepsComponentsTimeAndFewAxes) {
  const TemporaryFolder folder;
  for (const char* name : {"a.nii.gz", "a.nrrd", "a.mha", "a.npy"}) {
    VolumeLayout layout = layout_of({6, 5, 7}, 3, SampleType::int16);
    layout.components = 3;
    layout.frames = 2;
    const Volume<double> both = counting(layout);
    expect_same(round_trip(folder.file(name), both), both, name);
    layout.components = 1;
    layout.time_step = 0.25;
    const Volume<double> sequence = counting(layout);
    const Volume<double> read = round_trip(folder.file(name), sequence);
    expect_same(read, sequence, name);
    EXPECT_EQ(read.time_step, std::string(name) == "a.npy" ? 1 : 0.25) << name;
    layout.frames = 1;
    layout.components = 2;
    const Volume<double> vectors = counting(layout);
    expect_same(round_trip(folder.file(name), vectors), vectors, name);
    const Volume<double> slice = counting(layout_of({6, 5, 1}, 2, SampleType::uint8));
    expect_same(round_trip(folder.file(name), slice), slice, name);
    const Volume<double> signal = counting(layout_of({50, 1, 1}, 1, SampleType::float32));
    expect_same(round_trip(folder.file(name), signal), signal, name);
  }
}

Grid oblique_grid() {
  Grid grid;
  grid.size = {4, 3, 2};
  grid.spacing = {0.5, 2, 3};
  grid.origin = {-10.5, 20, 5};
  grid.direction = Eigen::AngleAxisd(2.5, Point<3>(1, 2, 3).normalized()).toRotationMatrix();
  grid.direction.col(2) *= -1;  // a left-handed one
  return grid;
}

TEST(WriteVolume, KeepsThePositionInSpace) {
  const TemporaryFolder folder;
  for (const Space space : {Space::left_posterior_superior, Space::right_anterior_superior})
    for (const char* name : {"a.nii", "a.nrrd", "a.mha", "a.mhd"}) {
      Volume<double> volume = counting(layout_of({4, 3, 2}, 3, SampleType::int16));
      volume.grid = oblique_grid();
      volume.grid.space = space;
      const Grid read = round_trip(folder.file(name), volume).grid;
      // NIfTI-1 stores floats.
      const double precision = std::string(name) == "a.nii" ? 1e-6 : 1e-14;
      // Formats of one space only turn x and y around.
      const double flip = read.space == space ? 1 : -1;
      const Point<3> turn(flip, flip, 1);
      EXPECT_TRUE(read.spacing.isApprox(volume.grid.spacing, precision)) << name;
      EXPECT_TRUE(read.origin.isApprox(turn.asDiagonal() * volume.grid.origin, precision)) << name;
      EXPECT_TRUE(read.direction.isApprox(turn.asDiagonal() * volume.grid.direction, precision)) << name;
      EXPECT_TRUE(read.space == space || std::string(name) != "a.nrrd");
    }
}

TEST(WriteVolume, KeepsNumbersOfUnknownSpace) {
  const TemporaryFolder folder;
  Volume<double> volume = counting(layout_of({4, 3, 1}, 2, SampleType::int16));
  volume.grid.spacing = {0.5, 0.25, 1};
  volume.grid.origin = {3, -4, 0};
  for (const char* name : {"a.nii", "a.nrrd", "a.mha", "a.vti"}) {
    const Grid read = round_trip(folder.file(name), volume).grid;
    EXPECT_EQ(read.spacing, volume.grid.spacing) << name;
    EXPECT_EQ(read.origin, volume.grid.origin) << name;
    EXPECT_EQ(read.direction, volume.grid.direction) << name;
  }
}

// Other programs place such an image in ways of their own, and labels as they do the image.
TEST(WriteVolume, GivesNiftiNoPositionWhereThereIsNone) {
  const TemporaryFolder folder;
  Volume<double> volume = counting(layout_of({4, 3, 2}, 3, SampleType::int16));
  volume.grid.spacing = {0.5, 2, 3};
  constexpr std::size_t qform_code = 252, sform_code = 254;
  const auto codes = [&] {
    write_volume(folder.file("a.nii"), volume);
    const std::string bytes = content(folder.file("a.nii"));
    return std::pair(static_cast<int>(bytes[qform_code]), static_cast<int>(bytes[sform_code]));
  };
  EXPECT_EQ(codes(), std::pair(0, 0));
  const Grid read = read_volume(folder.file("a.nii")).grid;
  EXPECT_EQ(read.space, Space::unknown);
  EXPECT_EQ(read.spacing, volume.grid.spacing);
  volume.grid.origin = {1, 0, 0};
  EXPECT_EQ(codes(), std::pair(1, 1));
  volume.grid.origin = {0, 0, 0};
  volume.grid.space = Space::right_anterior_superior;
  EXPECT_EQ(codes(), std::pair(1, 1));
}

TEST(WriteVolume, WritesThePositionAlsoAsQuaternion) {
  const TemporaryFolder folder;
  Volume<double> volume = counting(layout_of({4, 3, 2}, 3, SampleType::int16));
  volume.grid = oblique_grid();
  volume.grid.space = Space::right_anterior_superior;
  write_volume(folder.file("a.nii"), volume);
  std::string bytes = content(folder.file("a.nii"));
  constexpr std::size_t sform_code = 254;
  bytes[sform_code] = 0;
  const Grid read = read_volume<double>(folder.with("q.nii", bytes)).grid;
  constexpr double float_rounding = 1e-6;
  EXPECT_TRUE(read.direction.isApprox(volume.grid.direction, float_rounding));
  EXPECT_TRUE(read.spacing.isApprox(volume.grid.spacing, float_rounding));
  EXPECT_TRUE(read.origin.isApprox(volume.grid.origin, float_rounding));
}

TEST(WriteVolume, RoundsAndClampsIntegersAndKeepsNaNInFloats) {
  const TemporaryFolder folder;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Volume<double> volume(layout_of({5, 1, 1}, 1, SampleType::uint8));
  volume.values = {-3, 1.6, 300, nan, 254.4};
  EXPECT_EQ(round_trip(folder.file("a.npy"), volume).values, (std::vector<double>{0, 2, 255, 0, 254}));
  volume.type = SampleType::int64;
  volume.values = {1e300, -1e300, 1, 2, 3};
  const auto wide = round_trip(folder.file("a.nrrd"), volume).values;
  EXPECT_EQ(wide[0], 9223372036854775807.0);
  EXPECT_EQ(wide[1], -9223372036854775808.0);
  for (const char* name : {"a.nii.gz", "a.nrrd", "a.mha", "a.npy", "a.tif", "a.vti"}) {
    volume.type = SampleType::float32;
    volume.values = {nan, 0.5, -0.25, 1e30, nan};
    const auto read = round_trip(folder.file(name), volume).values;
    EXPECT_TRUE(std::isnan(read[0]) && std::isnan(read[4])) << name;
    EXPECT_EQ(read[1], 0.5) << name;
  }
}

TEST(WriteVolume, PutsSmallLabelsIntoPictures) {
  const TemporaryFolder folder;
  Volume<float> labels(layout_of({3, 2, 1}, 2, SampleType::int32), 2);
  write_volume(folder.file("a.png"), labels);
  EXPECT_EQ(read_volume(folder.file("a.png")).type, SampleType::uint8);
  labels.values[0] = 256;
  write_volume(folder.file("a.pgm"), labels);
  EXPECT_EQ(read_volume(folder.file("a.pgm")).type, SampleType::uint16);
  EXPECT_EQ(read_volume(folder.file("a.pgm")).values, labels.values);
}

TEST(ReadVolume, GivesTheSameForEveryNumberOfThreads) {
  const TemporaryFolder folder;
  VolumeLayout layout = layout_of({60, 50, 40}, 3, SampleType::int16);
  layout.components = 2;
  const Volume<double> volume = counting(layout);
  set_thread_count(1);
  const auto one = round_trip(folder.file("a.nii"), volume).values;
  const std::string bytes = content(folder.file("a.nii"));
  set_thread_count(3);
  EXPECT_EQ(round_trip(folder.file("a.nii"), volume).values, one);
  EXPECT_EQ(content(folder.file("a.nii")), bytes);
  set_thread_count(0);
}

TEST(ReadVolume, ReadsBothKindsOfPgm) {
  const TemporaryFolder folder;
  const std::vector<float> expected{0, 1, 2, 3, 4, 5};
  EXPECT_EQ(read_volume(folder.with("a.pgm", "P2\n# a comment\n3 2 # sizes\n9\n0 1 2\n3 4 5\n")).values, expected);
  EXPECT_EQ(read_volume(folder.with("a.pgm", std::string("P5 3 2 9\n\0\1\2\3\4\5", 15))).values, expected);
  const Volume<float> wide = read_volume(folder.with("a.pgm", std::string("P5 1 1 256\n\1\0", 13)));
  EXPECT_EQ(wide.values, std::vector<float>{256});
  EXPECT_EQ(wide.type, SampleType::uint16);
}

TEST(ReadVolume, ReadsTheColoursThatWritePngWrote) {
  const TemporaryFolder folder;
  RgbImage image(3, 2);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint8_t>(11 * i);
  write_png(folder.file("a.png"), image);
  const Volume<float> read = read_volume(folder.file("a.png"));
  EXPECT_EQ(read.components, 3);
  EXPECT_EQ(read.values, std::vector<float>(image.pixels.begin(), image.pixels.end()));
}

TEST(ReadVolume, ReadsTextHeadersOfOthers) {
  const TemporaryFolder folder;
  const std::vector<float> expected{1, 2, 3, 4, 5, 6};
  const Volume<float> nrrd = read_volume(
      folder.with("a.nrrd",
                  "NRRD0004\r\n# comment\r\ntype: unsigned short\r\nkey:=value\r\ndimension: 2\r\nsizes: 3 2\r\n"
                  "spacings: 0.5 2\r\nencoding: ascii\r\n\r\n1 2 3\r\n4,5 6\r\n"));
  EXPECT_EQ(nrrd.values, expected);
  EXPECT_EQ(nrrd.grid.spacing, Point<3>(0.5, 2, 1));
  EXPECT_EQ(nrrd.type, SampleType::uint16);
  const Volume<float> las =
      read_volume(folder.with("b.nrrd",
                              "NRRD0004\ntype: uchar\ndimension: 3\nspace: left-anterior-superior\nsizes: 3 2 1\n"
                              "space directions: (2,0,0) (0,1,0) (0,0,1)\nspace origin: (5, 6, 7)\nencoding: raw\n\n"
                              "\1\2\3\4\5\6"));
  EXPECT_EQ(las.values, expected);
  EXPECT_EQ(las.grid.space, Space::right_anterior_superior);
  EXPECT_EQ(las.grid.origin, Point<3>(-5, 6, 7));
  EXPECT_EQ(las.grid.direction(0, 0), -1);
  const Volume<float> mha = read_volume(
      folder.with("a.mha",
                  "ObjectType = Image\nNDims = 2\nBinaryData = True\nBinaryDataByteOrderMSB = True\n"
                  "DimSize = 3 2\nElementSpacing = 0.5 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n" +
                      std::string("\0\1\0\2\0\3\0\4\0\5\0\6", 12)));
  EXPECT_EQ(mha.values, expected);
  EXPECT_EQ(mha.grid.spacing, Point<3>(0.5, 2, 1));
  (void)folder.with("data.raw", "skipped\1\2\3\4\5\6");
  EXPECT_EQ(read_volume(folder.with("a.mhd",
                                    "NDims = 2\nDimSize = 3 2\nElementType = MET_UCHAR\nHeaderSize = -1\n"
                                    "ElementDataFile = data.raw\n"))
                .values,
            expected);
  EXPECT_EQ(read_volume(folder.with("c.nrrd",
                                    "NRRD0001\ntype: uchar\ndimension: 2\nsizes: 3 2\nbyte skip: 7\n"
                                    "encoding: raw\ndata file: data.raw\n"))
                .values,
            expected);
}

TEST(ReadVolume, ScalesNiftiSamplesAndTurnsLengthsIntoMillimetres) {
  const TemporaryFolder folder;
  write_volume(folder.file("a.nii"), counting(layout_of({4, 3, 2}, 3, SampleType::int16)));
  std::string bytes = content(folder.file("a.nii"));
  const auto put = [&](std::size_t at, float value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
  put(112, 0.5F);  // scl_slope
  put(116, -1);    // scl_inter
  bytes[123] = 3;  // micrometres
  const Volume<float> read = read_volume(folder.with("b.nii", bytes));
  EXPECT_EQ(read.type, SampleType::float32);
  EXPECT_EQ(read.values[5], 0.5F * 15 - 1);
  EXPECT_NEAR(read.grid.spacing(0), 1e-3, 1e-9);
}

TEST(ReadVolume, TellsComponentsFromSlicesInArrays) {
  const TemporaryFolder folder;
  const auto read = [&](std::array<Index, 3> size, Index components, Index frames) {
    VolumeLayout layout = layout_of(size, size[2] > 1 ? 3 : 2, SampleType::uint8);
    layout.components = components;
    layout.frames = frames;
    return round_trip(folder.file("a.npy"), counting(layout));
  };
  EXPECT_EQ(read({20, 10, 1}, 3, 1).components, 3);
  EXPECT_EQ(read({3, 10, 4}, 1, 1).components, 1);  // 4 slices of 3 columns
  EXPECT_EQ(read({20, 10, 5}, 1, 6).frames, 6);
  EXPECT_EQ(read({20, 10, 5}, 3, 6).components, 3);
}

// The same position in the other space of patients.
Grid turned(Grid grid) {
  grid.origin.head(2) *= -1;
  grid.direction.topRows(2) *= -1;
  return grid;
}

// Medical images beside the project, which not every machine has.
std::filesystem::path image(const std::string& name) {
  return std::filesystem::path(__FILE__).parent_path() / "../../../shared/data/images" / name;
}

TEST(ReadVolume, ReadsMedicalImagesAndConvertsThemWithoutLoss) {
  const TemporaryFolder folder;
  struct Case {
    const char* name;
    std::array<Index, 3> size;
    SampleType type;
    Point<3> spacing, origin;
  };
  const std::array<Case, 4> cases{
      {{"brain1_image.nrrd", {256, 256, 25}, SampleType::int16, {0.78125, 0.78125, 6.5}, {-99.609375, 99.609375, -78}},
       {"brain1_label.nrrd", {256, 256, 25}, SampleType::int32, {0.78125, 0.78125, 6.5}, {-99.609375, 99.609375, -78}},
       {"example_ct_sm.nii.gz", {122, 101, 30}, SampleType::int16, {3, 3, 3}, {-177.95633, 11.319, 94.30176}},
       {"example_seg.nii.gz", {122, 101, 30}, SampleType::uint8, {3, 3, 3}, {-177.95633, 11.319, 94.30176}}}};
  constexpr double float_rounding = 1e-6;
  for (const Case& c : cases) {
    if (!std::filesystem::exists(image(c.name))) GTEST_SKIP() << "no images: " << image(c.name);
    const Volume<double> volume = read_volume<double>(image(c.name).string());
    EXPECT_EQ(volume.grid.size, c.size) << c.name;
    EXPECT_EQ(volume.type, c.type) << c.name;
    EXPECT_TRUE(volume.grid.spacing.isApprox(c.spacing, float_rounding)) << c.name;
    EXPECT_TRUE(volume.grid.origin.isApprox(c.origin, float_rounding)) << c.name;
    for (const char* name : {"a.mha", "a.nii", "a.nrrd"}) {
      const Volume<double> read = round_trip(folder.file(name), volume);
      expect_same(read, volume, name);
      const Grid same = read.grid.space == volume.grid.space ? read.grid : turned(read.grid);
      EXPECT_TRUE(same.origin.isApprox(volume.grid.origin, float_rounding)) << name;
      EXPECT_TRUE(same.direction.isApprox(volume.grid.direction, float_rounding)) << name;
    }
  }
}

}  // namespace
}  // namespace csrbf::volume_test
