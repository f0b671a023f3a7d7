#include "csrbf/approx/samples/separate_tail.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double largest_share = 0.2, body = 0.5;  // shares: of errors; of sizes that tell how the tail falls
constexpr Index fewest = 12;                       // sizes that an exponent is estimated from
constexpr Index near_factor = 4, near_more = 24;   // ranks up to which sizes are next to one
constexpr double uncertainty = 2;                  // standard errors that exponents are lowered by
constexpr double significant = 1e-4;               // of the smallest of a few hundred dependent tests
constexpr double rank_step = 1.03;                 // ratio of consecutive ranks that are tried, where there are many
constexpr std::array<double, 11> widths = {2, 3, 4, 6, 8, 12, 16, 24, 32, 64, 128};

// The probability of at most k successes among n.
double binomial_at_most(Index k, Index n, double success) {
  double sum = 0;
  const auto total = static_cast<double>(n);
  for (Index i = 0; i <= k; ++i) {
    const auto x = static_cast<double>(i);
    sum += std::exp(std::lgamma(total + 1) - std::lgamma(x + 1) - std::lgamma(total - x + 1) + x * std::log(success) +
                    (total - x) * std::log1p(-success));
  }
  return std::min(sum, 1.0);
}

// Descending sizes of a sample.
class Tail {
 public:
  explicit Tail(std::vector<double> sizes) : z_(std::move(sizes)) { std::sort(z_.begin(), z_.end(), std::greater<>()); }

  [[nodiscard]] std::optional<double> cut() const {
    double least = significant;
    Range found;
    for (Index i = 1; i <= static_cast<Index>(largest_share * count()); i = next(i))
      for (const Range& range : ranges(i))
        if (range.chance < least) {
          least = range.chance;
          found = range;
        }
    if (found.first == 0) return std::nullopt;
    // At the widest spacing, in units of that expected there (Renyi 1953).
    double widest = 0, cut = at(found.first);
    for (Index i = found.first - 1; i >= found.beyond; --i) widen(i, widest, cut);
    if (found.beyond > 0) widen(found.beyond - 1, widest, cut);
    return cut;
  }

 private:
  [[nodiscard]] Index size() const { return std::ssize(z_); }
  [[nodiscard]] double count() const { return static_cast<double>(z_.size()); }
  [[nodiscard]] double at(Index i) const { return z_[static_cast<std::size_t>(i)]; }
  static Index next(Index i) { return std::max(i + 1, static_cast<Index>(rank_step * static_cast<double>(i))); }

  // Of the power of x that the number of sizes beyond x falls by at that of rank i, or 0 if it is unknown.
  [[nodiscard]] double exponent(Index i) const {
    double result = 0;
    const Index all = std::max(static_cast<Index>(body * count()), i + 1);
    for (const Index j : {all, std::min(all, std::max(near_factor * i, i + near_more))}) {
      if (j - i < fewest || j >= size() || !(at(j) > 0) || !(at(i) > at(j))) continue;
      const double fall = std::log(static_cast<double>(j + 1) / static_cast<double>(i + 1)) / std::log(at(i) / at(j));
      result = std::max(result, fall * (1 - uncertainty / std::sqrt(static_cast<double>(j - i))));
    }
    return result;
  }

  // Sizes of ranks from `beyond` to `first`, as few as they are by chance in the tail of the others.
  struct Range {
    Index first = 0, beyond = 0;
    double chance = 1;
  };

  [[nodiscard]] std::vector<Range> ranges(Index first) const {
    std::vector<Range> result;
    const double power = exponent(first);
    if (!(power > 0)) return result;
    for (const double width : widths) {
      const double end = width * at(first);
      const Index beyond = std::lower_bound(z_.begin(), z_.end(), end, std::greater<>()) - z_.begin();
      if (beyond == 0) break;
      result.push_back({first, beyond, binomial_at_most(first - beyond, first, 1 - std::pow(width, -power))});
    }
    return result;
  }

  void widen(Index i, double& widest, double& cut) const {
    const double spacing = static_cast<double>(i + 1) * std::log(at(i) / at(i + 1));
    if (!(spacing > widest)) return;
    widest = spacing;
    cut = at(i + 1);
  }

  std::vector<double> z_;
};

}  // namespace

std::optional<double> separate_tail(const Eigen::Ref<const Eigen::VectorXd>& sizes) {
  return Tail({sizes.begin(), sizes.end()}).cut();
}

}  // namespace csrbf
