#include "csrbf/approx/unity/cover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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
    const auto first = search.sorted.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = search.sorted.begin() + search.end[b];
    if (search.end[b] <= n) {
      std::sort(first, last);
      continue;
    }
    const auto wanted = search.sorted.begin() + static_cast<std::ptrdiff_t>(n);
    std::nth_element(first, wanted, last);  // a cluster far away is all in one bucket
    std::sort(first, wanted);
  }
  search.found.assign(search.sorted.begin(), search.sorted.begin() + static_cast<std::ptrdiff_t>(n));
}

}  // namespace

// Those closer than `reach` come first in `near`; returns how many they are. Stops when there are more than `limit`.
template <int Dim>
std::size_t Cover<Dim>::collect(const Point<Dim>& x, double reach, std::size_t limit, Search& search) const {
  std::size_t count = 0;
  for_each_cell({x.array() - reach, x.array() + reach}, [&](std::uint32_t cell) {
    if (count > limit) return;
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

// A smaller reach with at least n points, if cells tell one.
template <int Dim>
double Cover<Dim>::shrink(const Point<Dim>& x, Index n, double reach) const {
  constexpr int halvings = 12;
  double enough = reach, too_small = 0;
  for (int k = 0; k < halvings; ++k) {
    const double tried = 0.5 * (enough + too_small);
    Index inside = 0;
    for_each_cell({x.array() - tried, x.array() + tried}, [&](std::uint32_t cell) {
      const Box<Dim>& box = cells_[cell];
      const Point<Dim> farthest = (x - box.lo).cwiseAbs().cwiseMax((x - box.hi).cwiseAbs());
      if (farthest.squaredNorm() < tried * tried) inside += count(cell);
    });
    (inside >= n ? enough : too_small) = tried;
  }
  return enough;
}

template <int Dim>
void Cover<Dim>::nearest(const Point<Dim>& x, Index n, double reach, Search& search) const {
  n = std::min(n, points_.cols());
  constexpr double rounding = 1e-12;
  // The next reach is a little more than evenly spread points need, within bounds. Chosen by hand.
  constexpr double excess = 1.1, least_factor = 1.15, largest_factor = 2;
  const double farthest = (1 + rounding) * ((x - tree_.box.center()).norm() + tree_.box.diagonal());
  reach = std::min(std::max(reach, rounding * farthest), farthest);
  constexpr std::size_t most = 16, least_most = 4096;  // points looked at for each wanted; chosen by hand
  std::size_t count = 0, limit = std::max(most * static_cast<std::size_t>(n), least_most);
  for (;;) {
    count = collect(x, reach, limit, search);
    if (count > limit) {  // in a cluster, or across to one
      reach = shrink(x, n, reach);
      limit = std::numeric_limits<std::size_t>::max();
      continue;
    }
    const auto found = static_cast<Index>(count);
    if (found >= n || reach >= farthest) break;
    const double missing = static_cast<double>(n) / static_cast<double>(std::max<Index>(found, 1));
    reach = std::min(farthest, reach * std::clamp(excess * std::pow(missing, 1.0 / Dim), least_factor, largest_factor));
  }
  sort_nearest<Dim>(count, std::min(count, static_cast<std::size_t>(n)), reach, search);
}

template <int Dim>
bool Cover<Dim>::any_within(const Point<Dim>& x, double reach) const {
  bool found = false;
  for_each_cell({x.array() - reach, x.array() + reach}, [&](std::uint32_t cell) {
    for (Index i = begin_[cell]; i < begin_[cell + 1] && !found; ++i)
      found = (points_.col(i) - x).squaredNorm() <= reach * reach;
  });
  return found;
}

#define CSRBF_INSTANTIATE(Dim)                                                                         \
  template void Cover<Dim>::nearest(const Point<Dim>& x, Index n, double reach, Search& search) const; \
  template bool Cover<Dim>::any_within(const Point<Dim>& x, double reach) const;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
