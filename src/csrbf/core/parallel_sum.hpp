#pragma once

#include "csrbf/core/parallel.hpp"

#include <numeric>
#include <vector>

namespace csrbf {

/// Sum of body(begin, end) over consecutive ranges of at most `grain` indices that cover [0, n), on all threads (see
/// parallel_for()). Partial sums are added in the order of the ranges, so the result is bit-identical for any number
/// of threads.
template <class Body>
double parallel_sum(Index n, Index grain, const Body& body) {
  std::vector<double> sums((n + grain - 1) / grain, 0.0);
  parallel_for(n, grain, [&](Index begin, Index end) { sums[begin / grain] = body(begin, end); });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace csrbf
