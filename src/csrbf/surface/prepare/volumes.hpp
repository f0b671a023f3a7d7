#pragma once

#include "csrbf/surface/normals/neighbor_table.hpp"

namespace csrbf {

/// Whether points fill a volume, as outliers in a cluster do, instead of lying on a surface as the others do: among the
/// neighbours of a point the direction of least variance has more of it. Under noise of half a spacing and more nothing
/// is said to fill a volume. O(n) for the points and for at most some thousand of the others.
bool fill_volume(const Points<3>& points, const NeighborTable& near, const std::vector<Index>& ids,
                 const std::vector<Index>& others);

/// Whether points lie on sheets, and not along a line, in the mean over them and their neighbours: far more clearly
/// than outliers do; or all have normals (3 x n, zero: none; or 3 x 0) that are those of a surface through them, which
/// shows also where a body is as thick as its samples are apart. O(n).
bool lie_on_sheets(const Points<3>& points, const Points<3>& normals, const NeighborTable& near,
                   const std::vector<Index>& ids);

/// Whether they may: they fill no volume, and are not along a line. Few samples of thin legs say no more. O(n).
bool may_lie_on_sheets(const Points<3>& points, const Points<3>& normals, const NeighborTable& near,
                       const std::vector<Index>& ids);

}  // namespace csrbf
