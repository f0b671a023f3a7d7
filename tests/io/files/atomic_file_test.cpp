#include "csrbf/io/files/atomic_file.hpp"

#include "io/io_testing.hpp"

namespace csrbf::atomic_file_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

TEST(AtomicFile, AppearsUnderItsNameOnCommit) {
  const TemporaryFolder folder;
  AtomicFile file(folder.file("out.txt"));
  file.write("hello ");
  file.write("world");
  EXPECT_FALSE(std::filesystem::exists(folder.file("out.txt")));
  file.commit();
  EXPECT_EQ(content(folder.file("out.txt")), "hello world");
  EXPECT_EQ(folder.files(), 1);
}

TEST(AtomicFile, LeavesNothingAndKeepsTheOldContentWithoutCommit) {
  const TemporaryFolder folder;
  const std::string path = folder.with("out.txt", "old");
  {
    AtomicFile file(path);
    file.write("half of the new con");
  }
  EXPECT_EQ(content(path), "old");
  EXPECT_EQ(folder.files(), 1);
}

TEST(AtomicFile, ReplacesTheTargetOfASymbolicLink) {
  const TemporaryFolder folder;
  const std::string target = folder.with("target.txt", "old");
  std::filesystem::create_symlink(target, folder.file("link.txt"));
  write_file(folder.file("link.txt"), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link.txt")));
  EXPECT_EQ(content(target), "new");
}

TEST(AtomicFile, WritesDevicesDirectly) {
  write_file("/dev/null", "anything");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(AtomicFile, NamesTheFileAndTheReasonOfAFailure) {
  const TemporaryFolder folder;
  const std::string missing = folder.file("no/such/folder/out.txt");
  EXPECT_EQ(io_error([&] { write_file(missing, "x"); }),
            missing + ": cannot write the file: No such file or directory");
  EXPECT_EQ(io_error([&] { write_file(folder.folder(), "x"); }),
            folder.folder() + ": cannot write the file: Is a directory");
  EXPECT_EQ(io_error([&] { write_file("/dev/full", "x"); }),
            "/dev/full: cannot write the file: No space left on device");
}

}  // namespace
}  // namespace csrbf::atomic_file_test
