#include "csrbf/levelset/regions/slab_components.hpp"

#include "csrbf/levelset/regions/label_runs.hpp"

#include <limits>

namespace csrbf {
namespace {

constexpr std::uint32_t no_part = std::numeric_limits<std::uint32_t>::max();

}  // namespace

void SlabComponents::add(std::span<const std::uint8_t> labels) {
  const Index slice = nx_ * ny_;
  std::vector<std::uint8_t> joined = last_;  // so that parts go on in these
  joined.insert(joined.end(), labels.begin(), labels.end());
  Grid grid;
  grid.size = {nx_, ny_, std::ssize(joined) / slice};
  LabelRuns runs(joined, grid);
  std::vector<std::uint32_t> part_of(runs.runs.size(), no_part);  // of the first run of a set
  const auto root_of = [&](std::size_t run) { return runs.sets.find(static_cast<std::uint32_t>(run)); };
  for (std::size_t run = 0; run < last_part_.size(); ++run) {
    if (runs.runs[run].label == 0) continue;
    std::uint32_t& part = part_of[root_of(run)];
    if (part == no_part)
      part = last_part_[run];
    else
      parts_.unite(part, last_part_[run]);
  }
  for (std::size_t run = 0; run < runs.runs.size(); ++run)
    if (runs.runs[run].label != 0 && part_of[root_of(run)] == no_part) part_of[root_of(run)] = parts_.add();
  last_.assign(joined.end() - slice, joined.end());
  last_part_.clear();
  for (std::size_t run = runs.first[static_cast<std::size_t>((grid.size[2] - 1) * ny_)]; run < runs.runs.size(); ++run)
    last_part_.push_back(part_of[root_of(run)]);
}

Index SlabComponents::count() {
  Index count = 0;
  for (std::uint32_t i = 0; i < parts_.size(); ++i) count += parts_.find(i) == i ? 1 : 0;
  return count;
}

}  // namespace csrbf
