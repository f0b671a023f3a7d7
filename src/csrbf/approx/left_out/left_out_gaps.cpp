#include "csrbf/approx/left_out/left_out_gaps.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/spatial/even_pairs.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr Index most_seen = 3000;  // samples, before those in the gaps are left out
constexpr Index most_moved = 2;    // places of the gaps
constexpr int tried_moves = 60;
constexpr double longest_move = 0.7;                       // of the extent of the samples
constexpr double least_share = 0.08, largest_share = 0.4;  // of the samples, in gaps
constexpr Index most_in_gaps = 300;                        // samples predicted at a place
constexpr double in_gap = 0.5;                             // of what is 0 in gaps
constexpr double least_variance = 1e-300;

// Samples that gaps moved by `move` are over.
template <int Dim>
std::vector<char> covered(const Points<Dim>& points, const Field<Dim>& outside_gaps, const Box<Dim>& box,
                          const Point<Dim>& move) {
  const Points<Dim> before = points.colwise() - move;
  const Eigen::VectorXd outside = outside_gaps.evaluate(before).value;
  std::vector<char> result(static_cast<std::size_t>(points.cols()), 0);
  for (Index i = 0; i < points.cols(); ++i) {
    const Point<Dim> x = before.col(i);
    const bool inside = (x.array() >= box.lo.array()).all() && (x.array() <= box.hi.array()).all();
    result[static_cast<std::size_t>(i)] = inside && outside[i] < in_gap ? 1 : 0;
  }
  return result;
}

// The gaps moved, and which samples they cover then.
struct MovedGap {
  Eigen::VectorXd move;
  std::vector<char> covered;
  double share = 0;
};

// Those that cover most, and mostly others.
std::vector<MovedGap> largest_apart(std::vector<MovedGap> places) {
  std::stable_sort(places.begin(), places.end(),
                   [](const MovedGap& a, const MovedGap& b) { return a.share > b.share; });
  std::vector<MovedGap> chosen;
  for (MovedGap& place : places) {
    const auto is_like = [&](const MovedGap& other) {
      Index both = 0, any = 0;
      for (std::size_t i = 0; i < place.covered.size(); ++i) {
        both += place.covered[i] != 0 && other.covered[i] != 0 ? 1 : 0;
        any += place.covered[i] != 0 || other.covered[i] != 0 ? 1 : 0;
      }
      return 2 * both > any;
    };
    if (std::ssize(chosen) < most_moved && std::none_of(chosen.begin(), chosen.end(), is_like))
      chosen.push_back(std::move(place));
  }
  return chosen;
}

}  // namespace

double LeftOutErrors::growth(Index component) const {
  constexpr double share = 0.95, interval = 1.96;
  double largest = 0;
  for (std::size_t p = 0; p < places.size(); ++p) {
    const Index end = p + 1 < places.size() ? places[p + 1] : errors.rows();
    std::vector<double> z2;
    for (Index k = places[p]; k < end; ++k)
      z2.push_back(std::pow(errors(k, component), 2) / std::max(variances(k, component), least_variance));
    largest = std::max(largest, percentile(z2, share) / (interval * interval));
  }
  return largest;
}

template <int Dim>
std::vector<LeftOutErrors> left_out_gaps(
    const Samples<Dim>& samples, const Field<Dim>& outside_gaps,
    const std::vector<std::function<FittedParts<Dim>(const Samples<Dim>&)>>& fits) {
  const Samples<Dim> seen = chosen_samples(samples, even_samples(morton_order<Dim>(samples.points), most_seen));
  const Box<Dim> box = bounding_box<Dim>(samples.points);
  std::vector<MovedGap> places;
  std::mt19937_64 random(1);  // its sequence is fixed by the standard
  const auto uniform = [&] { return std::ldexp(static_cast<double>(random()), -64); };
  for (int k = 0; k < tried_moves; ++k) {
    MovedGap place;
    place.move.resize(Dim);
    for (Index a = 0; a < Dim; ++a) place.move[a] = longest_move * (2 * uniform() - 1) * box.extent()[a];
    place.covered = covered<Dim>(seen.points, outside_gaps, box, place.move);
    place.share = static_cast<double>(std::count(place.covered.begin(), place.covered.end(), 1)) /
                  static_cast<double>(seen.size());
    if (place.share >= least_share && place.share <= largest_share) places.push_back(std::move(place));
  }
  const std::vector<MovedGap> chosen = largest_apart(std::move(places));
  std::vector<LeftOutErrors> results;
  const Index C = samples.components();
  for (const MovedGap& place : chosen) {
    std::vector<Index> in, out;
    for (Index i = 0; i < seen.size(); ++i) (place.covered[static_cast<std::size_t>(i)] != 0 ? in : out).push_back(i);
    const Samples<Dim> there = chosen_samples(seen, even_samples(in, most_in_gaps));
    const Samples<Dim> others = chosen_samples(seen, out);
    std::vector<LeftOutErrors> here;
    try {
      for (const auto& fit : fits) {
        const FittedParts<Dim> fitted = fit(others);
        if (std::ssize(fitted.variances) < C) return {};
        LeftOutErrors& errors = here.emplace_back();
        errors.errors.resize(there.size(), C);
        errors.variances.resize(there.size(), C);
        for (Index c = 0; c < C; ++c) {
          const auto k = static_cast<std::size_t>(c);
          errors.errors.col(c) = there.values.col(c) - fitted.components[k]->evaluate(there.points).value;
          errors.variances.col(c) = fitted.variances[k]->evaluate(there.points).value;
        }
      }
    } catch (const SolverFailure&) {
      continue;
    }
    if (results.empty()) results.resize(fits.size());
    for (std::size_t k = 0; k < fits.size(); ++k) {
      const auto append = [&](Eigen::MatrixXd& all, const Eigen::MatrixXd& more) {
        all.conservativeResize(all.rows() + more.rows(), C);
        all.bottomRows(more.rows()) = more;
      };
      results[k].places.push_back(results[k].errors.rows());
      append(results[k].errors, here[k].errors);
      append(results[k].variances, here[k].variances);
    }
  }
  return results;
}

#define CSRBF_INSTANTIATE(Dim)                            \
  template std::vector<LeftOutErrors> left_out_gaps<Dim>( \
      const Samples<Dim>&, const Field<Dim>&,             \
      const std::vector<std::function<FittedParts<Dim>(const Samples<Dim>&)>>&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
