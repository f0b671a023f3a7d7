#include "csrbf/spatial/radix_sort.hpp"

#include "csrbf/core/parallel.hpp"

#include <bit>

namespace csrbf {
namespace {

constexpr int most_digit_bits = 11;  // conventional: the 2048 counters fit the first-level cache
// Chosen by hand: smaller or more parts balance the threads better, but each has its own counters to add up.
constexpr std::size_t fewest_in_part = 1 << 15, most_parts = 64;

}  // namespace

// Least significant digit first. Each part of the items counts its digits; the counts give the places of its items.
void radix_sort(std::vector<Keyed>& items, std::uint32_t limit) {
  const auto before = [](const Keyed& a, const Keyed& b) { return a.key < b.key; };
  if (std::is_sorted(items.begin(), items.end(), before)) return;
  const std::size_t n = items.size();
  const std::size_t parts = std::clamp<std::size_t>(n / fewest_in_part, 1, most_parts), each = (n + parts - 1) / parts;
  const int bits = std::bit_width(limit), digits = (bits + most_digit_bits - 1) / most_digit_bits;
  const int digit_bits = digits > 0 ? (bits + digits - 1) / digits : 0;
  const std::uint32_t mask = (std::uint32_t{1} << digit_bits) - 1;
  using Counts = std::array<std::uint32_t, std::size_t{1} << most_digit_bits>;
  std::vector<Counts> next(parts);
  std::vector<Keyed> sorted(digits > 0 ? n : 0);
  for (int digit = 0; digit < digits; ++digit) {
    const int shift = digit * digit_bits;
    const auto for_each_part = [&](const auto& action) {
      parallel_for(static_cast<std::ptrdiff_t>(parts), 1, [&](std::ptrdiff_t part, std::ptrdiff_t) {
        const std::size_t begin = each * static_cast<std::size_t>(part), end = std::min(n, begin + each);
        Counts& places = next[part];
        action(places, begin, end);
      });
    };
    for_each_part([&](Counts& counts, std::size_t begin, std::size_t end) {
      counts.fill(0);
      for (std::size_t i = begin; i < end; ++i) ++counts[items[i].key >> shift & mask];
    });
    std::uint32_t place = 0;
    for (std::size_t d = 0; d <= mask; ++d)
      for (Counts& counts : next) {
        const std::uint32_t count = counts[d];
        counts[d] = place;
        place += count;
      }
    for_each_part([&](Counts& places, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) sorted[places[items[i].key >> shift & mask]++] = items[i];
    });
    items.swap(sorted);
  }
}

}  // namespace csrbf
