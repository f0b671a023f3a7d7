#include "csrbf/tiles/stages/number_parts.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/io/models/archive.hpp"

#include <limits>
#include <map>
#include <unordered_map>

namespace csrbf {
namespace {

constexpr double float_loss = 1e-6;  // of the diagonal: coordinates that float would move by more are double

// Counts what topology() counts, from the counts of the parts and what they share.
class TopologyCounter {
 public:
  // `id`: numbers for the shared vertices, the same for the same vertex.
  void add(const PartSeam& seam, const std::vector<std::int32_t>& id) {
    total_.triangles += seam.topology.triangles;
    total_.edges += seam.topology.edges;
    total_.boundary_edges += seam.topology.boundary_edges;
    total_.nonmanifold_edges += seam.topology.nonmanifold_edges;
    total_.inconsistent_edges += seam.topology.inconsistent_edges;
    total_.nonmanifold_vertices += seam.topology.nonmanifold_vertices;
    for (const auto& [a, b, times] : seam.open) {
      const auto low = static_cast<std::uint64_t>(std::min(id[a], id[b]));
      const auto high = static_cast<std::uint64_t>(std::max(id[a], id[b]));
      const std::int32_t balance = id[a] < id[b] ? times : -times;
      const auto [entry, added] = open_.emplace(low << 32 | high, balance);
      if (added) continue;
      --total_.edges;  // the same edge of two parts
      if (entry->second + balance != 0) ++total_.inconsistent_edges;
      open_.erase(entry);
    }
    for (const auto& [v, a, b] : seam.fans) fans_.push_back({id[v], a < 0 ? -1 : id[a], b < 0 ? -1 : id[b]});
  }

  [[nodiscard]] Topology finish(Index vertices, Index components) {
    total_.vertices = vertices;
    total_.components = components;
    total_.boundary_edges += std::ssize(open_);
    total_.nonmanifold_vertices += broken_fans();
    total_.euler = total_.vertices - total_.edges + total_.triangles;
    return total_;
  }

 private:
  // Number of shared vertices whose triangles do not form one fan.
  Index broken_fans() {
    std::sort(fans_.begin(), fans_.end());
    Index broken = 0;
    for (std::size_t begin = 0, end = 0; begin < fans_.size(); begin = end) {
      Index count = 0;
      std::map<std::int32_t, std::uint32_t> ids;
      while (end < fans_.size() && fans_[end][0] == fans_[begin][0]) {
        if (fans_[end][1] < 0)
          ++count;
        else
          for (const std::size_t k : {1, 2}) ids.emplace(fans_[end][k], static_cast<std::uint32_t>(ids.size()));
        ++end;
      }
      DisjointSets sets(ids.size());
      for (std::size_t i = begin; i < end; ++i)
        if (fans_[i][1] >= 0) sets.unite(ids[fans_[i][1]], ids[fans_[i][2]]);
      for (std::uint32_t i = 0; i < ids.size(); ++i) count += sets.find(i) == i ? 1 : 0;
      broken += count > 1 ? 1 : 0;
    }
    return broken;
  }

