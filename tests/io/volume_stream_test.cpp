#include "csrbf/io/volume_stream.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/deflate.hpp"
#include "csrbf/io/files/read_file.hpp"
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
  for (const char* name : {"image.nii", "image.nii.gz", "image.npy"})
    for (const SampleType type : {SampleType::uint8, SampleType::int16, SampleType::float64}) {
      const Volume<float> whole = image(type);
      write_volume(path(name), whole);
      std::optional<VolumeStream> stream = VolumeStream::open(path(name));
      ASSERT_TRUE(stream) << name;
      EXPECT_EQ(stream->layout().grid.size, whole.grid.size);
      for (const auto& [begin, end] : {std::pair<Index, Index>{3, 5}, {0, 1}, {0, 5}})
        EXPECT_TRUE(std::ranges::equal(stream->read(begin, end), std::vector<float>(whole.values.begin() + 12 * begin,
                                                                                    whole.values.begin() + 12 * end)));
      std::vector<double> doubles(24);
      stream->read(2, 4, doubles);
      EXPECT_TRUE(std::equal(doubles.begin(), doubles.end(), whole.values.begin() + 24));
    }
}

// States of the decompressor are kept on the way: from them it goes back and forth in more content than one of them
// holds, in a file of two members.
TEST_F(VolumeStreamTest, ReadsCompressedSlicesInAnyOrder) {
  VolumeLayout layout;
  layout.grid.size = {1 << 10, 1 << 9, 90};
  layout.type = SampleType::uint8;
  Volume<float> whole(layout);
  std::mt19937 random(1);
  for (float& value : whole.values) value = static_cast<float>(random() % 5);
  write_volume(path("image.nii"), whole);
  const std::string bytes = read_file(path("image.nii"));
  const std::size_t half = bytes.size() / 2;
  write_file(path("image.nii.gz"), deflate_bytes({std::string_view(bytes).substr(0, half)}, DeflateFormat::gzip) +
                                       deflate_bytes({std::string_view(bytes).substr(half)}, DeflateFormat::gzip));
  std::optional<VolumeStream> stream = VolumeStream::open(path("image.nii.gz"));
  ASSERT_TRUE(stream);
  const Index slice = Index{1} << 19;
  for (const auto& [begin, end] :
       {std::pair<Index, Index>{40, 50}, {88, 90}, {0, 1}, {85, 90}, {30, 35}, {89, 90}, {60, 61}})
    EXPECT_TRUE(std::ranges::equal(stream->read(begin, end),
                                   std::span(whole.values).subspan(slice * begin, slice * (end - begin))))
        << begin;
}

TEST_F(VolumeStreamTest, TellsDamagedCompressedFiles) {
  write_volume(path("whole.nii.gz"), image(SampleType::uint8));
  const std::string bytes = read_file(path("whole.nii.gz"));
  std::string flipped = bytes;
  flipped[bytes.size() - 6] ^= 1;  // of the checksum
  for (const std::string& damaged : {bytes.substr(0, bytes.size() - 1), flipped}) {
    write_file(path("image.nii.gz"), damaged);
    EXPECT_THROW(
        {
          std::optional<VolumeStream> stream = VolumeStream::open(path("image.nii.gz"));
          stream->read(0, 5);
        },
        IoError);
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
  write_volume(path("image.nrrd"), image(SampleType::uint8));
  for (const char* name : {"image.nrrd", "none.nii"}) EXPECT_FALSE(VolumeStream::open(path(name)));
}

TEST_F(VolumeStreamTest, RefusesFilesThatAreTooShort) {
  write_volume(path("image.nii"), image(SampleType::uint8));
  std::filesystem::resize_file(path("image.nii"), 380);
  EXPECT_THROW((void)VolumeStream::open(path("image.nii")), IoError);
}

TEST_F(VolumeStreamTest, WritesWhatWriteVolumeWrites) {
  const Volume<float> whole = image(SampleType::uint8);
  for (const char* name : {"slices.nii", "slices.nii.gz", "slices.npy"}) {
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
  EXPECT_FALSE(VolumeWriter::can_write("labels.nrrd"));
}

}  // namespace
}  // namespace csrbf::volume_stream_test
