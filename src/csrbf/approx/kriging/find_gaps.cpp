#include "csrbf/approx/kriging/find_gaps.hpp"

#include "csrbf/approx/kriging/spread_point.hpp"
#include "csrbf/core/parallel.hpp"

#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr double noticeable = 1e-4;   // deviations of the values; in a gap kriging is hardly ever better
constexpr double far = 100;           // distances of samples
constexpr double by_chance = 1e-2;    // probability that a fit without gaps has one
constexpr Index fewest_counted = 64;  // of these, where a patch has fewer than a gap takes
constexpr Index counted = 8;          // samples that tell how dense they are, for each unknown of least squares

}  // namespace

template <int Dim>
Points<Dim> probes(const Box<Dim>& box) {
  Points<Dim> x(Dim, probes_each<Dim>);
  for (Index k = 0; k < x.cols(); ++k)
    for (Index a = 0, rest = k; a < Dim; ++a, rest /= 3)
      x(a, k) = box.lo[a] + 0.5 * static_cast<double>(rest % 3) * (box.hi[a] - box.lo[a]);
  return x;
}

template <int Dim>
Box<Dim> support_of(const Cover<Dim>& cover, const Box<Dim>& cell) {
  const Point<Dim> center = cell.center(), half = 0.5 * cover.growth() * cell.extent();
  return {(center - half).cwiseMax(cover.box().lo), (center + half).cwiseMin(cover.box().hi)};
}

template <int Dim>
Eigen::VectorXd noticeable_error(const Samples<Dim>& samples) {
  const Eigen::RowVectorXd mean = samples.values.colwise().mean();
  return noticeable * noticeable * (samples.values.rowwise() - mean).cwiseAbs2().colwise().mean().transpose();
}

// Samples lie on one side of the faces of the box only: a ball about a point there must be larger to hold as many.
template <int Dim>
double GapFinder<Dim>::inside_factor(const Point<Dim>& x) const {
  constexpr double at_face = 1e-6;  // of the extent of the box, far above its margin
  const Box<Dim>& box = cover_.box();
  const Point<Dim> distance = (x - box.lo).cwiseMin(box.hi - x).cwiseQuotient(box.extent());
  return std::pow(2.0, static_cast<double>((distance.array() < at_face).count()) / Dim);
}

// For so many places, a ball that is empty by chance at none of them, over one that is a gap at a few: in radii.
// Samples come as a Poisson process, and their density is known by `samples` of them. What a function of much fewer
// unknowns than samples loses in such a ball is nothing.
template <int Dim>
double GapFinder<Dim>::chance_factor(Index samples) const {
  if (patches_.interpolates()) return 1;
  const double rare = std::log(static_cast<double>(cover_.size() * probes_each<Dim>) / by_chance);
  const double expected = rare + 0.5 * rare * rare / static_cast<double>(samples);
  return std::max(1.0, std::pow(expected / patches_.expected(), 1.0 / Dim));
}

// Radius of a ball with as many samples as a local function has unknowns, as dense as those of a cell.
template <int Dim>
double GapFinder<Dim>::usual_radius(const Box<Dim>& cell, Index count) const {
  const double volume = cell.extent().prod() * static_cast<double>(patches_.unknowns()) / static_cast<double>(count);
  return std::pow(volume / unit_ball_volume<Dim>, 1.0 / Dim);
}

// Whether every point of a list has one of the samples [begin, end) within `reach`.
template <int Dim>
bool GapFinder<Dim>::all_near(const Points<Dim>& x, double reach, Index begin, Index end) const {
  const auto samples = cover_.points().middleCols(begin, end - begin);
  for (Index k = 0; k < x.cols(); ++k) {
    bool near = false;
    for (Index i = 0; i < samples.cols() && !near; ++i)
      near = (samples.col(i) - x.col(k)).squaredNorm() <= reach * reach;
    if (!near) return false;
  }
  return true;
}

