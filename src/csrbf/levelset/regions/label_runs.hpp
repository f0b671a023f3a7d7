#pragma once

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/grid.hpp"

#include <span>
#include <vector>

namespace csrbf {

/// The runs of equal labels along x in all rows of an image, and which of them are connected by the faces of voxels.
class LabelRuns {
 public:
  struct Run {
    Index begin, end;  ///< voxels of the row
    std::uint8_t label;
  };

  LabelRuns(std::span<const std::uint8_t> labels, const Grid& grid);

  /// The connected parts of a label, numbered from 0 in the order of their first voxels, as one number for each run; -1
  /// for runs of other labels.
  struct Parts {
    std::vector<std::int32_t> of_run;
    std::size_t count = 0;
  };
  [[nodiscard]] Parts parts(std::uint8_t label);
  /// Connected parts of all labels.
  [[nodiscard]] Index count_parts();

  std::vector<Run> runs;           ///< row by row
  std::vector<std::size_t> first;  ///< run of each row, and the number of runs
  DisjointSets sets;

 private:
  void join(Index row, Index other);
};

}  // namespace csrbf
