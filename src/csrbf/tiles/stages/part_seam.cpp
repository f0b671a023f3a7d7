#include "csrbf/tiles/stages/part_seam.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/io/models/archive.hpp"

#include <map>
#include <unordered_map>

namespace csrbf {
namespace {

using Triple = std::array<std::int32_t, 3>;

// A side of a triangle opposite to a shared vertex.
struct Link {
  std::int32_t vertex, from, to;
};

// The fans around each shared vertex. `place`: position in `shared` of each vertex, -1 for others. Returns how many
// vertices have more than one.
Index find_fans(std::vector<Link> links, const std::vector<std::int32_t>& place, std::vector<Triple>& fans) {
  std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.vertex < b.vertex; });
  Index broken = 0;
  for (std::size_t begin = 0, end = 0; begin < links.size(); begin = end) {
    std::map<std::int32_t, std::uint32_t> ids;
    while (end < links.size() && links[end].vertex == links[begin].vertex) {
      for (const std::int32_t v : {links[end].from, links[end].to})
        ids.emplace(v, static_cast<std::uint32_t>(ids.size()));
      ++end;
    }
    DisjointSets sets(ids.size());
    for (std::size_t i = begin; i < end; ++i) sets.unite(ids[links[i].from], ids[links[i].to]);
    const std::int32_t vertex = links[begin].vertex;
    std::map<std::uint32_t, std::int32_t> last;  // neighbour of each fan that was added last
    for (const auto& [v, id] : ids) last.emplace(sets.find(id), -1);
    const std::size_t count = last.size();
    std::map<std::uint32_t, bool> chained;
    for (const auto& [v, id] : ids) {
      const std::int32_t neighbour = place[v];
      if (neighbour < 0) continue;
      std::int32_t& before = last[sets.find(id)];
      if (before >= 0) {
        fans.push_back({vertex, before, neighbour});
        chained[sets.find(id)] = true;
      }
      before = neighbour;
    }
    for (const auto& [fan, neighbour] : last)
      if (!chained[fan]) fans.push_back({vertex, neighbour, neighbour});
    broken += count > 1 ? 1 : 0;
  }
  return broken;
}

void set_triples(Archive& archive, const std::string& name, const std::vector<Triple>& triples) {
  Eigen::Matrix<std::int32_t, 3, Eigen::Dynamic> table(3, std::ssize(triples));
  for (Index i = 0; i < table.cols(); ++i) table.col(i) << triples[i][0], triples[i][1], triples[i][2];
  archive.set(name, table);
}

std::vector<Triple> triples_of(const Archive& archive, const std::string& name) {
  const auto& table = archive.array<std::int32_t>(name, 3);
  std::vector<Triple> triples;
  for (Index i = 0; i < table.cols(); ++i) triples.push_back({table(0, i), table(1, i), table(2, i)});
  return triples;
}

void set_shared(Archive& archive, const std::vector<polygonization::SharedVertex>& shared) {
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, 1> vertex(std::ssize(shared));
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1> key(vertex.size());
  for (Index i = 0; i < vertex.size(); ++i) {
    vertex[i] = shared[i].vertex;
    key[i] = shared[i].key;
  }
  archive.set("shared", vertex);
  archive.set("keys", key);
}

std::vector<polygonization::SharedVertex> shared_of(const Archive& archive) {
  std::vector<polygonization::SharedVertex> shared;
  const auto& vertex = archive.array<std::int32_t>("shared", -1, 1);
  const auto& key = archive.array<std::int64_t>("keys", vertex.rows(), 1);
  for (Index i = 0; i < vertex.rows(); ++i) shared.push_back({vertex(i, 0), key(i, 0)});
  return shared;
}

}  // namespace

