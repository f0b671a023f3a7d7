#include "csrbf/io/models/archive.hpp"

#include "csrbf/io/files/bytes.hpp"

#include "io/io_testing.hpp"

namespace csrbf::archive_test {
namespace {

using testing::io_error;
using testing::TemporaryFolder;

Archive example() {
  Archive archive;
  archive.kind = "example";
  archive.set("pi", 3.141592653589793);
  archive.set("count", 42);
  archive.set("name", "csrbf");
  archive.set("matrix", Eigen::MatrixXd(Eigen::MatrixXd::Random(3, 5)));
  archive.set("floats", Eigen::VectorXf(Eigen::VectorXf::Random(7)));
  archive.set("triangles", Eigen::MatrixXi(Eigen::MatrixXi::Constant(3, 2, -7)));
  archive.set("bytes", Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 1>::Constant(5, 200));
  archive.set("offsets", Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1>::Constant(2, std::int64_t{1} << 40));
  archive.set("empty", Eigen::MatrixXd(3, 0));
  return archive;
}

// CRC-32 (polynomial 0xEDB88320, reflected), bit by bit.
std::uint32_t crc32_of(const std::string& bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

// The same bytes with a checksum that fits: what a hostile writer would make.
std::string resealed(std::string bytes) {
  bytes.resize(bytes.size() - 4);
  append_scalar(bytes, crc32_of(bytes));
  return bytes;
}

TEST(Archive, ComesBackFromAFileAsItWas) {
  const TemporaryFolder folder;
  const Archive archive = example();
  write_archive(folder.file("a.csrbf"), archive);
  const Archive read = read_archive(folder.file("a.csrbf"));
  EXPECT_EQ(read.kind, "example");
  EXPECT_EQ(read.values(), archive.values());
  EXPECT_EQ(read.array<double>("matrix", 3), archive.array<double>("matrix", 3, 5));
  EXPECT_EQ(read.number("pi"), 3.141592653589793);
  EXPECT_EQ(read.integer("count", 0, 100), 42);
  EXPECT_EQ(read.text("name"), "csrbf");
}

TEST(Archive, HoldsOtherArchivesUnderAPrefix) {
  const Archive leaf = example();
  Archive tree;
  tree.kind = "union";
  tree.set("left", leaf);
  Archive deeper;
  deeper.kind = "complement";
  deeper.set("child", leaf);
  tree.set("right", deeper);
  const Archive read = parse_archive(format_archive(tree), "tree.csrbf");
  EXPECT_EQ(read.part("left").kind, "example");
  EXPECT_EQ(read.part("left").values(), leaf.values());
  EXPECT_EQ(read.part("right").kind, "complement");
  EXPECT_EQ(read.part("right").part("child").values(), leaf.values());
}

TEST(Archive, SaysWhichEntryDoesNotFit) {
  const Archive archive = parse_archive(format_archive(example()), "m.csrbf");
  EXPECT_EQ(io_error([&] { (void)archive.number("tau"); }), "m.csrbf: the model has no entry \"tau\"");
  EXPECT_EQ(io_error([&] { (void)archive.number("name"); }), "m.csrbf: entry \"name\" is not a number");
  EXPECT_EQ(io_error([&] { (void)archive.array<float>("matrix"); }),
            "m.csrbf: entry \"matrix\" is not an array of the expected type");
  EXPECT_EQ(io_error([&] { (void)archive.array<double>("matrix", 2); }),
            "m.csrbf: entry \"matrix\" has 3 x 5 values, expected 2 x any");
  EXPECT_EQ(io_error([&] { (void)archive.integer("count", 1, 6); }), "m.csrbf: entry \"count\" = 42 is not in [1, 6]");
  EXPECT_EQ(io_error([&] { (void)archive.part("left"); }), "m.csrbf: the model has no entry \"left/kind\"");
}

TEST(Archive, RefusesFilesOfANewerFormat) {
  std::string bytes = format_archive(example());
  bytes[8] = 7;
  EXPECT_EQ(io_error([&] { parse_archive(resealed(bytes), "model.csrbf"); }),
            "model.csrbf: written by a newer csrbf (format 7, this program reads up to 1)");
}

TEST(Archive, RefusesEveryTruncatedFile) {
  const std::string bytes = format_archive(example());
  EXPECT_EQ(io_error([&] { parse_archive("", "m.csrbf"); }), "m.csrbf: the file is empty");
  EXPECT_EQ(io_error([&] { parse_archive("ply", "m.csrbf"); }), "m.csrbf: not a csrbf model");
  EXPECT_EQ(io_error([&] { parse_archive(std::string_view(bytes).substr(0, 100), "m.csrbf"); }),
            "m.csrbf: the file is truncated: 100 of " + std::to_string(bytes.size()) + " bytes");
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(parse_archive(std::string_view(bytes).substr(0, size), "m.csrbf"), IoError) << size;
  EXPECT_THROW(parse_archive(bytes + "x", "m.csrbf"), IoError);
}

TEST(Archive, NoticesEveryFlippedBit) {
  const std::string bytes = format_archive(example());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 4);
    EXPECT_THROW(parse_archive(damaged, "m.csrbf"), IoError) << i;
  }
}

// With a checksum that fits, any content must give an archive or an IoError, and no allocation beyond the file's size.
TEST(Archive, SurvivesHostileFilesWithAValidChecksum) {
  const std::string bytes = format_archive(example());
  int refused = 0;
  for (std::size_t i = 20; i + 4 < bytes.size(); ++i) {
    for (const char value : {'\x7f', '\xff', '\x00'}) {
      std::string hostile = bytes;
      hostile[i] = value;
      try {
        parse_archive(resealed(hostile), "m.csrbf");
      } catch (const IoError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace csrbf::archive_test
