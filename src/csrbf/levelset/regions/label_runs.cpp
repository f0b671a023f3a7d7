#include "csrbf/levelset/regions/label_runs.hpp"

namespace csrbf {

LabelRuns::LabelRuns(std::span<const std::uint8_t> labels, const Grid& grid) : sets(0) {
  const auto [nx, ny, nz] = grid.size;
  first.reserve(static_cast<std::size_t>(ny * nz) + 1);
  for (Index row = 0; row < ny * nz; ++row) {
    first.push_back(runs.size());
    const std::uint8_t* label = labels.data() + nx * row;
    for (Index x = 0; x < nx;) {
      Index end = x + 1;
      while (end < nx && label[end] == label[x]) ++end;
      runs.push_back({x, end, label[x]});
      x = end;
    }
  }
  first.push_back(runs.size());
  sets = DisjointSets(runs.size());
  for (Index z = 0; z < nz; ++z)
    for (Index y = 0; y < ny; ++y) {
      if (y > 0) join(y + ny * z, y - 1 + ny * z);
      if (z > 0) join(y + ny * z, y + ny * (z - 1));
    }
}

LabelRuns::Parts LabelRuns::parts(std::uint8_t label) {
  Parts result;
  result.of_run.assign(runs.size(), -1);
  // The first run of a set represents it.
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].label != label) continue;
    const std::uint32_t root = sets.find(static_cast<std::uint32_t>(i));
    result.of_run[i] = root == i ? static_cast<std::int32_t>(result.count++) : result.of_run[root];
  }
  return result;
}

Index LabelRuns::count_parts() {
  Index count = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) count += sets.find(static_cast<std::uint32_t>(i)) == i ? 1 : 0;
  return count;
}

void LabelRuns::join(Index row, Index other) {
  std::size_t a = first[row], b = first[other];
  const std::size_t a_end = first[static_cast<std::size_t>(row) + 1];
  const std::size_t b_end = first[static_cast<std::size_t>(other) + 1];
  while (a < a_end && b < b_end) {
    if (runs[a].label == runs[b].label && runs[a].begin < runs[b].end && runs[b].begin < runs[a].end)
      sets.unite(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
    (runs[a].end < runs[b].end ? a : b) += 1;
  }
}

}  // namespace csrbf
