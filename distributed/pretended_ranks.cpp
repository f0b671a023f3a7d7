#include "pretended_ranks.hpp"

#include <ctime>
#include <numeric>

namespace csrbf::distributed {

void PretendedRanks::share(const SharedWork& work) {
  const std::clock_t start = std::clock();
  work.compute_blocks(0, work.blocks());
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const int ranks = static_cast<int>(traffic_.size());
  std::vector<std::int64_t> bytes(traffic_.size()), items(traffic_.size());
  std::int64_t rounds = 0;
  ByteWriter out;
  for (int rank = 0; rank < ranks; ++rank) {
    const auto r = static_cast<std::size_t>(rank);
    Index next = first_block(work.blocks(), rank, ranks);
    const Index first = next, last = first_block(work.blocks(), rank + 1, ranks);
    if (first < last) items[r] = work.end(last - 1) - work.begin(first);
    std::int64_t own_rounds = 0;
    for (; next < last; ++own_rounds) {
      pack_some(work, next, last, most_at_once(ranks), out);
      bytes[r] += static_cast<std::int64_t>(out.bytes().size());
    }
    rounds = std::max(rounds, own_rounds);
  }
  const std::int64_t all = std::accumulate(bytes.begin(), bytes.end(), std::int64_t{0});
  for (std::size_t r = 0; r < traffic_.size(); ++r) {
    Traffic& traffic = traffic_[r][std::string(work.name)];
    ++traffic.works;
    traffic.items += work.items;
    traffic.computed += items[r];
    traffic.rounds += rounds;
    traffic.sent += bytes[r];
    traffic.received += all - bytes[r];
    traffic.seconds += seconds / ranks;  // as if all items took the same time
  }
}

}  // namespace csrbf::distributed
