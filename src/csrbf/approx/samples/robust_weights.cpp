#include "csrbf/approx/samples/robust_weights.hpp"

#include "csrbf/approx/samples/local_deviations.hpp"
#include "csrbf/approx/samples/missing_marks.hpp"
#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/spatial/coincident_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/squared_distances.hpp"
#include "csrbf/spatial/usual_extent.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

namespace csrbf {
namespace {

using IsError = Eigen::Array<bool, Eigen::Dynamic, 1>;  // for each sample

// Chosen by hand.
constexpr double gross = 8;               // deviations of a gross error
constexpr double few_errors = 0.01;       // share below which they may be the tail of the distribution
constexpr double gross_alone = 100;       // deviations of one of so few
constexpr double most_errors = 0.2;       // share of the samples
constexpr Index least_dense = 8;          // samples over those of a local fit, below which peaks look like errors
constexpr Index all_at_once = 2000;       // samples that are all looked at
constexpr Index blocks = 8, block = 256;  // of neighbours, beyond
constexpr double huber = 1.345;           // deviation up to which samples have their weight (Huber 1981)
constexpr double student_degrees = 4;     // of freedom (Lange et al. 1989)

// Places of the `count` smallest of the numbers. Those above a limit, which some of them tell, are not sorted.
std::vector<Index> smallest(const Eigen::VectorXd& numbers, Index count) {
  constexpr Index asked = 4096;
  const Index n = numbers.size(), stride = std::max<Index>(1, n / asked);
  std::vector<double> some;
  for (Index i = 0; i < n; i += stride) some.push_back(numbers[i]);
  const Index place = 2 * count / stride + 16;  // twice as many are expected up to there, and some more by chance
  std::vector<Index> order;
  if (place < std::ssize(some)) {
    std::nth_element(some.begin(), some.begin() + place, some.end());
    const double limit = some[static_cast<std::size_t>(place)];
    for (Index i = 0; i < n; ++i)
      if (numbers[i] <= limit) order.push_back(i);
  }
  if (std::ssize(order) < count) {
    order.resize(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), Index{0});
  }
  std::nth_element(order.begin(), order.begin() + count, order.end(),
                   [&](Index a, Index b) { return numbers[a] < numbers[b]; });
  order.resize(static_cast<std::size_t>(count));
  return order;
}

// The samples nearest to a few of them: O(n) for each.
template <int Dim>
bool any_in_blocks(const Samples<Dim>& samples) {
  const Index n = samples.size();
  Eigen::VectorXd r2(n);
  for (Index k = 0; k < blocks; ++k) {
    squared_distances<Dim>(samples.points.data(), n, samples.points.col((2 * k + 1) * n / (2 * blocks)), r2.data());
    const std::vector<Index> chosen = smallest(r2, block);
    Samples<Dim> some = chosen_samples(samples, chosen);
    std::vector<Index> all(chosen.size());
    std::iota(all.begin(), all.end(), Index{0});
    if (local_deviations(some, all).maxCoeff() > gross) return true;
  }
  return false;
}

// The samples with coordinates of the same usual extent; none if they have it about so already.
template <int Dim>
std::optional<Samples<Dim>> of_equal_extents(const Samples<Dim>& samples) {
  constexpr double different = 2;  // ratio of extents; chosen by hand
  Point<Dim> extent = usual_extent<Dim>(samples.points);
  for (double& side : extent) side = side > 0 ? side : extent.maxCoeff();
  if (!(extent.maxCoeff() > different * extent.minCoeff())) return std::nullopt;
  Samples<Dim> result = samples;
  result.points.array().colwise() /= extent.array();
  return result;
}

// Whether the nearest samples of errors are errors too, clearly more often than by chance: errors have no company, but
// what is thin does, such as joints between bricks.
template <int Dim>
bool keep_company(const Samples<Dim>& samples, const IsError& is_error) {
  const auto errors = static_cast<double>(is_error.count());
  const double by_chance = errors * errors / static_cast<double>(is_error.size());
  const double clearly_more = std::max(2 * by_chance, by_chance + 4 * std::sqrt(by_chance) + 4);
  const KdTree<Dim> tree(samples.points);
  Index company = 0;
  for (Index i = 0; i < samples.size(); ++i) {
    if (!is_error[i]) continue;
    std::array<Index, 2> found{};
    std::array<double, 2> r2{};
    tree.nearest(samples.points.col(i), 2, found.data(), r2.data());
    company += is_error[found[found[0] == i ? 1 : 0]] ? 1 : 0;
  }
  return static_cast<double>(company) > clearly_more;
}

// Which of the samples that are far off are together: groups, linked by nearest neighbours, that those without company
// would hardly ever make by chance. Samples that agree with each other are a peak, however narrow.
template <int Dim>
IsError find_peaks(const Samples<Dim>& samples, const IsError& is_off) {
  constexpr int near = 2 * Dim + 1;
  constexpr double rare = 0.05;  // expected number of such groups
  const Index n = samples.size();
  IsError is_peak = IsError::Constant(n, false);
  if (n <= near) return is_peak;
  const KdTree<Dim> tree(samples.points);
  DisjointSets sets(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) {
    if (!is_off[i]) continue;
    std::array<Index, near> found{};
    std::array<double, near> r2{};
    tree.nearest(samples.points.col(i), near, found.data(), r2.data());
    for (const Index j : found)
      if (is_off[j]) sets.unite(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j));
  }
  std::map<std::uint32_t, std::vector<Index>> groups;
  for (Index i = 0; i < n; ++i)
    if (is_off[i]) groups[sets.find(static_cast<std::uint32_t>(i))].push_back(i);
  const auto all = static_cast<double>(is_off.count());
  for (const auto& [first, group] : groups) {
    if (group.size() < 2) continue;
    // Connected groups of m places among n that have `degree` neighbours each are at most n (e degree)^(m - 1) / m.
    constexpr double degree = 1.3 * (near - 1), e = 2.71828;
    const auto m = static_cast<double>(group.size());
    const double share = (all - m + 1) / static_cast<double>(n);
    const double expected = static_cast<double>(n) * share * std::pow(e * degree * share, m - 1) / m;
    if (expected < rare)
      for (const Index i : group) is_peak[i] = true;
  }
  return is_peak;
}

