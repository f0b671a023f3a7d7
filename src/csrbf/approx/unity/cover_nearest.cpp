#include "csrbf/approx/unity/cover.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace csrbf {
namespace {

// Copies the n smallest of the first `count` entries of `near` to `found`, in order. By buckets of equal volume, which
// hold about equally many where points are evenly spread.
template <int Dim>
void sort_nearest(std::size_t count, std::size_t n, double reach, typename Cover<Dim>::Search& search) {
  constexpr std::size_t per_bucket = 4;  // entries, chosen by hand: buckets to count against entries to sort
  const std::size_t buckets = count / per_bucket + 1;
  const double last = static_cast<double>(buckets - 1), scale = 1 / (reach * reach);
  search.end.assign(buckets, 0);
  search.bucket.resize(std::max(search.bucket.size(), count));
  search.sorted.resize(std::max(search.sorted.size(), count));
  for (std::size_t i = 0; i < count; ++i) {
    const double t = search.near[i].first * scale;
    double volume = Dim % 2 == 0 ? 1 : std::sqrt(t);
    for (int d = 1; d < Dim; d += 2) volume *= t;
    const double place = volume * static_cast<double>(buckets);
    search.bucket[i] = static_cast<std::uint32_t>(place < last ? place : last);
    ++search.end[search.bucket[i]];
  }
  std::exclusive_scan(search.end.begin(), search.end.end(), search.end.begin(), std::uint32_t{0});
  for (std::size_t i = 0; i < count; ++i) search.sorted[search.end[search.bucket[i]]++] = search.near[i];
  std::size_t begin = 0;
  for (std::size_t b = 0; begin < n; begin = search.end[b++]) {
    const auto first = search.sorted.begin();
    std::sort(first + static_cast<std::ptrdiff_t>(begin), first + search.end[b]);
  }
  search.found.assign(search.sorted.begin(), search.sorted.begin() + static_cast<std::ptrdiff_t>(n));
}

}  // namespace

// Those closer than `reach` come first in `near`; returns how many they are.
template <int Dim>
std::size_t Cover<Dim>::collect(const Point<Dim>& x, double reach, Search& search) const {
  std::size_t count = 0;
  for_each_cell({x.array() - reach, x.array() + reach}, [&](std::uint32_t cell) {
    const std::size_t most = count + static_cast<std::size_t>(begin_[cell + 1] - begin_[cell]);
    if (search.near.size() < most) search.near.resize(2 * most);
    for (Index i = begin_[cell]; i < begin_[cell + 1]; ++i) {  // without branches, as they would be unpredictable
      const double d2 = (points_.col(i) - x).squaredNorm();
      search.near[count] = {d2, static_cast<std::uint32_t>(i)};
      count += d2 < reach * reach ? 1 : 0;
    }
  });
  return count;
}

template <int Dim>
void Cover<Dim>::nearest(const Point<Dim>& x, Index n, double reach, Search& search) const {
  n = std::min(n, points_.cols());
  constexpr double rounding = 1e-12;
  // The next reach is a little more than evenly spread points need, within bounds. Chosen by hand.
  constexpr double excess = 1.1, least_factor = 1.15, largest_factor = 2;
  const double farthest = (1 + rounding) * ((x - tree_.box.center()).norm() + tree_.box.diagonal());
  reach = std::min(std::max(reach, rounding * farthest), farthest);
  std::size_t count = 0;
  for (;;) {
    count = collect(x, reach, search);
    const auto found = static_cast<Index>(count);
    if (found >= n || reach >= farthest) break;
    const double missing = static_cast<double>(n) / static_cast<double>(std::max<Index>(found, 1));
    reach = std::min(farthest, reach * std::clamp(excess * std::pow(missing, 1.0 / Dim), least_factor, largest_factor));
  }
  sort_nearest<Dim>(count, std::min(count, static_cast<std::size_t>(n)), reach, search);
}

#define CSRBF_INSTANTIATE(Dim) \
  template void Cover<Dim>::nearest(const Point<Dim>& x, Index n, double reach, Search& search) const;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
