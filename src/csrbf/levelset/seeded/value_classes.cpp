#include "csrbf/levelset/seeded/value_classes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr std::size_t most_value_classes = 7;

// Sums over the bins before each.
struct BinSums {
  std::vector<double> counts{0}, firsts{0}, seconds{0};

  explicit BinSums(std::span<const double> histogram) {
    for (std::size_t i = 0; i < histogram.size(); ++i) {
      const auto x = static_cast<double>(i);
      counts.push_back(counts.back() + histogram[i]);
      firsts.push_back(firsts.back() + histogram[i] * x);
      seconds.push_back(seconds.back() + histogram[i] * x * x);
    }
  }

  // Nats of the samples in bins [begin, end) by one Gaussian, and by the share of its class.
  [[nodiscard]] double price(std::size_t begin, std::size_t end) const {
    constexpr double none = 1e-9, least_variance = 0.25;  // of the width of a bin
    const double count = counts[end] - counts[begin];
    if (count <= none) return 0;
    const double mean = (firsts[end] - firsts[begin]) / count;
    const double variance = (seconds[end] - seconds[begin]) / count - mean * mean + 1.0 / 12;
    return count * (0.5 * std::log(std::max(variance, least_variance)) + std::log(counts.back() / count));
  }
};

}  // namespace

std::vector<std::size_t> value_classes(std::span<const double> histogram, double independent) {
  const std::size_t bins = histogram.size();
  const BinSums sums(histogram);
  const auto price = [&](std::size_t begin, std::size_t end) { return independent * sums.price(begin, end); };
  const double parameters = 1.5 * std::log(std::max(2.0, sums.counts.back() * independent));  // of a class
  std::vector<double> best(bins + 1, 0);                                                      // of the bins before each
  for (std::size_t end = 1; end <= bins; ++end) best[end] = price(0, end);
  std::vector<std::vector<std::size_t>> last;  // where the last class of the bins before each begins
  std::vector<std::size_t> starts{0, bins};
  double least = best[bins] + parameters;
  for (std::size_t classes = 2; classes <= std::min(most_value_classes, bins); ++classes) {
    std::vector<double> next(bins + 1, std::numeric_limits<double>::infinity());
    std::vector<std::size_t>& from = last.emplace_back(bins + 1, 0);
    for (std::size_t end = classes; end <= bins; ++end)
      for (std::size_t begin = classes - 1; begin < end; ++begin) {
        const double sum = best[begin] + price(begin, end);
        if (sum >= next[end]) continue;
        next[end] = sum;
        from[end] = begin;
      }
    best = std::move(next);
    const double total = best[bins] + parameters * static_cast<double>(classes);
    if (total >= least) continue;
    least = total;
    starts = {bins};
    for (auto step = last.rbegin(); step != last.rend(); ++step) starts.push_back((*step)[starts.back()]);
    starts.push_back(0);
    std::reverse(starts.begin(), starts.end());
  }
  return starts;
}

}  // namespace csrbf
