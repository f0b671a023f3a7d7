#include "csrbf/tiles/stages/weld_parts.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/bytes.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/mesh.hpp"

#include <map>
#include <unordered_map>

namespace csrbf {
namespace {

constexpr double float_loss = 1e-6;  // of the diagonal: coordinates that float would move by more are double
constexpr std::size_t written_at_once = std::size_t{4} << 20;  // bytes

// The numbers of vertices in the whole mesh, part by part in order.
class VertexNumbers {
 public:
  // Of the vertices of the next part; new ones follow those before. `fresh`: which are new.
  std::vector<std::int32_t> next(const TilePart& part, std::vector<char>& fresh) {
    const Index n = part.mesh.vertices.cols();
    std::vector<std::int32_t> number(n, -1);
    fresh.assign(n, 1);
    for (const polygonization::SharedVertex& s : part.shared) {
      const auto found = shared_.find(s.key);
      if (found == shared_.end()) continue;
      number[s.vertex] = found->second;
      fresh[s.vertex] = 0;
    }
    for (Index v = 0; v < n; ++v) {
      if (number[v] >= 0) continue;
      if (count_ == std::numeric_limits<std::int32_t>::max())
        throw SolverFailure("reconstruct: more than 2^31 vertices; lower the resolution");
      number[v] = static_cast<std::int32_t>(count_++);
    }
    for (const polygonization::SharedVertex& s : part.shared) shared_.emplace(s.key, number[s.vertex]);
    return number;
  }

  [[nodiscard]] Index count() const { return count_; }

 private:
  std::unordered_map<std::int64_t, std::int32_t> shared_;
  Index count_ = 0;
};

// A side of a triangle opposite to one of its vertices.
struct Link {
  std::int32_t vertex, from, to;
};

// Number of vertices whose triangles do not form one fan.
Index broken_fans(std::vector<Link> links) {
  std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.vertex < b.vertex; });
  Index broken = 0;
  for (std::size_t begin = 0, end = 0; begin < links.size(); begin = end) {
    std::map<std::int32_t, std::uint32_t> ids;
    while (end < links.size() && links[end].vertex == links[begin].vertex) {
      for (const std::int32_t v : {links[end].from, links[end].to})
        ids.emplace(v, static_cast<std::uint32_t>(ids.size()));
      ++end;
    }
    DisjointSets fans(ids.size());
    for (std::size_t i = begin; i < end; ++i) fans.unite(ids[links[i].from], ids[links[i].to]);
    Index count = 0;
    for (std::uint32_t i = 0; i < ids.size(); ++i) count += fans.find(i) == i ? 1 : 0;
    broken += count > 1 ? 1 : 0;
  }
  return broken;
}

// Counts what topology() counts, part by part: within a part by topology(), along the vertices that parts share here.
class TopologyCounter {
 public:
  void add(const TilePart& part, const std::vector<std::int32_t>& number) {
    const Topology inside = topology(part.mesh);
    std::vector<char> shared(part.mesh.vertices.cols());
    for (const polygonization::SharedVertex& s : part.shared) shared[s.vertex] = 1;
    std::vector<Link> local;
    std::unordered_map<std::uint64_t, int> open;
    for (Index t = 0; t < part.mesh.triangles.cols(); ++t)
      for (int c = 0; c < 3; ++c) {
        const std::int32_t v = part.mesh.triangles(c, t), next = part.mesh.triangles((c + 1) % 3, t),
                           last = part.mesh.triangles((c + 2) % 3, t);
        if (shared[v] == 0) continue;
        local.push_back({v, next, last});
        links_.push_back({number[v], number[next], number[last]});
        if (shared[next] != 0) toggle(number[v], number[next], open);
      }
    total_.triangles += inside.triangles;
    total_.edges += inside.edges;
    total_.boundary_edges += inside.boundary_edges - std::ssize(open);
    total_.nonmanifold_edges += inside.nonmanifold_edges;
    total_.inconsistent_edges += inside.inconsistent_edges;
    total_.nonmanifold_vertices += inside.nonmanifold_vertices - broken_fans(std::move(local));
    for (const auto& [edge, balance] : open) {
      const auto [entry, added] = open_.emplace(edge, balance);
      if (added) continue;
      --total_.edges;  // the same edge of two parts
      if (entry->second + balance != 0) ++total_.inconsistent_edges;
      open_.erase(entry);
    }
  }

