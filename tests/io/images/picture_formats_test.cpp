#include "csrbf/io/images/formats.hpp"
#include "csrbf/io/volume.hpp"

#include "io/io_testing.hpp"

namespace csrbf::picture_formats_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

Volume<float> ramp(Index width, Index height, Index components) {
  Volume<float> image;
  image.grid.axes = 2;
  image.grid.size = {width, height, 1};
  image.components = components;
  image.type = SampleType::uint8;
  for (Index i = 0; i < width * height * components; ++i) image.values.push_back(static_cast<float>(i * 7 % 256));
  return image;
}

TEST(Bmp, PicturesAreReadBackTheSame) {
  const TemporaryFolder folder;
  for (const Index components : {1, 3})
    for (const Index width : {1, 2, 3, 4, 5}) {
      const Volume<float> image = ramp(width, 3, components);
      write_volume(folder.file("a.bmp"), image);
      const auto back = read_volume<float>(folder.file("a.bmp"));
      EXPECT_EQ(back.components, components);
      EXPECT_EQ(back.values, image.values) << width << " " << components;
    }
}

// Two rows of three pixels: a palette of black, red and white, four bits per pixel.
std::string palette_picture() {
  std::string bytes = "BM";
  append_scalar(bytes, std::uint32_t{74});
  append_scalar(bytes, std::uint32_t{0});
  append_scalar(bytes, std::uint32_t{66});
  append_scalar(bytes, std::uint32_t{40});
  append_scalar(bytes, std::int32_t{3});
  append_scalar(bytes, std::int32_t{2});
  append_scalar(bytes, std::uint16_t{1});
  append_scalar(bytes, std::uint16_t{4});
  for (const std::uint32_t field : {0U, 0U, 0U, 0U, 3U, 0U}) append_scalar(bytes, field);
  bytes += std::string("\0\0\0\0\0\0\xFF\0\xFF\xFF\xFF\0", 12);
  return bytes + std::string("\x01\x20\0\0\x22\x10\0\0", 8);
}

TEST(Bmp, PalettesAreExpandedAndRowsComeFromTheBottom) {
  const TemporaryFolder folder;
  const auto image = read_volume<float>(folder.with("a.bmp", palette_picture()));
  EXPECT_EQ(image.components, 3);
  EXPECT_EQ(image.values, (std::vector<float>{255, 255, 255, 255, 255, 255, 255, 0, 0,  //
                                              0, 0, 0, 255, 0, 0, 255, 255, 255}));
}

TEST(Bmp, DamagedPicturesAreRefusedInWords) {
  const TemporaryFolder folder;
  const auto failure = [&](const std::string& bytes) {
    return io_error([&] { (void)read_volume<float>(folder.with("a.bmp", bytes)); });
  };
  const std::string good = palette_picture();
  EXPECT_NE(failure("GIF89a").find("does not begin with BM"), std::string::npos);
  EXPECT_NE(failure(good.substr(0, 40)).find("truncated"), std::string::npos);
  EXPECT_NE(failure(good.substr(0, good.size() - 1)).find("no room for 3 x 2 pixels"), std::string::npos);
  std::string bits = good, compressed = good, color = good;
  bits[28] = 5;
  compressed[30] = 2;
  color[66] = static_cast<char>(0xF1);
  EXPECT_NE(failure(bits).find("BMP pictures of 5 bits"), std::string::npos);
  EXPECT_NE(failure(compressed).find("compressed"), std::string::npos);
  EXPECT_NE(failure(color).find("the palette does not have"), std::string::npos);
}

TEST(Jpeg, PicturesComeBackNearlyTheSame) {
  if (!reads_jpeg()) GTEST_SKIP() << "built without libjpeg";
  const TemporaryFolder folder;
  for (const Index components : {1, 3}) {
    Volume<float> image = ramp(40, 30, components);
    for (std::size_t i = 0; i < image.values.size(); ++i)
      image.values[i] = static_cast<float>(i / static_cast<std::size_t>(components) % 40 * 5);
    write_volume(folder.file("a.jpg"), image);
    const auto back = read_volume<float>(folder.file("a.jpg"));
    EXPECT_EQ(back.components, components);
    ASSERT_EQ(back.values.size(), image.values.size());
    float largest = 0;
    for (std::size_t i = 0; i < back.values.size(); ++i)
      largest = std::max(largest, std::abs(back.values[i] - image.values[i]));
    EXPECT_LE(largest, 12) << "of 255, at quality 95";
  }
}

TEST(Jpeg, DamagedPicturesAreRefusedInWords) {
  if (!reads_jpeg()) GTEST_SKIP() << "built without libjpeg";
  const TemporaryFolder folder;
  write_volume(folder.file("a.jpg"), ramp(40, 30, 3));
  const std::string good = content(folder.file("a.jpg"));
  const auto failure = [&](const std::string& bytes) {
    return io_error([&] { (void)read_volume<float>(folder.with("b.jpg", bytes)); });
  };
  EXPECT_NE(failure("PNG").find("not a JPEG picture"), std::string::npos);
  EXPECT_NE(failure(good.substr(0, 30)).find("cannot be read"), std::string::npos);
  EXPECT_NE(failure(good.substr(0, good.size() - 30)).find("damaged or end too early"), std::string::npos);
}

TEST(Pictures, WhatTheyCannotHoldIsRefused) {
  const TemporaryFolder folder;
  Volume<float> image = ramp(4, 4, 1);
  image.type = SampleType::float32;
  EXPECT_NE(io_error([&] { write_volume(folder.file("a.bmp"), image); }).find("hold whole numbers"), std::string::npos);
  image.type = SampleType::uint16;
  image.values[3] = 300;
  EXPECT_NE(io_error([&] { write_volume(folder.file("a.bmp"), image); }).find("from 0 to 255"), std::string::npos);
  EXPECT_TRUE(is_label_file("a.bmp"));
  EXPECT_FALSE(is_label_file("a.jpg")) << "labels would change";
}

}  // namespace
}  // namespace csrbf::picture_formats_test