PartSeam make_seam(const TilePart& part, const std::vector<Index>& component) {
  const Mesh& mesh = part.mesh;
  PartSeam seam;
  seam.vertices = mesh.vertices.cols();
  seam.topology = topology(mesh);
  seam.shared = part.shared;
  seam.weak_features = part.weak_features;
  for (const polygonization::SharedVertex& s : part.shared)
    seam.component.push_back(static_cast<std::int32_t>(component[s.vertex]));

  std::vector<std::int32_t> place(mesh.vertices.cols(), -1);
  for (std::size_t i = 0; i < part.shared.size(); ++i) place[part.shared[i].vertex] = static_cast<std::int32_t>(i);
  std::vector<Link> links;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> open;  // ends, the smaller one first -> direction
  for (Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int c = 0; c < 3; ++c) {
      const std::int32_t v = mesh.triangles(c, t), next = mesh.triangles((c + 1) % 3, t);
      if (place[v] < 0) continue;
      links.push_back({place[v], next, mesh.triangles((c + 2) % 3, t)});
      if (place[next] < 0) continue;
      const auto [entry, added] = open.emplace(std::minmax(place[v], place[next]), 0);
      entry->second += place[v] < place[next] ? 1 : -1;
      if (entry->second == 0) open.erase(entry);
    }
  for (const auto& [ends, balance] : open) seam.open.push_back({ends.first, ends.second, balance});
  seam.topology.boundary_edges -= std::ssize(open);
  seam.topology.nonmanifold_vertices -= find_fans(std::move(links), place, seam.fans);

  if (seam.vertices == 0) return seam;
  seam.bounds = bounding_box<3>(mesh.vertices);
  seam.moved = (mesh.vertices - mesh.vertices.cast<float>().cast<double>()).cwiseAbs().maxCoeff();
  return seam;
}

void write_seam(const std::string& path, const PartSeam& seam) {
  Archive archive;
  archive.kind = "seam of a mesh";
  archive.set("vertices", seam.vertices);
  const Topology& t = seam.topology;
  archive.set("counts", std::vector<Index>{t.edges, t.triangles, t.boundary_edges, t.nonmanifold_edges,
                                           t.nonmanifold_vertices, t.inconsistent_edges});
  set_shared(archive, seam.shared);
  archive.set("component", seam.component);
  Eigen::Matrix<double, 3, Eigen::Dynamic> data(3, std::ssize(seam.supports));
  for (Index c = 0; c < data.cols(); ++c)
    data.col(c) << seam.supports[c].area, seam.supports[c].samples, seam.supports[c].sample_area;
  archive.set("supports", data);
  set_triples(archive, "open", seam.open);
  set_triples(archive, "fans", seam.fans);
  set_box(archive, seam.bounds);
  archive.set("moved", seam.moved);
  archive.set("weak_features", seam.weak_features);
  write_archive(path, archive);
}

PartSeam read_seam(const std::string& path) {
  const Archive archive = read_archive(path);
  PartSeam seam;
  seam.vertices = archive.integer("vertices");
  const auto& counts = archive.array<std::int64_t>("counts", 6, 1);
  Topology& t = seam.topology;
  int i = 0;
  for (Index* count : {&t.edges, &t.triangles, &t.boundary_edges, &t.nonmanifold_edges, &t.nonmanifold_vertices,
                       &t.inconsistent_edges})
    *count = counts(i++, 0);
  seam.shared = shared_of(archive);
  const auto& component = archive.array<std::int32_t>("component", std::ssize(seam.shared), 1);
  seam.component.assign(component.data(), component.data() + component.size());
  const auto& data = archive.numbers("supports", 3);
  for (Index c = 0; c < data.cols(); ++c) seam.supports.push_back({data(0, c), data(1, c), data(2, c)});
  seam.open = triples_of(archive, "open");
  seam.fans = triples_of(archive, "fans");
  seam.bounds = box_of<3>(archive);
  seam.moved = archive.number("moved");
  seam.weak_features = archive.integer("weak_features");
  return seam;
}

void write_part(const std::string& path, const TilePart& part) {
  Archive archive;
  archive.kind = "part of a mesh";
  archive.set("vertices", part.mesh.vertices);
  archive.set("normals", part.mesh.normals.cast<float>());
  archive.set("triangles", part.mesh.triangles);
  set_shared(archive, part.shared);
  archive.set("weak_features", part.weak_features);
  write_archive(path, archive);
}

TilePart read_part(const std::string& path) {
  const Archive archive = read_archive(path);
  TilePart part;
  part.mesh.vertices = archive.numbers("vertices", 3);
  part.mesh.normals = archive.array<float>("normals", 3).cast<double>();
  part.mesh.triangles = archive.array<std::int32_t>("triangles", 3);
  part.shared = shared_of(archive);
  part.weak_features = archive.integer("weak_features");
  return part;
}

}  // namespace csrbf