  [[nodiscard]] Topology finish(Index vertices, Index components) {
    total_.vertices = vertices;
    total_.components = components;
    total_.boundary_edges += std::ssize(open_);
    total_.nonmanifold_vertices += broken_fans(std::move(links_));
    total_.euler = total_.vertices - total_.edges + total_.triangles;
    return total_;
  }

 private:
  using Edges = std::unordered_map<std::uint64_t, int>;  // ends, the smaller one first -> direction

  static void toggle(std::int32_t a, std::int32_t b, Edges& edges) {
    const auto low = static_cast<std::uint64_t>(std::min(a, b)), high = static_cast<std::uint64_t>(std::max(a, b));
    const auto [entry, added] = edges.emplace(low << 32 | high, 0);
    entry->second += a < b ? 1 : -1;
    if (entry->second == 0) edges.erase(entry);
  }

  Topology total_;
  Edges open_;
  std::vector<Link> links_;
};

// The components of the whole mesh, from those of the parts.
class Components {
 public:
  void add(const TilePart& part) {
    Index count = 0;
    const std::vector<Index> label = component_labels(part.mesh, count);
    const Index first = std::ssize(supports_);
    supports_.insert(supports_.end(), part.supports.begin(), part.supports.end());
    for (const polygonization::SharedVertex& s : part.shared) {
      const Index here = first + label[s.vertex];
      const auto [entry, added] = seen_.emplace(s.key, here);
      if (!added && entry->second != here) joins_.emplace_back(entry->second, here);
    }
  }

  // Joins the components of the parts and decides which are kept.
  void finish() {
    DisjointSets sets(supports_.size());
    for (const auto& [a, b] : joins_) sets.unite(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
    std::map<std::uint32_t, DataSupport> whole;
    for (std::uint32_t c = 0; c < supports_.size(); ++c) whole[sets.find(c)].add(supports_[c]);
    std::vector<DataSupport> supports;
    for (const auto& [first, support] : whole) supports.push_back(support);
    const std::vector<char> keep = supports.empty() ? std::vector<char>{} : components_with_data(supports);
    std::map<std::uint32_t, char> kept;
    for (const auto& [first, support] : whole) kept.emplace(first, keep[kept.size()]);
    kept_.resize(supports_.size());
    for (std::uint32_t c = 0; c < supports_.size(); ++c) kept_[c] = kept[sets.find(c)];
    dropped_ = std::count(keep.begin(), keep.end(), 0);
    count_ = std::ssize(keep) - dropped_;
  }

  // Leaves what is kept of the next part, in the order in which they were added.
  void filter(TilePart& part) {
    if (dropped_ == 0) return;
    Index count = 0;
    const std::vector<Index> label = component_labels(part.mesh, count);
    const Index first = next_;
    next_ += std::ssize(part.supports);
    std::vector<Index> triangles;
    for (Index t = 0; t < part.mesh.triangles.cols(); ++t)
      if (kept_[first + label[part.mesh.triangles(0, t)]] != 0) triangles.push_back(t);
    if (std::ssize(triangles) == part.mesh.triangles.cols()) return;
    part.mesh.triangles = Triangles(part.mesh.triangles(Eigen::all, triangles));
    polygonization::drop_unused_vertices(part.mesh, part.shared);
  }
  void restart() { next_ = 0; }

  [[nodiscard]] Index count() const { return count_; }
  [[nodiscard]] Index dropped() const { return dropped_; }

 private:
  std::unordered_map<std::int64_t, Index> seen_;
  std::vector<std::pair<Index, Index>> joins_;
  std::vector<DataSupport> supports_;
  std::vector<char> kept_;
  Index next_ = 0, count_ = 0, dropped_ = 0;
};

// Calls visit(part, number, fresh) for what is kept of each part.
template <class Visit>
Index for_each_part(const TileFolder& folder, const std::vector<int>& rounds, Components& components,
                    const Visit& visit) {
  VertexNumbers numbers;
  components.restart();
  for (std::size_t t = 0; t < rounds.size(); ++t) {
    TilePart part = read_part(folder, static_cast<Index>(t), rounds[t]);
    components.filter(part);
    std::vector<char> fresh;
    const std::vector<std::int32_t> number = numbers.next(part, fresh);
    visit(part, number, fresh);
  }
  return numbers.count();
}

// Writes pieces of a file.
class PieceWriter {
 public:
  explicit PieceWriter(const std::string& path) : file_(path) {}