template <int Dim>
std::vector<Index> GapFinder<Dim>::cells_with_gaps() const {
  std::vector<char> has_gap(static_cast<std::size_t>(cover_.size()), 0);
  std::vector<Index> end_of(has_gap.size() + 1, 0);  // samples up to each cell
  const Index unknowns = patches_.unknowns();
  Index near = patches_.interpolates() ? unknowns : std::min(fit_.report.local.samples, counted * unknowns);
  if (patches_.gap() >= 1) near = std::min(cover_.points().cols(), std::max(near, fewest_counted));
  const double share = std::pow(static_cast<double>(unknowns) / static_cast<double>(near), 1.0 / Dim);
  const double gap = patches_.gap() * chance_factor(near);
  for (Index i = 0; i < cover_.size(); ++i) end_of[i + 1] = end_of[i] + cover_.count(i);
  const bool are_large = Dim > 1 && patches_.gap() < 1;  // patches: also where cells hold few samples they tell
  parallel_for(cover_.size(), 256, [&](Index first, Index last) {
    typename Cover<Dim>::Search search;
    for (Index i = first; i < last; ++i) {
      const Box<Dim>& cell = cover_.cell(i);
      const Index count = end_of[i + 1] - end_of[i];
      const double radius = std::min(fit_.data->models.radius[i], usual_radius(cell, count));
      const Points<Dim> x = probes(cell);
      const bool is_full = 2 * count * cover_.size() >= cover_.points().cols();
      if ((is_full || are_large) && all_near(x, gap * radius, end_of[i], end_of[i + 1])) continue;
      cover_.nearest(cell.center(), near, radius / share, search);
      const double reach = gap * share * patches_.usual_reach(near, search);
      for (Index k = 0; k < x.cols() && has_gap[i] == 0; ++k)
        if (!cover_.any_within(x.col(k), reach * inside_factor(x.col(k)))) has_gap[i] = 1;
    }
  });
  std::vector<char> reaches_gap = has_gap;
  for (Index i = 0; i < cover_.size(); ++i)
    if (has_gap[i] != 0)
      for (const std::uint32_t support : cover_.supports_over(i)) reaches_gap[support] = 1;
  std::vector<Index> cells;
  for (Index i = 0; i < cover_.size(); ++i)
    if (reaches_gap[i] != 0) cells.push_back(i);
  return cells;
}

template <int Dim>
std::vector<Index> GapFinder<Dim>::doubtful(const std::vector<Index>& cells, const Samples<Dim>& samples,
                                            const Eigen::MatrixXd& errors) const {
  Eigen::VectorXd least = noticeable_error(samples);
  const double infinity = std::numeric_limits<double>::infinity();
  least = (least.array() > 0).select(least, infinity);  // of a constant nothing is noticeable
  if (!(least.minCoeff() < infinity)) return {};
  std::vector<char> is_doubtful(cells.size(), 0);
  parallel_for(std::ssize(cells), 16, [&](Index first, Index last) {
    typename PatchErrors<Dim>::Patch work;
    for (Index i = first; i < last; ++i) {
      const Index cell = cells[static_cast<std::size_t>(i)];
      patches_.enter(cell, errors.col(cell), work);
      const Points<Dim> x = probes(support_of(cover_, cover_.cell(cell)));
      const double spacing = std::max(patches_.spacing_at(cover_.cell(cell).center(), work), 1e-300);
      Eigen::VectorXd distance(x.cols());
      for (Index k = 0; k < x.cols() && is_doubtful[i] == 0; ++k) {
        distance[k] = patches_.nearest(x.col(k), patches_.gap() * work.radius, work.search);
        const bool is_void = distance[k] > far * spacing;  // where no error at samples tells any
        if (is_void || (patches_.least_error(distance[k], spacing, work).array() > least.array()).any())
          is_doubtful[i] = 1;
      }
      if (is_doubtful[i] != 0) continue;
      patches_.prepare(work);
      for (Index k = 0; k < x.cols() && is_doubtful[i] == 0; ++k)
        if ((patches_.error(x.col(k), distance[k], spacing, work).array() > least.array()).any()) is_doubtful[i] = 1;
    }
  });
  std::vector<Index> chosen;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (is_doubtful[i] != 0) chosen.push_back(cells[i]);
  return chosen;
}

template <int Dim>
Points<Dim> GapFinder<Dim>::points_in_gaps(const std::vector<Index>& cells, const Eigen::MatrixXd& errors) const {
  constexpr Index count = 1000;  // in all, about; chosen by hand
  double volume = 0, reached = 0.5;
  for (const Index cell : cells) volume += cover_.cell(cell).extent().prod();
  std::vector<Point<Dim>> found;
  typename PatchErrors<Dim>::Patch work;
  Index taken = 0;
  for (const Index cell : cells) {
    const Box<Dim>& box = cover_.cell(cell);
    reached += volume > 0 ? count * box.extent().prod() / volume : 0;
    if (static_cast<double>(taken + 1) > reached) continue;
    patches_.enter(cell, errors.col(cell), work);
    for (; static_cast<double>(taken + 1) <= reached; ++taken) {
      const Point<Dim> x = box.lo + spread_point<Dim>(taken).cwiseProduct(box.extent());
      if (patches_.nearest(x, work.radius, work.search) > patches_.spacing_at(x, work)) found.push_back(x);
    }
  }
  Points<Dim> result(Dim, std::ssize(found));
  for (Index k = 0; k < result.cols(); ++k) result.col(k) = found[static_cast<std::size_t>(k)];
  return result;
}

#define CSRBF_INSTANTIATE(Dim)                                         \
  template Eigen::VectorXd noticeable_error<Dim>(const Samples<Dim>&); \
  template class GapFinder<Dim>;                                       \
  template Points<Dim> probes<Dim>(const Box<Dim>&);                   \
  template Box<Dim> support_of<Dim>(const Cover<Dim>&, const Box<Dim>&);
CSRBF_INSTANTIATE(1)
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