// A value that means that there is none is an error everywhere if it mostly is, also where two of them are neighbours
// and agree.
void add_marks(const Eigen::MatrixXd& values, IsError& is_error) {
  for (Index c = 0; c < values.cols(); ++c) {
    const std::optional<double> mark = value_beyond_all_others(values.col(c));
    if (!mark) continue;
    const IsError has_mark = values.col(c).array() == *mark;
    if (2 * (is_error && has_mark).count() > has_mark.count()) is_error = is_error || has_mark;
  }
}

// Which samples others at the same place contradict, with which those around agree: however few there are, no curved
// function explains that.
template <int Dim>
IsError contradicted(const Samples<Dim>& samples) {
  constexpr double less = 1. / 3;        // deviation of the other over that of an error, at most; chosen by hand
  constexpr double most_repeated = 0.1;  // share of many samples; more are repeated measurements, and cost too much
  const Index n = samples.size();
  const std::vector<Index> first = first_coincident<Dim>(samples.points);
  std::vector<char> has_others(first.size(), 0);
  for (Index i = 0; i < n; ++i)
    if (first[i] != i) has_others[i] = has_others[first[i]] = 1;
  std::vector<Index> targets;
  for (Index i = 0; i < n; ++i)
    if (has_others[i] != 0) targets.push_back(i);
  IsError is_error = IsError::Constant(n, false);
  if (n > all_at_once && static_cast<double>(targets.size()) > most_repeated * static_cast<double>(n)) return is_error;
  const Eigen::VectorXd deviation = local_deviations(samples, targets);
  std::map<Index, double> least;  // by place
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const Index i = targets[t];
    if (samples.weight(i) == 0) continue;
    const auto [place, is_new] = least.try_emplace(first[i], deviation[t]);
    place->second = std::min(place->second, deviation[t]);
  }
  for (std::size_t t = 0; t < targets.size(); ++t)
    is_error[targets[t]] = deviation[t] > gross && least.at(first[targets[t]]) < less * deviation[t];
  return is_error;
}

// How far samples are off, by neighbours in the units of the coordinates or in usual ones: a function that varies along
// one axis within the neighbours that another unit gives is no error.
template <int Dim>
Eigen::ArrayXd deviations(const Samples<Dim>& samples) {
  std::vector<Index> all(static_cast<std::size_t>(samples.size()));
  std::iota(all.begin(), all.end(), Index{0});
  Eigen::ArrayXd deviation = local_deviations(samples, all);
  if (const std::optional<Samples<Dim>> scaled = of_equal_extents(samples))
    deviation = deviation.min(local_deviations(*scaled, all).array());
  return deviation;
}

