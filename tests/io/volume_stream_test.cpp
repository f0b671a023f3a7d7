#include "csrbf/io/volume_stream.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/volume.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

namespace csrbf::volume_stream_test {
namespace {

class VolumeStreamTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static Volume<float> image(SampleType type) {
    VolumeLayout layout;
    layout.grid.size = {4, 3, 5};
    layout.grid.spacing = Point<3>(1, 2, 0.5);
    layout.type = type;
    Volume<float> volume(layout);
    for (std::size_t i = 0; i < volume.values.size(); ++i) volume.values[i] = static_cast<float>(3 * i);
    return volume;
  }

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("csrbf_volume_stream_" + std::to_string(std::random_device{}()));
};

TEST_F(VolumeStreamTest, ReadsSlicesInAnyOrder) {
  for (const char* name : {"image.nii", "image.npy"})
    for (const SampleType type : {SampleType::uint8, SampleType::int16, SampleType::float64}) {
      const Volume<float> whole = image(type);
      write_volume(path(name), whole);
      std::optional<VolumeStream> stream = VolumeStream::open(path(name));
      ASSERT_TRUE(stream) << name;
      EXPECT_EQ(stream->layout().grid.size, whole.grid.size);
      for (const auto& [begin, end] : {std::pair<Index, Index>{3, 5}, {0, 1}, {0, 5}})
        EXPECT_TRUE(std::ranges::equal(stream->read(begin, end), std::vector<float>(whole.values.begin() + 12 * begin,
                                                                                    whole.values.begin() + 12 * end)));
    }
}

TEST_F(VolumeStreamTest, SaysTheTypeOfScaledValues) {
  write_volume(path("image.nii"), image(SampleType::int16));
  {
    std::fstream file(path("image.nii"), std::ios::binary | std::ios::in | std::ios::out);
    constexpr std::streamoff slope_field = 112;
    const float slope = 0.5F;
    file.seekp(slope_field);
    file.write(reinterpret_cast<const char*>(&slope), sizeof slope);
  }
  const Volume<float> whole = read_volume(path("image.nii"));
  std::optional<VolumeStream> stream = VolumeStream::open(path("image.nii"));
  ASSERT_TRUE(stream);
  EXPECT_EQ(stream->layout().type, whole.type);
  EXPECT_EQ(whole.type, SampleType::float32);
  EXPECT_TRUE(std::ranges::equal(stream->read(0, 5), whole.values));
}

TEST_F(VolumeStreamTest, LeavesOtherFilesToReadVolume) {
  write_volume(path("image.nii.gz"), image(SampleType::uint8));
  write_volume(path("image.nrrd"), image(SampleType::uint8));
  for (const char* name : {"image.nii.gz", "image.nrrd", "none.nii"}) EXPECT_FALSE(VolumeStream::open(path(name)));
}

TEST_F(VolumeStreamTest, RefusesFilesThatAreTooShort) {
  write_volume(path("image.nii"), image(SampleType::uint8));
  std::filesystem::resize_file(path("image.nii"), 380);
  EXPECT_THROW((void)VolumeStream::open(path("image.nii")), IoError);
}

TEST_F(VolumeStreamTest, WritesWhatWriteVolumeWrites) {
  const Volume<float> whole = image(SampleType::uint8);
  for (const char* name : {"slices.nii", "slices.npy"}) {
    ASSERT_TRUE(VolumeWriter::can_write(path(name)));
    VolumeWriter writer(path(name), whole);
    EXPECT_FALSE(std::filesystem::exists(path(name)));
    for (Index z = 0; z < 5; ++z) {
      std::string samples;
      for (Index i = 12 * z; i < 12 * (z + 1); ++i) samples += static_cast<char>(whole.values[i]);
      writer.write(samples);
    }
    writer.commit();
    const Volume<float> back = read_volume(path(name));
    EXPECT_EQ(back.values, whole.values);
    EXPECT_EQ(back.grid.size, whole.grid.size);
    EXPECT_EQ(back.type, SampleType::uint8);
  }
  EXPECT_FALSE(VolumeWriter::can_write("labels.nii.gz"));
}

}  // namespace
}  // namespace csrbf::volume_stream_test
