// Gives files to one reader of the library, which may refuse them (IoError, InvalidInput) and nothing else. The
// variable CSRBF_READER says which: READER.EXTENSION, as in points.ply, with one of the readers below.

#include "csrbf/core/error.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/io/polylines.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/io/volume.hpp"

#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <map>

namespace csrbf {
namespace {

// A model must not only be read but give values, wherever its entries point to.
void read_and_evaluate_model(const std::string& path) {
  const std::shared_ptr<const Field<3>> field = read_model(path);
  (void)field->evaluate(field->bounds().center(), Derivatives::hessian);
}

void read_and_evaluate_function(const std::string& path) {
  const Function function = read_function(path).function;
  (void)function.evaluate(function.bounds().rowwise().mean(), Derivatives::hessian);
}

void read_all_polylines(const std::string& path) {
  try {
    (void)read_points_or_polylines(path);
  } catch (const IoError&) {
  }
  (void)read_polylines(path);
}

void read_all_samples(const std::string& path) {
  (void)read_queries(path, {"x", "y"});
  (void)read_samples(path);
}

using Reader = void (*)(const std::string& path);

const std::map<std::string, Reader, std::less<>> readers{
    {"function", read_and_evaluate_function},
    {"mesh", [](const std::string& path) { (void)read_mesh(path); }},
    {"model", read_and_evaluate_model},
    {"points", [](const std::string& path) { (void)read_points(path); }},
    {"polylines", read_all_polylines},
    {"samples", read_all_samples},
    {"volume", [](const std::string& path) { (void)read_volume<float>(path); }},
};

// The reader that was asked for, and the file that it reads: in memory, with a link that has the extension.
class Target {
 public:
  Target() {
    const char* variable = std::getenv("CSRBF_READER");
    const std::string name = variable != nullptr ? variable : "";
    const std::size_t dot = std::min(name.find('.'), name.size());
    const auto found = readers.find(name.substr(0, dot));
    if (found == readers.end() || dot == name.size()) {
      std::cerr << "CSRBF_READER = \"" << name << "\": must be READER.EXTENSION, as in points.ply; the readers are";
      for (const auto& [known, reader] : readers) std::cerr << ' ' << known;
      std::cerr << '\n';
      std::_Exit(2);
    }
    reader_ = found->second;
    folder_ = std::filesystem::temp_directory_path() / ("csrbf_fuzz_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    path_ = (folder_ / ("input" + name.substr(dot))).string();
    file_ = memfd_create("input", 0);
    std::filesystem::create_symlink("/proc/self/fd/" + std::to_string(file_), path_);
    is_model_ = name.ends_with(".csrbf");
  }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  ~Target() {
    close(file_);
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }

  void run(std::string bytes) const {
    if (is_model_) repair(bytes);
    if (ftruncate(file_, 0) != 0 || pwrite(file_, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
      std::abort();
    try {
      reader_(path_);
    } catch (const IoError&) {
    } catch (const InvalidInput&) {
    }
  }

 private:
  // Random bytes never have the size and checksum that a model says, behind which its entries are.
  static void repair(std::string& bytes) {
    constexpr std::size_t size_offset = 12, checksum_size = 4;
    if (bytes.size() < size_offset + sizeof(std::uint64_t) + checksum_size) return;
    const std::uint64_t size = bytes.size();
    std::memcpy(bytes.data() + size_offset, &size, sizeof(size));
    const std::size_t checked = bytes.size() - checksum_size;
    const auto checksum = static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), checked));
    std::memcpy(bytes.data() + checked, &checksum, checksum_size);
  }

  Reader reader_;
  std::filesystem::path folder_;
  std::string path_;
  int file_;
  bool is_model_;
};

}  // namespace
}  // namespace csrbf

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const csrbf::Target target;
  target.run(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