// Which samples are too far off, by what is usual.
template <int Dim>
IsError far_off(const Samples<Dim>& samples) {
  const IsError none = IsError::Constant(samples.size(), false);
  if (samples.size() > all_at_once && !any_in_blocks(samples)) return none;
  const Eigen::ArrayXd deviation = deviations(samples);
  const auto share = [&](double limit) { return (deviation > limit).cast<double>().mean(); };
  const double limit = share(gross) < few_errors ? gross_alone : gross;
  if (share(limit) == 0 || share(limit) > most_errors || keep_company<Dim>(samples, deviation > limit)) return none;
  IsError is_error = deviation > limit && !find_peaks<Dim>(samples, deviation > gross);
  if (is_error.any()) add_marks(samples.values, is_error);
  return is_error;
}

constexpr std::string_view before_numbers = " (number ";  // of named samples in a warning

// Which of so many samples, and what they are.
std::string named(const std::vector<Index>& rows, Index samples, const std::string& what) {
  constexpr std::size_t most_named = 10;
  std::string names;
  for (std::size_t k = 0; k < std::min(most_named, rows.size()); ++k)
    names += (k > 0 ? ", " : "") + std::to_string(rows[k] + 1);
  return std::to_string(rows.size()) + " of " + std::to_string(samples) + " samples " + what +
         std::string(before_numbers) + names + (rows.size() > most_named ? ", ..." : "") + "); ";
}

}  // namespace

template <int Dim>
RobustWeights robust_weights(const Samples<Dim>& samples, const std::string& loss) {
  const Index n = samples.size();
  RobustWeights result;
  if (loss == "squares") return result;
  if (loss == "auto") {
    const IsError is_sure = contradicted(samples), is_off = far_off(samples);
    const bool few = n < least_dense * local_neighbors<Dim>;
    for (Index i = 0; i < n; ++i)
      if (few && is_off[i] && !is_sure[i]) result.suspects.push_back(i);
    const IsError is_error = few ? is_sure : IsError(is_sure || is_off);
    if (!is_error.any()) return result;
    result.factors = (!is_error).template cast<double>();
  } else {
    const Eigen::ArrayXd deviation = deviations(samples);
    if (loss == "huber")
      result.factors = huber / deviation.max(huber);
    else
      result.factors = (student_degrees + 1) / (student_degrees + deviation.max(1.0).square());
  }
  for (Index i = 0; i < n; ++i)
    if (result.factors[i] < .5) result.gross_errors.push_back(i);
  return result;
}

std::string warning_of_gross_errors(const std::vector<Index>& rows, Index samples) {
  return named(rows, samples, "are far from what those around them say, and left out") + "loss squares keeps them";
}

std::string warning_of_suspects(const std::vector<Index>& rows, Index samples) {
  return named(rows, samples, "are far from what those around them say, but not from what all others do: kept") +
         "loss huber gives them less weight";
}

std::string warning_of_far_points(const std::vector<Index>& rows, Index samples) {
  return named(rows, samples, "have a coordinate far from those of all others") +
         "if it is wrong, correct it or leave them out";
}

void number_rows(const std::vector<Index>& rows, FitReport& report) {
  for (std::vector<Index>* const found : {&report.gross_errors, &report.suspects})
    for (Index& sample : *found) sample = rows[static_cast<std::size_t>(sample)];
  for (std::string& warning : report.warnings) {
    const std::size_t begin = warning.find(before_numbers);
    if (begin == std::string::npos) continue;
    const std::size_t first = begin + before_numbers.size(), end = warning.find(')', first);
    std::string numbers;
    std::size_t sample = 0;  // from 1; 0: no digit yet
    for (std::size_t i = first; i <= end; ++i) {
      if (warning[i] >= '0' && warning[i] <= '9') {
        sample = 10 * sample + static_cast<std::size_t>(warning[i] - '0');
        continue;
      }
      if (sample > 0) numbers += std::to_string(rows[sample - 1] + 1);
      sample = 0;
      if (i < end) numbers += warning[i];
    }
    warning.replace(first, end - first, numbers);
  }
}

#define CSRBF_INSTANTIATE(Dim) template RobustWeights robust_weights<Dim>(const Samples<Dim>&, const std::string&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
