#include "csrbf/core/shared_work.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/inside_parallel_loop.hpp"
#include "csrbf/core/parallel.hpp"

namespace csrbf {
namespace {

WorkSharing* sharing_in_use = nullptr;

}  // namespace

bool is_shared(Index items, Index grain) {
  return sharing_in_use != nullptr && items > grain && !inside_parallel_loop();
}

void ByteReader::fail() {
  throw SolverFailure("shared work: results of another process or run are incomplete");
}

void SharedWork::compute_blocks(Index first, Index last) const {
  const Index offset = begin(first);
  if (first < last)
    parallel_for(end(last - 1) - offset, grain, [&](Index from, Index to) { compute(offset + from, offset + to); });
}

void set_work_sharing(WorkSharing* sharing) {
  sharing_in_use = sharing;
}

void share_work(const SharedWork& work) {
  if (is_shared(work.items, work.grain)) {
    sharing_in_use->share(work);
  } else {
    parallel_for(work.items, work.grain, work.compute);
  }
}

void share_arrays(std::string_view name, Index items, Index grain, const std::function<void(Index, Index)>& compute,
                  std::initializer_list<ResultArray> results) {
  const auto for_each_array = [results](Index begin, Index end, const auto& copy) {
    for (const ResultArray& array : results) {
      const auto size = static_cast<Index>(array.size);
      copy(array.data + size * begin, size * (end - begin));
    }
  };
  const auto pack = [&](Index begin, Index end, ByteWriter& out) {
    for_each_array(begin, end, [&](const std::byte* at, Index size) { out.put(at, size); });
  };
  const auto unpack = [&](Index begin, Index end, ByteReader& in) {
    for_each_array(begin, end, [&](std::byte* at, Index size) { in.take(at, size); });
  };
  share_work({name, items, grain, compute, pack, unpack});
}

}  // namespace csrbf
