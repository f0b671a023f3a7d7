#include "csrbf/tiles/folder/tile_folder.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/models/archive.hpp"

#include <chrono>
#include <filesystem>
#include <thread>

namespace csrbf {
namespace {

constexpr const char* suffix = ".tiles";  // of every file in the folder; incomplete ones have more behind it
constexpr const char* work_kind = "tile work";

void set_box(Archive& archive, const std::string& name, const Box<3>& box) {
  Eigen::Matrix<double, 3, 2> corners;
  corners << box.lo, box.hi;
  archive.set(name, corners);
}

Box<3> box_from(const Archive& archive, const std::string& name) {
  const auto& corners = archive.numbers(name, 3, 2);
  return {corners.col(0), corners.col(1)};
}

}  // namespace

bool exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(utf8_path(path), ignored);
}

TileFolder::TileFolder(std::string path) : path_(std::move(path)) {
  std::error_code error;
  std::filesystem::create_directories(utf8_path(path_), error);
  if (error) throw IoError(path_ + ": cannot be made: " + error.message());
}

std::string TileFolder::file(const std::string& kind) const {
  return utf8_name(utf8_path(path_) / utf8_path(kind + suffix));
}

std::string TileFolder::file(const std::string& kind, Index tile) const {
  return file(kind + "_" + std::to_string(tile));
}

void TileFolder::write_work(const TileWork& work) const {
  Archive archive;
  archive.kind = work_kind;
  archive.set("fingerprint", work.fingerprint);
  archive.set("points", work.points);
  archive.set("non_finite", work.non_finite);
  archive.set("normals", work.normals ? 1 : 0);
  set_box(archive, "bounds", work.bounds);
  archive.set("spacing", work.spacing);
  archive.set("halo", work.halo);
  archive.set("blend", work.plan.blend());
  archive.set("grid_origin", work.grid.origin);
  archive.set("grid_cube", work.grid.cube);
  archive.set("grid_bits", work.grid.spacing_bits);
  const std::vector<TileCut>& cuts = work.plan.cuts();
  Eigen::Matrix<std::int32_t, 3, Eigen::Dynamic> sides(3, std::ssize(cuts));
  Eigen::VectorXd at(std::ssize(cuts));
  for (Index i = 0; i < at.size(); ++i) {
    sides.col(i) << cuts[i].axis, cuts[i].below, cuts[i].above;
    at[i] = cuts[i].at;
  }
  archive.set("cuts", sides);
  archive.set("cut_at", at);
  write_archive(file("work"), archive);
}

TileWork TileFolder::read_work() const {
  const Archive archive = read_archive(file("work"));
  if (archive.kind != work_kind) archive.fail("this is no work in tiles");
  TileWork work;
  work.fingerprint = archive.text("fingerprint");
  work.points = archive.integer("points");
  work.non_finite = archive.integer("non_finite");
  work.normals = archive.integer("normals") != 0;
  work.bounds = box_from(archive, "bounds");
  work.spacing = archive.number("spacing");
  work.halo = archive.number("halo");
  work.grid.origin = archive.numbers("grid_origin", 3, 1);
  work.grid.cube = archive.number("grid_cube");
  work.grid.spacing_bits = static_cast<int>(archive.integer("grid_bits", 0, ThinningGrid<3>::bits));
  const auto& sides = archive.array<std::int32_t>("cuts", 3);
  const auto& at = archive.numbers("cut_at", sides.cols(), 1);
  std::vector<TileCut> cuts;
  for (Index i = 0; i < sides.cols(); ++i) cuts.push_back({sides(0, i), sides(1, i), sides(2, i), at(i, 0)});
  work.plan = TilePlan<3>(std::move(cuts), archive.number("blend"));
  return work;
}

void TileFolder::remove() const {
  std::error_code ignored;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(utf8_path(path_), ignored))
    if (utf8_name(entry.path().filename()).find(suffix) != std::string::npos) files.push_back(entry.path());
  for (const std::filesystem::path& path : files) std::filesystem::remove(path, ignored);
  std::filesystem::remove(utf8_path(path_), ignored);  // fails where other files are left
}

void wait_for(const std::string& path, const std::string& failure, const std::function<void()>& alive) {
  auto pause = std::chrono::milliseconds(5);
  constexpr auto longest = std::chrono::milliseconds(500);
  while (!exists(path)) {
    if (exists(failure)) throw SolverFailure(read_file(failure));
    alive();
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, longest);
  }
}

}  // namespace csrbf