  template <class T>
  void add(T value) {
    append_scalar(buffer_, value);
    if (buffer_.size() >= written_at_once) flush();
  }
  void add(const std::string& text) { buffer_ += text; }
  void finish() {
    flush();
    file_.commit();
  }

 private:
  void flush() {
    file_.write(buffer_);
    buffer_.clear();
  }

  AtomicFile file_;
  std::string buffer_;
};

void write_ply(const TileFolder& folder, const std::vector<int>& rounds, Components& components, const Topology& found,
               bool as_double, const std::string& output) {
  PieceWriter file(output);
  const std::string type = as_double ? "double" : "float";
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(found.vertices) + "\n";
  for (const char axis : {'x', 'y', 'z'}) header += "property " + type + " " + axis + "\n";
  header += "property float nx\nproperty float ny\nproperty float nz\nelement face " + std::to_string(found.triangles) +
            "\nproperty list uchar int vertex_indices\nend_header\n";
  file.add(header);
  for_each_part(folder, rounds, components, [&](const TilePart& part, const auto&, const std::vector<char>& fresh) {
    for (Index v = 0; v < part.mesh.vertices.cols(); ++v) {
      if (fresh[v] == 0) continue;
      for (const double x : part.mesh.vertices.col(v)) {
        if (as_double)
          file.add(x);
        else
          file.add(static_cast<float>(x));
      }
      for (const double x : part.mesh.normals.col(v)) file.add(static_cast<float>(x));
    }
  });
  for_each_part(folder, rounds, components,
                [&](const TilePart& part, const std::vector<std::int32_t>& number, const auto&) {
                  for (Index t = 0; t < part.mesh.triangles.cols(); ++t) {
                    file.add(std::uint8_t{3});
                    for (const std::int32_t v : part.mesh.triangles.col(t)) file.add(number[v]);
                  }
                });
  file.finish();
}

void write_whole(const TileFolder& folder, const std::vector<int>& rounds, Components& components,
                 const Topology& found, const std::string& output) {
  Mesh mesh;
  mesh.vertices.resize(3, found.vertices);
  mesh.normals.resize(3, found.vertices);
  mesh.triangles.resize(3, found.triangles);
  Index at = 0;
  for_each_part(folder, rounds, components,
                [&](const TilePart& part, const std::vector<std::int32_t>& number, const std::vector<char>& fresh) {
                  for (Index v = 0; v < part.mesh.vertices.cols(); ++v) {
                    if (fresh[v] == 0) continue;
                    mesh.vertices.col(number[v]) = part.mesh.vertices.col(v);
                    mesh.normals.col(number[v]) = part.mesh.normals.col(v);
                  }
                  for (Index t = 0; t < part.mesh.triangles.cols(); ++t, ++at)
                    for (int c = 0; c < 3; ++c) mesh.triangles(c, at) = number[part.mesh.triangles(c, t)];
                });
  write_mesh(output, mesh);
}

}  // namespace

WeldedMesh weld_parts(const TileFolder& folder, const std::vector<int>& rounds, const std::string& output,
                      const Progress& progress) {
  report(progress, "write", 0);
  Components components;
  for (std::size_t t = 0; t < rounds.size(); ++t) components.add(read_part(folder, static_cast<Index>(t), rounds[t]));
  components.finish();
  TopologyCounter counter;
  Box<3> box;
  double moved = 0;  // by rounding to float
  const Index vertices =
      for_each_part(folder, rounds, components,
                    [&](const TilePart& part, const std::vector<std::int32_t>& number, const std::vector<char>&) {
                      counter.add(part, number);
                      box.add(bounding_box<3>(part.mesh.vertices));
                      const auto rounded = part.mesh.vertices.cast<float>().cast<double>();
                      if (part.mesh.vertices.cols() > 0)
                        moved = std::max(moved, (part.mesh.vertices - rounded).cwiseAbs().maxCoeff());
                    });
  WeldedMesh result{counter.finish(vertices, components.count()), components.dropped()};
  if (result.topology.triangles == 0)
    throw SolverFailure("reconstruct: the surface has no triangles; check the points");
  report(progress, "write", 0.3);
  if (file_extension(output) == ".ply")
    write_ply(folder, rounds, components, result.topology, moved > float_loss * box.diagonal(), output);
  else
    write_whole(folder, rounds, components, result.topology, output);
  report(progress, "write", 1);
  return result;
}

}  // namespace csrbf
