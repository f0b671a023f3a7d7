#include "csrbf/surface/composite/crop_field.hpp"

namespace csrbf {
namespace {

constexpr Index merged_samples = 16;  // far samples of the winding number that become one; chosen by hand

// A box in the unit coordinates of a field.
Box<3> to_unit(const Box<3>& box, const CompositeField::Data& data) {
  return {(box.lo - data.origin) / data.scale, (box.hi - data.origin) / data.scale};
}

bool encloses(const Box<3>& outer, const Box<3>& inner) {
  return outer.contains(inner.lo) && outer.contains(inner.hi);
}

// Of the ball around a patch.
Box<3> ball_box(const Patch& patch) {
  Box<3> box;
  box.add(patch.center);
  return box.inflated(patch.radius);
}

Patches crop(const Patches& patches, const Box<3>& box, const std::optional<Box<3>>& hole) {
  Patches kept;
  bool keeps = false;
  for (Index i = 0; i < patches.pieces(); ++i) {
    const Patch& patch = patches.patch(i);
    if (patch.join == Join::first) {
      const Box<3> support = ball_box(patch);
      keeps = box.intersects(support) && !(hole && encloses(*hole, support));
    }
    if (!keeps) continue;
    const Index begin = patches.center_begin()[i], count = patches.center_begin()[i + 1] - begin;
    const Eigen::Map<const Points<3>> centers(patches.center_coordinates().data() + 3 * begin, 3, count);
    kept.add(patch, centers, Eigen::Map<const Eigen::VectorXd>(patches.alpha().data() + begin, count));
  }
  kept.build();
  return kept;
}

// Samples that stand for the groups of those in the box; the others as they are.
WindingNumber::Data merge(const WindingNumber::Data& all, const Box<3>& far) {
  WindingNumber::Data out;
  const Index n = all.points.cols();
  out.points.resize(3, n);
  out.normals.resize(3, n);
  out.areas.resize(n);
  out.eps.resize(n);
  Index used = 0;
  for (Index begin = 0, end = 0; begin < n; begin = end) {
    end = begin + 1;
    while (end < n && end - begin < merged_samples && far.contains(all.points.col(begin)) &&
           far.contains(all.points.col(end)))
      ++end;
    Point<3> vector = Point<3>::Zero(), center = Point<3>::Zero();
    double weight = 0, eps2 = 0;
    for (Index i = begin; i < end; ++i) {
      vector += all.areas[i] * all.normals.col(i);
      center += all.areas[i] * all.points.col(i);
      weight += all.areas[i];
      eps2 += all.eps[i] * all.eps[i];
    }
    const double area = vector.norm();
    if (end - begin > 1 && !(area > 0)) continue;
    const bool alone = end - begin == 1;
    out.points.col(used) = alone ? Point<3>(all.points.col(begin)) : Point<3>(center / weight);
    out.normals.col(used) = alone ? Point<3>(all.normals.col(begin)) : Point<3>(vector / area);
    out.areas[used] = alone ? all.areas[begin] : area;
    out.eps[used++] = std::sqrt(eps2);
  }
  out.points.conservativeResize(3, used);
  out.normals.conservativeResize(3, used);
  out.areas.conservativeResize(used);
  out.eps.conservativeResize(used);
  return out;
}

}  // namespace

CompositeField crop(const CompositeField& field, const CropRegion& region, double reach) {
  const CompositeField::Data& from = field.data();
  const Box<3> box = to_unit(region.box, from);
  std::optional<Box<3>> hole;
  if (region.hole) hole = to_unit(*region.hole, from);
  CompositeField::Data data;
  data.origin = from.origin;
  data.scale = from.scale;
  for (const Patches& level : from.levels) data.levels.push_back(crop(level, box, hole));
  data.winding = from.winding;
  if (region.hole) {
    const Box<3> far = to_unit(region.hole->inflated(-reach), from);
    if (!far.empty()) data.winding = WindingNumber(merge(from.winding.data(), far));
  }
  data.winding_level = from.winding_level;
  data.far_value = from.far_value;
  data.feature_size = from.feature_size;
  data.noisy = from.noisy;
  data.bounds = from.bounds;
  return CompositeField(std::move(data));
}

}  // namespace csrbf