  Topology total_;
  std::unordered_map<std::uint64_t, std::int32_t> open_;  // ends, the smaller one first -> direction
  std::vector<std::array<std::int32_t, 3>> fans_;
};

}  // namespace

DroppedComponents find_dropped(const std::vector<std::string>& seams) {
  std::unordered_map<std::int64_t, std::uint32_t> seen;  // component at each key
  std::vector<DataSupport> supports;                     // of the components of all parts
  std::vector<std::uint32_t> first;                      // of these in each part
  std::vector<std::pair<std::uint32_t, std::uint32_t>> joins;
  for (const std::string& path : seams) {
    const PartSeam seam = read_seam(path);
    first.push_back(static_cast<std::uint32_t>(supports.size()));
    supports.insert(supports.end(), seam.supports.begin(), seam.supports.end());
    for (std::size_t i = 0; i < seam.shared.size(); ++i) {
      const std::uint32_t here = first.back() + static_cast<std::uint32_t>(seam.component[i]);
      const auto [entry, added] = seen.emplace(seam.shared[i].key, here);
      if (!added && entry->second != here) joins.emplace_back(entry->second, here);
    }
  }
  DisjointSets sets(supports.size());
  for (const auto& [a, b] : joins) sets.unite(a, b);
  std::map<std::uint32_t, DataSupport> whole;
  for (std::uint32_t c = 0; c < supports.size(); ++c) whole[sets.find(c)].add(supports[c]);
  std::vector<DataSupport> data;
  for (const auto& [set, support] : whole) data.push_back(support);
  const std::vector<char> keep = data.empty() ? std::vector<char>{} : components_with_data(data);
  std::map<std::uint32_t, char> kept;
  for (const auto& [set, support] : whole) kept.emplace(set, keep[kept.size()]);

  DroppedComponents result;
  result.dropped = std::count(keep.begin(), keep.end(), 0);
  result.kept = std::ssize(keep) - result.dropped;
  result.of_part.resize(seams.size());
  for (std::size_t part = 0; part < seams.size(); ++part) {
    const auto end = part + 1 < seams.size() ? first[part + 1] : static_cast<std::uint32_t>(supports.size());
    for (std::uint32_t c = first[part]; c < end; ++c)
      if (kept[sets.find(c)] == 0) result.of_part[part].insert(static_cast<std::int32_t>(c - first[part]));
  }
  return result;
}

void write_dropped(const std::string& path, const DroppedComponents& dropped) {
  std::vector<Index> part;
  std::vector<std::int32_t> component;
  for (std::size_t p = 0; p < dropped.of_part.size(); ++p)
    for (const std::int32_t c : dropped.of_part[p]) {
      part.push_back(static_cast<Index>(p));
      component.push_back(c);
    }
  Archive archive;
  archive.kind = "components without data";
  archive.set("kept", dropped.kept);
  archive.set("dropped", dropped.dropped);
  archive.set("part", part);
  archive.set("component", component);
  write_archive(path, archive);
}

DroppedComponents read_dropped(const std::string& path, Index parts) {
  const Archive archive = read_archive(path);
  DroppedComponents dropped{static_cast<Index>(archive.integer("kept")),
                            static_cast<Index>(archive.integer("dropped"))};
  dropped.of_part.resize(static_cast<std::size_t>(parts));
  const auto& part = archive.array<std::int64_t>("part", -1, 1);
  const auto& component = archive.array<std::int32_t>("component", part.rows(), 1);
  for (Index i = 0; i < part.rows(); ++i) dropped.of_part.at(part(i, 0)).insert(component(i, 0));
  return dropped;
}

WholeMesh number_parts(const std::vector<std::string>& seams, Index components, const TileFolder& folder) {
  std::unordered_map<std::int64_t, std::int32_t> ids;
  std::vector<std::int32_t> number;  // of each of them
  TopologyCounter counter;
  Box<3> bounds;
  double moved = 0;
  Index vertices = 0, triangles = 0, weak_features = 0;
  for (std::size_t part = 0; part < seams.size(); ++part) {
    const PartSeam seam = read_seam(seams[part]);
    PartNumbers numbers{vertices, triangles, {}};
    std::vector<std::int32_t> id;
    Index stale = 0;  // shared vertices that parts before have
    for (const polygonization::SharedVertex& s : seam.shared) {
      const auto [entry, added] = ids.emplace(s.key, static_cast<std::int32_t>(ids.size()));
      id.push_back(entry->second);
      if (added)
        number.push_back(static_cast<std::int32_t>(vertices + s.vertex - stale));
      else
        ++stale;
      numbers.shared.push_back(number[entry->second]);
    }
    vertices += seam.vertices - stale;
    triangles += seam.topology.triangles;
    if (vertices > std::numeric_limits<std::int32_t>::max())
      throw SolverFailure("reconstruct: more than 2^31 vertices; lower the resolution");
    counter.add(seam, id);
    if (seam.vertices > 0) bounds.add(seam.bounds);
    moved = std::max(moved, seam.moved);
    weak_features += seam.weak_features;
    Archive archive;
    archive.kind = "numbers of a part";
    archive.set("first", numbers.first);
    archive.set("first_triangle", numbers.first_triangle);
    archive.set("shared", numbers.shared);
    write_archive(folder.file("numbers", static_cast<Index>(part)), archive);
  }
  return {counter.finish(vertices, components), vertices > 0 && moved > float_loss * bounds.diagonal(), weak_features};
}

PartNumbers read_numbers(const TileFolder& folder, Index tile) {
  const Archive archive = read_archive(folder.file("numbers", tile));
  PartNumbers numbers{
      static_cast<Index>(archive.integer("first")), static_cast<Index>(archive.integer("first_triangle")), {}};
  const auto& shared = archive.array<std::int32_t>("shared", -1, 1);
  numbers.shared.assign(shared.data(), shared.data() + shared.size());
  return numbers;
}

void write_whole(const std::string& path, const WholeMesh& whole) {
  Archive archive;
  archive.kind = "mesh of all tiles";
  const Topology& t = whole.topology;
  archive.set("counts", std::vector<Index>{t.vertices, t.edges, t.triangles, t.components, t.boundary_edges,
                                           t.nonmanifold_edges, t.nonmanifold_vertices, t.inconsistent_edges, t.euler});
  archive.set("as_double", whole.as_double ? 1 : 0);
  archive.set("weak_features", whole.weak_features);
  write_archive(path, archive);
}

WholeMesh read_whole(const std::string& path) {
  const Archive archive = read_archive(path);
  const auto& counts = archive.array<std::int64_t>("counts", 9, 1);
  WholeMesh whole;
  Topology& t = whole.topology;
  int i = 0;
  for (Index* count : {&t.vertices, &t.edges, &t.triangles, &t.components, &t.boundary_edges, &t.nonmanifold_edges,
                       &t.nonmanifold_vertices, &t.inconsistent_edges, &t.euler})
    *count = counts(i++, 0);
  whole.as_double = archive.integer("as_double") != 0;
  whole.weak_features = archive.integer("weak_features");
  return whole;
}

}  // namespace csrbf
