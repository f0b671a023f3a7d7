#include "csrbf/surface/contours/slice_signs.hpp"

#include "csrbf/core/parallel.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double parallel = 0.996;        // cosine of 5 degrees: slices of one stack
constexpr double end_tolerance = 0.05;    // spacings: contours farther beyond an end than this close it themselves
constexpr Index grid = 32;                // points along the longest side of the contours of a stack; more: slower
constexpr double margin = 0.1;            // of that side, added on either side
constexpr double sign_clearance = 1;      // grid steps from contours: closer signs depend on the contours' own accuracy
constexpr double separation = 2;          // grid steps between samples
constexpr std::size_t max_samples = 100;  // of a slice and call: each adds an equation to a dense system
constexpr double share = 0.5;  // of the depth within the slice, and of the spacing: the depth in space is smaller

using Stack = std::vector<Index>;

// Slices with about the same normal, by height along that of the first.
std::vector<Stack> stacks_of(const std::vector<Slice>& slices) {
  std::vector<Stack> stacks;
  for (Index s = 0; s < std::ssize(slices); ++s) {
    const auto found = std::find_if(stacks.begin(), stacks.end(), [&](const Stack& stack) {
      return std::abs(slices[stack.front()].normal().dot(slices[s].normal())) > parallel;
    });
    (found == stacks.end() ? stacks.emplace_back() : *found).push_back(s);
  }
  for (Stack& stack : stacks) {
    const Slice& first = slices[stack.front()];
    std::sort(stack.begin(), stack.end(),
              [&](Index a, Index b) { return first.height(slices[a].origin()) < first.height(slices[b].origin()); });
  }
  return stacks;
}

// Box of all contours of a stack, in the plane of one of its slices.
Box<2> box_of(const std::vector<Slice>& slices, const Stack& stack, const Slice& seen_from) {
  Box<2> box;
  for (const Index s : stack)
    for (const Points<3>& loop : slices[s].loops())
      for (Index i = 0; i < loop.cols(); ++i) box.add(seen_from.to_plane(loop.col(i)));
  return box;
}

bool nothing_beyond(const Points<3>& points, const Slice& slice, double shift) {
  const Eigen::VectorXd heights = (slice.normal().transpose() * (points.colwise() - slice.origin())).transpose();
  return (shift > 0 ? heights.maxCoeff() : -heights.minCoeff()) < end_tolerance * std::abs(shift);
}

void add_stack(const Points<3>& points, const std::vector<Slice>& slices, const Stack& stack, SliceStacks& result) {
  const std::size_t last = stack.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    const Slice& slice = slices[stack[k]];
    StackedSlice stacked{stack[k], 0, box_of(slices, stack, slice)};
    stacked.spacing = stacked.box.diagonal();
    const auto height = [&](std::size_t other) { return slice.height(slices[stack[other]].origin()); };
    if (last > 0) {
      const double to_first = height(k > 0 ? k - 1 : 1), to_second = height(k < last ? k + 1 : last - 1);
      stacked.spacing = std::min(std::abs(to_first), std::abs(to_second));
      if ((k == 0 || k == last) && nothing_beyond(points, slice, -to_first)) stacked.beyond = -to_first;
      result.largest_spacing = std::max({result.largest_spacing, std::abs(to_first), std::abs(to_second)});
    }
    result.slices.push_back(std::move(stacked));
  }
}

// Points of the plane of a slice: a grid over the contours of the stack and a margin.
Points<2> places_of(const StackedSlice& stacked) {
  const double side = stacked.box.extent().maxCoeff(), step = side / static_cast<double>(grid);
  const Box<2> box = stacked.box.inflated(margin * side);
  const Index columns = 1 + static_cast<Index>(box.extent().x() / step),
              rows = 1 + static_cast<Index>(box.extent().y() / step);
  Points<2> places(2, columns * rows);
  for (Index i = 0; i < places.cols(); ++i)
    places.col(i) = box.lo + step * Point<2>(static_cast<double>(i % columns), static_cast<double>(i / columns));
  return places;
}

// Well spread points away from the contours where the sign is wrong, with about half the signed distance.
SignSamples wrong_signs(const Field<3>& field, const StackedSlice& stacked, const Slice& slice) {
  const double step = stacked.box.extent().maxCoeff() / static_cast<double>(grid), most = share * stacked.spacing;
  const Points<2> places = places_of(stacked);
  SignSamples wrong;
  for (const auto& q : places.colwise()) {
    if (wrong.places.size() >= max_samples) break;
    const Point<3> p = slice.to_space(q);
    const double depth = slice.depth(q);
    if (std::abs(depth) < sign_clearance * step || field(p) * depth > 0) continue;
    const auto near = [&](const Point<3>& other) { return (p - other).norm() < 0.99 * separation * step; };
    if (std::any_of(wrong.places.begin(), wrong.places.end(), near)) continue;
    wrong.places.push_back(p);
    wrong.values.push_back(std::clamp(share * depth, -most, most));
  }
  return wrong;
}

std::optional<Cap> find_cap(const Field<3>& field, const StackedSlice& stacked, const Slice& slice) {
  const Points<2> places = places_of(stacked);
  Index drawn = 0, open = 0;
  for (const auto& q : places.colwise()) {
    if (slice.depth(q) > 0) ++drawn;
    if (field(slice.to_space(q) + stacked.beyond * slice.normal()) > 0) ++open;
  }
  if (open == 0) return std::nullopt;
  const double kept = std::min(1.0, static_cast<double>(open) / static_cast<double>(std::max<Index>(drawn, 1)));
  const double height = stacked.beyond * (1 - 0.5 * kept);
  const Point<2> middle = slice.box().center();
  return Cap{slice.to_space(middle) + height * slice.normal(), std::copysign(1.0, height) * slice.normal(),
             std::abs(height)};
}

}  // namespace

SliceStacks find_stacks(const Points<3>& points, const Slices& slices) {
  const std::vector<Stack> stacks = stacks_of(slices.slices);
  SliceStacks result;
  for (const Stack& stack : stacks) add_stack(points, slices.slices, stack, result);
  if (stacks.size() == 1) result.common_normal = slices.slices.front().normal();
  return result;
}

bool add_wrong_signs(const Field<3>& field, const Slices& slices, const SliceStacks& stacks, SignSamples& samples) {
  std::vector<SignSamples> wrong(stacks.slices.size());
  parallel_for(std::ssize(wrong), 1, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      wrong[i] = wrong_signs(field, stacks.slices[i], slices.slices[stacks.slices[i].slice]);
  });
  bool any = false;
  for (const SignSamples& more : wrong) {
    any = any || !more.places.empty();
    samples.places.insert(samples.places.end(), more.places.begin(), more.places.end());
    samples.values.insert(samples.values.end(), more.values.begin(), more.values.end());
  }
  return any;
}

std::vector<Cap> find_caps(const Field<3>& field, const Slices& slices, const SliceStacks& stacks) {
  std::vector<Cap> caps;
  for (const StackedSlice& stacked : stacks.slices) {
    if (stacked.beyond == 0) continue;
    if (const std::optional<Cap> cap = find_cap(field, stacked, slices.slices[stacked.slice])) caps.push_back(*cap);
  }
  return caps;
}

}  // namespace csrbf
