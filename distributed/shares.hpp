#pragma once

#include "csrbf/core/shared_work.hpp"

#include <cstdint>
#include <map>
#include <string>

namespace csrbf::distributed {

/// First of the blocks that a rank computes: ranks have consecutive blocks, in numbers that differ by at most one, and
/// rank 0 has the first. Those of the last rank end at first_block(blocks, ranks, ranks) = blocks.
inline Index first_block(Index blocks, int rank, int ranks) {
  return (blocks * rank + ranks - 1) / ranks;
}

/// Bytes that a rank sends at once, about: 64 MB for all ranks together, at least 64 kB each. Larger: fewer rounds,
/// smaller: less memory beside the results. Chosen by hand.
inline std::size_t most_at_once(int ranks) {
  constexpr std::size_t all = std::size_t{64} << 20, least = std::size_t{64} << 10;
  return std::max(least, all / static_cast<std::size_t>(ranks));
}

/// Packs blocks from `next` to `last` until there are about `most` bytes; moves `next` past them.
inline void pack_some(const SharedWork& work, Index& next, Index last, std::size_t most, ByteWriter& out) {
  out.clear();
  while (next < last && out.bytes().size() < most) {
    work.pack(work.begin(next), work.end(next), out);
    ++next;
  }
}

/// What one rank computed, sent and received in shared work of one name.
struct Traffic {
  std::int64_t works = 0;
  std::int64_t items = 0;     ///< of all ranks
  std::int64_t computed = 0;  ///< items computed by this rank
  std::int64_t rounds = 0;    ///< all-to-all exchanges
  std::int64_t sent = 0;      ///< bytes of own results, which go to all others
  std::int64_t received = 0;  ///< bytes of the results of others
  double seconds = 0;         ///< CPU time of the items computed by this rank
};

/// By the name of the work.
using TrafficTable = std::map<std::string, Traffic, std::less<>>;

}  // namespace csrbf::distributed
