#include "csrbf/tiles/stages/weld_parts.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/file_part.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/tiles/stages/number_parts.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <set>

namespace csrbf {
namespace {

constexpr std::size_t written_at_once = std::size_t{4} << 20;  // bytes
constexpr std::size_t triangle_size = 13;                      // bytes in a .ply file

bool is_folder(const std::string& output) {
  return output.ends_with('/');
}

// Leaves the components that have data.
TilePart kept_part(TilePart part, const std::vector<Index>& component, const std::set<std::int32_t>& dropped) {
  std::vector<Index> triangles;
  for (Index t = 0; t < part.mesh.triangles.cols(); ++t)
    if (dropped.count(static_cast<std::int32_t>(component[part.mesh.triangles(0, t)])) == 0) triangles.push_back(t);
  part.mesh.triangles = Triangles(part.mesh.triangles(Eigen::all, triangles));
  polygonization::drop_unused_vertices(part.mesh, part.shared);
  return part;
}

std::string ply_header(Index vertices, Index triangles, bool as_double) {
  const std::string type = as_double ? "double" : "float";
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(vertices) + "\n";
  for (const char axis : {'x', 'y', 'z'}) header += "property " + type + " " + axis + "\n";
  return header + "property float nx\nproperty float ny\nproperty float nz\nelement face " + std::to_string(triangles) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string ply_header(const WholeMesh& whole) {
  return ply_header(whole.topology.vertices, whole.topology.triangles, whole.as_double);
}

// A part whose vertices are numbered in the whole mesh.
struct NumberedPart {
  Mesh mesh;
  PartNumbers numbers;
  std::vector<std::int32_t> number;  // of each vertex

  // Whether the vertex is not in a part before.
  [[nodiscard]] bool is_fresh(Index v) const { return number[v] >= numbers.first; }
};

NumberedPart numbered(TilePart part, PartNumbers numbers) {
  NumberedPart result{std::move(part.mesh), std::move(numbers), {}};
  result.number.assign(result.mesh.vertices.cols(), -1);
  for (std::size_t i = 0; i < part.shared.size(); ++i) result.number[part.shared[i].vertex] = result.numbers.shared[i];
  auto next = static_cast<std::int32_t>(result.numbers.first);
  for (std::int32_t& number : result.number) {
    if (number < 0 || number >= result.numbers.first) number = next++;
  }
  return result;
}

// What one process does.
class Welder {
 public:
  Welder(const TileTeam& team, const std::vector<int>& rounds, const std::string& output)
      : team_(team), folder_(team.folder()), rounds_(rounds), output_(output) {}

  WeldedMesh run() {
    report(team_.progress(), "write", 0);
    leave_out();
    number();
    if (is_folder(output_))
      write_tiles();
    else if (file_extension(output_) == ".ply")
      write_ply();
    else if (team_.leads())
      write_at_once();
    report(team_.progress(), "write", 1);
    return {whole_.topology, dropped_.dropped, whole_.weak_features};
  }

 private:
  [[nodiscard]] Index tiles() const { return std::ssize(rounds_); }
  [[nodiscard]] bool is_changed(Index t) const { return !dropped_.of_part.empty() && !dropped_.of_part[t].empty(); }
  [[nodiscard]] std::string part(Index t) const {
    return folder_.file(is_changed(t) ? "kept_part" : part_kind(rounds_[t]), t);
  }
  [[nodiscard]] std::string seam(Index t) const {
    return folder_.file(is_changed(t) ? "kept_seam" : seam_kind(rounds_[t]), t);
  }
  [[nodiscard]] std::vector<std::string> seams() const {
    std::vector<std::string> paths;
    for (Index t = 0; t < tiles(); ++t) paths.push_back(seam(t));
    return paths;
  }

  // Components without data.
  void leave_out() {
    const std::string file = folder_.file("dropped");
    if (team_.leads() && !exists(file)) write_dropped(file, find_dropped(seams()));
    team_.wait(file);
    DroppedComponents dropped = read_dropped(file, tiles());
    team_.for_own("kept_seam", tiles(), [&](Index t) {
      if (dropped.of_part[t].empty()) return;
      TilePart all = read_part(part(t));
      Index count = 0;
      const std::vector<Index> component = component_labels(all.mesh, count);
      const TilePart kept = kept_part(std::move(all), component, dropped.of_part[t]);
      write_part(folder_.file("kept_part", t), kept);
      write_seam(folder_.file("kept_seam", t), make_seam(kept, component_labels(kept.mesh, count)));
    });
    dropped_ = std::move(dropped);
  }

  void number() {
    const std::string file = folder_.file("whole");
    if (team_.leads() && !exists(file)) {
      for (Index t = 0; t < tiles(); ++t) team_.wait(seam(t));
      const WholeMesh whole = number_parts(seams(), dropped_.kept, folder_);
      if (whole.topology.triangles == 0)
        throw SolverFailure("reconstruct: the surface has no triangles; check the points");
      write_file(folder_.file("mesh"), ply_header(whole));
      write_whole(file, whole);
    }
    team_.wait(file);
    whole_ = read_whole(file);
    report(team_.progress(), "write", 0.3);
  }

  [[nodiscard]] NumberedPart read(Index t) const { return numbered(read_part(part(t)), read_numbers(folder_, t)); }

  void write_ply() {
    const std::string file = folder_.file("mesh");
    team_.for_own("written", tiles(), [&](Index t) {
      const NumberedPart part = read(t);
      write_vertices(part, file);
      write_triangles(part, file);
      write_file(folder_.file("written", t), "");
    });
    if (!team_.leads()) return;
    team_.wait_for_all("written", tiles());
    AtomicFile mesh(output_);
    mesh.take(file);
    mesh.commit();
  }

  // What tiles share is in the file of each, with the same bits.
  void write_tiles() {
    team_.for_own("mesh_tile", tiles(), [&](Index t) {
      const Mesh mesh = read_part(part(t)).mesh;
      std::string bytes;
      if (mesh.triangles.cols() > 0) {
        bytes = ply_header(mesh.vertices.cols(), mesh.triangles.cols(), whole_.as_double);
        for (Index v = 0; v < mesh.vertices.cols(); ++v) append_vertex(bytes, mesh, v);
        for (const auto& triangle : mesh.triangles.colwise()) {
          bytes += '\3';
          for (const std::int32_t v : triangle) append_scalar(bytes, v);
        }
      }
      write_file(folder_.file("mesh_tile", t), bytes);
    });
    if (!team_.leads()) return;
    team_.wait_for_all("mesh_tile", tiles());
    namespace fs = std::filesystem;
    std::error_code error;
    fs::create_directories(utf8_path(output_), error);
    std::set<std::string> written;
    for (Index t = 0; t < tiles(); ++t) {
      const std::string file = folder_.file("mesh_tile", t);
      if (fs::file_size(utf8_path(file)) == 0) continue;
      std::array<char, 32> name{};
      std::snprintf(name.data(), name.size(), "tile_%04lld.ply", static_cast<long long>(t));
      AtomicFile mesh(output_ + name.data());
      mesh.take(file);
      mesh.commit();
      written.insert(name.data());
    }
    remove_others(written);
  }

  // What earlier meshes of more tiles left in the folder, which would not fit.
  void remove_others(const std::set<std::string>& written) const {
    static const std::regex pattern("tile_[0-9]{4,}\\.ply");
    std::vector<std::filesystem::path> others;
    for (const auto& entry : std::filesystem::directory_iterator(utf8_path(output_))) {
      const std::string name = utf8_name(entry.path().filename());
      if (entry.is_regular_file() && std::regex_match(name, pattern) && !written.contains(name))
        others.push_back(entry.path());
    }
    for (const std::filesystem::path& other : others) {
      std::error_code error;
      if (!std::filesystem::remove(other, error))
        throw IoError(utf8_name(other) + ": from an earlier run, cannot be removed: " + error.message());
    }
  }

  void append_vertex(std::string& bytes, const Mesh& mesh, Index v) const {
    for (const double x : mesh.vertices.col(v)) {
      if (whole_.as_double)
        append_scalar(bytes, x);
      else
        append_scalar(bytes, static_cast<float>(x));
    }
    for (const double x : mesh.normals.col(v)) append_scalar(bytes, static_cast<float>(x));
  }

  [[nodiscard]] std::size_t vertex_size() const {
    return 3 * (whole_.as_double ? sizeof(double) : sizeof(float)) + 3 * sizeof(float);
  }
  [[nodiscard]] std::int64_t vertices_begin() const { return std::ssize(ply_header(whole_)); }

  void write_vertices(const NumberedPart& part, const std::string& path) const {
    FilePart file(path, vertices_begin() + static_cast<std::int64_t>(vertex_size()) * part.numbers.first);
    std::string bytes;
    for (Index v = 0; v < part.mesh.vertices.cols(); ++v) {
      if (!part.is_fresh(v)) continue;
      append_vertex(bytes, part.mesh, v);
      flush(file, bytes, written_at_once);
    }
    flush(file, bytes, 0);
    file.close();
  }

  void write_triangles(const NumberedPart& part, const std::string& path) const {
    FilePart file(path, vertices_begin() + static_cast<std::int64_t>(vertex_size()) * whole_.topology.vertices +
                            static_cast<std::int64_t>(triangle_size) * part.numbers.first_triangle);
    std::string bytes;
    for (Index t = 0; t < part.mesh.triangles.cols(); ++t) {
      bytes += '\3';
      for (const std::int32_t v : part.mesh.triangles.col(t)) append_scalar(bytes, part.number[v]);
      flush(file, bytes, written_at_once);
    }
    flush(file, bytes, 0);
    file.close();
  }

  static void flush(FilePart& file, std::string& bytes, std::size_t most) {
    if (bytes.size() <= most) return;
    file.write(bytes);
    bytes.clear();
  }

  void write_at_once() const {
    Mesh mesh;
    mesh.vertices.resize(3, whole_.topology.vertices);
    mesh.normals.resize(3, whole_.topology.vertices);
    mesh.triangles.resize(3, whole_.topology.triangles);
    for (Index t = 0; t < tiles(); ++t) {
      const NumberedPart part = read(t);
      for (Index v = 0; v < part.mesh.vertices.cols(); ++v) {
        mesh.vertices.col(part.number[v]) = part.mesh.vertices.col(v);
        mesh.normals.col(part.number[v]) = part.mesh.normals.col(v);
      }
      for (Index k = 0; k < part.mesh.triangles.cols(); ++k)
        for (int c = 0; c < 3; ++c)
          mesh.triangles(c, part.numbers.first_triangle + k) = part.number[part.mesh.triangles(c, k)];
    }
    write_mesh(output_, mesh);
  }

  const TileTeam& team_;
  const TileFolder& folder_;
  const std::vector<int>& rounds_;
  const std::string& output_;
  DroppedComponents dropped_;
  WholeMesh whole_;
};

}  // namespace

WeldedMesh weld_parts(const TileTeam& team, const std::vector<int>& rounds, const std::string& output) {
  return Welder(team, rounds, output).run();
}

}  // namespace csrbf
