#include "csrbf/surface/composite/patch_fitter.hpp"

#include "csrbf/surface/composite/join_pieces.hpp"
#include "csrbf/surface/composite/split_samples.hpp"

#include <Eigen/Geometry>

#include <numbers>

namespace csrbf {
namespace {

// Chosen by hand unless noted.
constexpr Index fewest_fit_points = 8;          // with their normals 32 conditions for the 10 coefficients of a quadric
constexpr Index fewest_on_piece = 5;            // samples; fewer do not tell a sheet from stray normals
constexpr double crease_residual = 0.4;         // |grad f + n| of a smooth model above which a patch may have a crease
constexpr double inner_weight_variable = 0.65;  // d^2 below which the blending weight (1 - d^2)^4 exceeds 1/64
constexpr double opposite_normals = -0.5;       // cosine of 120 degrees: noise rarely turns normals that far
constexpr double own_weight = 1;                // approximate sum of the weights of a sample's own patches
constexpr double smallest_freedom = 0.01;  // floor of 1 - leverage, for a sample that determines its own prediction
constexpr double growth = 1.25;            // of a support with too few samples: often ...
constexpr int few_growths = 2;             // ... until they are as many as the coefficients need, ...
constexpr int most_growths = 12;           // ... or determine a plane
constexpr double density_jump = 8;         // ratio of squared spacings: chance and creases vary them by up to 4
constexpr double least_height = 0.9;       // least normal semi-axis of a patch over its radius; 1 at most
constexpr double smallest_slope = 1e-3;    // floor of |grad f|, which is 1 for a model that follows its normals

// d^2, of which the blending weight is (1 - d^2)^4.
double weight_variable(const Patch& patch, const Point<3>& x) {
  Point<3> q = patch.T * (x - patch.center);
  q[2] *= patch.flatness;
  return q.squaredNorm();
}

// Samples in the local coordinates of a patch.
Points<3> local(const OrientedPoints& cloud, const std::vector<Index>& ids, const Patch& patch) {
  Points<3> q(3, std::ssize(ids));
  for (Index k = 0; k < q.cols(); ++k) q.col(k) = patch.T * (cloud.points.col(ids[k]) - patch.center);
  return q;
}

// Moves the group with most of the samples `leaf` to the front.
void leaf_first(std::vector<std::vector<Index>>& groups, std::span<const Index> leaf) {
  const auto shared = [&](const std::vector<Index>& group) {
    return std::count_if(leaf.begin(), leaf.end(),
                         [&](Index i) { return std::find(group.begin(), group.end(), i) != group.end(); });
  };
  const auto first = std::max_element(groups.begin(), groups.end(),
                                      [&](const auto& a, const auto& b) { return shared(a) < shared(b); });
  std::iter_swap(groups.begin(), first);
}

// Adds samples that are in no group to the first one, unless they are beyond a crease: noise turns normals too.
void add_stragglers(const OrientedPoints& cloud, const std::vector<Index>& samples,
                    std::vector<std::vector<Index>>& groups) {
  std::vector<Index> grouped;
  for (const std::vector<Index>& group : groups) grouped.insert(grouped.end(), group.begin(), group.end());
  std::sort(grouped.begin(), grouped.end());
  const Point<3> normal = cloud.normals(Eigen::all, groups.front()).rowwise().sum().normalized();
  for (const Index i : samples)
    if (!std::binary_search(grouped.begin(), grouped.end(), i) && cloud.normals.col(i).dot(normal) > compatible_normals)
      groups.front().push_back(i);
}

}  // namespace

Point<3> FittedPatch::step_to_surface(const Point<3>& x) const {
  const Patch& patch = frame();
  const Eigen::MatrixX3d q = (patch.T * (x - patch.center)).transpose();
  Eigen::RowVector4d f = pieces.front().evaluate(q);
  for (std::size_t p = 1; p < pieces.size(); ++p) {
    const Eigen::RowVector4d g = pieces[p].evaluate(q);
    if (pieces[p].patch.join == Join::intersection ? g[0] < f[0] : g[0] > f[0]) f = g;
  }
  const Point<3> slope = f.tail<3>().transpose();
  const double squared = std::max(slope.squaredNorm(), smallest_slope * smallest_slope);
  return (-f[0] * patch.radius * patch.radius / squared) * (patch.T.transpose() * slope);
}

FittedPatch PatchFitter::fit(const Index* ids, Index n) {
  gather(ids, n);
  return fit_samples(ids, n);
}

FittedPatch PatchFitter::fit(const Index* ids, Index n, PatchSamples& around) {
  samples_ = around;
  FittedPatch result = fit_samples(ids, n);
  if (!around.groups) around.groups = samples_.groups;
  return result;
}

PatchSamples PatchFitter::around(const Index* ids, Index n) {
  gather(ids, n);
  return samples_;
}

FittedPatch PatchFitter::fit_samples(const Index* ids, Index n) {
  FittedPatch result;
  FittedPiece& piece = result.pieces.front();
  piece.patch = samples_.frame;
  fitters_[0].fit(cloud_, samples_.support, options_, piece);
  groups_.assign(1, samples_.support);
  fitter_of_.assign(1, 0);
  main_ = 0;
  if (std::ssize(samples_.foreign) >= fewest_on_piece || fitters_[0].largest_normal_residual(piece) > crease_residual)
    split(ids, n, result);
  return result;
}

SampleAreas::SampleAreas(const OrientedPoints& cloud, const std::vector<Index>& samples, double area) {
  for (const Index i : samples) usual_ += cloud.spacing[i] * cloud.spacing[i] / static_cast<double>(samples.size());
  double shares = 0;
  for (const Index i : samples) shares += share(cloud.spacing[i]);
  unit_ = area / shares;
}

double SampleAreas::share(double spacing) const {
  const double own = spacing * spacing;
  return own > density_jump * usual_ || own * density_jump < usual_ ? own : usual_;
}

// Centre, axes and radius of the patch over the leaf `ids`.
void PatchFitter::frame(const Index* ids, Index n) {
  Patch& patch = samples_.frame;
  Point<3> center = Point<3>::Zero(), normal = Point<3>::Zero();
  double area = 0;
  for (Index i = 0; i < n; ++i) {
    center += cloud_.points.col(ids[i]);
    normal += cloud_.normals.col(ids[i]);
    area += cloud_.spacing[ids[i]] * cloud_.spacing[ids[i]];
  }
  patch.center = center / static_cast<double>(n);
  if (!(normal.norm() > 0)) normal = cloud_.normals.col(ids[0]);
  normal.normalize();
  double reach2 = 0;
  Point<3> farthest = Point<3>::Zero();
  for (Index i = 0; i < n; ++i) {
    const Point<3> d = cloud_.points.col(ids[i]) - patch.center;
    const Point<3> tangential = d - d.dot(normal) * normal;
    if (tangential.squaredNorm() >= farthest.squaredNorm()) farthest = tangential;
    reach2 = std::max(reach2, d.squaredNorm());
  }
  // Axes that turn with the cloud: the first towards the farthest point of the leaf.
  Point<3> first = farthest.norm() > 0 ? Point<3>(farthest.normalized()) : normal.unitOrthogonal();
  first = (first - first.dot(normal) * normal).normalized();
  patch.T.row(0) = first;
  patch.T.row(1) = normal.cross(first);
  patch.T.row(2) = normal;
  // At least 1.3 times the extent of the leaf, so that its own samples have weight.
  patch.radius = std::max(std::sqrt(options_.overlap * area / std::numbers::pi), 1.3 * std::sqrt(reach2));
}

// Points of the support with compatible normals. The support grows until there are enough of them, a little if they
// determine a plane (larger ones reach past small faces and spoil their neighbours), else up to 15-fold.
void PatchFitter::gather(const Index* ids, Index n) {
  frame(ids, n);
  auto& [patch, support, foreign, stride, lonely, areas, groups] = samples_;
  groups.reset();
  lonely = false;
  const Point<3> normal = patch.T.row(2).transpose();
  const Index wanted = std::min<Index>(fewest_fit_points, cloud_.size());
  for (int growths = 0; growths < most_growths; ++growths) {
    lonely = growths > few_growths;
    tree_.within(patch.center, patch.radius, support);
    const auto same_sheet = [&](Index i) { return cloud_.normals.col(i).dot(normal) > compatible_normals; };
    const auto first_foreign = std::stable_partition(support.begin(), support.end(), same_sheet);
    foreign.assign(first_foreign, support.end());
    support.erase(first_foreign, support.end());
    if (static_cast<Index>(support.size()) >= (growths < few_growths ? wanted : CompositeOptions::smallest_leaf)) break;
    patch.radius *= growth;
  }
  if (support.empty()) support.assign(ids, ids + n);
  areas = SampleAreas(cloud_, support, std::numbers::pi * patch.radius * patch.radius);
  double height = 0;
  for (const Index i : support) height = std::max(height, std::abs(normal.dot(cloud_.points.col(i) - patch.center)));
  patch.flatness = 1.0 / std::clamp(1.5 * height / patch.radius, least_height, 1.0);
  patch.T /= patch.radius;
  thin();
}

// Every stride-th point, and all candidates for centres.
void PatchFitter::thin() {
  std::vector<Index>& support = samples_.support;
  const auto count = static_cast<Index>(support.size());
  samples_.stride = std::max<Index>(1, (count + options_.max_fit_points - 1) / options_.max_fit_points);
  if (samples_.stride == 1) return;
  std::size_t kept = 0;
  for (Index k = 0; k < count; ++k) {
    const Index i = support[k];
    if (k % samples_.stride == 0 || std::binary_search(options_.centers.begin(), options_.centers.end(), i))
      support[kept++] = i;
  }
  support.resize(kept);
}

// The samples of the patch on smooth pieces, that of the leaf first.
std::vector<std::vector<Index>> PatchFitter::smooth_groups(std::span<const Index> leaf) const {
  const auto& [frame, support, foreign, stride, lonely, areas, known] = samples_;
  std::vector<Index> all = support;
  for (Index k = 0; k < std::ssize(foreign); k += stride) all.push_back(foreign[k]);
  const double stretch = std::sqrt(static_cast<double>(stride));
  std::vector<std::vector<Index>> groups =
      split_samples(cloud_, all, frame.T.row(2).normalized(), stretch, fewest_on_piece);
  if (groups.size() < 2) return groups;
  leaf_first(groups, leaf);
  add_stragglers(cloud_, support, groups);
  std::stable_sort(groups.begin() + 1, groups.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  groups.resize(std::min(groups.size(), most_pieces));
  return groups;
}

// Samples of other sheets, or beyond a crease, get a piece of their own, if the pieces agree on a solid.
void PatchFitter::split(const Index* ids, Index n, FittedPatch& patch) {
  const Patch& frame = samples_.frame;
  if (!samples_.groups) samples_.groups = smooth_groups(std::span(ids, static_cast<std::size_t>(n)));
  const std::vector<std::vector<Index>>& groups = *samples_.groups;
  if (groups.size() < 2) return;

  std::vector<FittedPiece> pieces(groups.size());
  std::vector<Points<3>> samples(groups.size());
  fitters_.resize(std::max(fitters_.size(), groups.size() + 1));
  for (std::size_t p = 0; p < groups.size(); ++p) {
    samples[p] = local(cloud_, groups[p], frame);
    pieces[p].patch = frame;
    pieces[p].middle = samples[p].rowwise().mean();
    const Point<3> normal = cloud_.normals(Eigen::all, groups[p]).rowwise().sum();
    pieces[p].normal = (frame.T * normal).normalized();
    fitters_[p + 1].fit(cloud_, groups[p], options_, pieces[p]);
  }
  const std::vector<std::size_t> kept = join_pieces(pieces, samples);
  if (kept.size() < 2) return;
  patch.pieces = std::move(pieces);
  groups_.clear();
  fitter_of_.clear();
  main_ = static_cast<std::size_t>(std::find(kept.begin(), kept.end(), std::size_t{0}) - kept.begin());
  std::vector<Index> beside;  // samples of the sheet of the leaf, also beyond its creases
  for (std::size_t p = 0; p < kept.size(); ++p) {
    if (patch.pieces[p].normal.dot(patch.pieces[main_].normal) > opposite_normals)
      beside.insert(beside.end(), groups[kept[p]].begin(), groups[kept[p]].end());
    fitter_of_.push_back(kept[p] + 1);
    groups_.push_back(groups[kept[p]]);
  }
  samples_.areas = SampleAreas(cloud_, beside,
                               std::numbers::pi * frame.radius * frame.radius / static_cast<double>(samples_.stride));
  std::erase_if(samples_.foreign, [&](Index i) {
    return std::any_of(groups_.begin(), groups_.end(), [&](const std::vector<Index>& group) {
      return std::find(group.begin(), group.end(), i) != group.end();
    });
  });
}

// Samples of another sheet count too: there the distance of the patch is an error of the blend.
bool PatchFitter::within_tolerance(const FittedPatch& patch) const {
  const auto meets = [&](Index i) {
    return weight_variable(patch.frame(), cloud_.points.col(i)) >= inner_weight_variable ||
           patch.step_to_surface(cloud_.points.col(i)).norm() <= options_.tolerance[i];
  };
  return std::all_of(samples_.support.begin(), samples_.support.end(), meets) &&
         std::all_of(samples_.foreign.begin(), samples_.foreign.end(), meets);
}

double PatchFitter::error_on_other_sheets(const FittedPatch& patch) const {
  const Point<3> normal = patch.frame().T.row(2).normalized();
  double sum = 0;
  for (const Index i : samples_.foreign) {
    if (cloud_.normals.col(i).dot(normal) > opposite_normals) continue;  // possibly the same sheet under noise
    const double weight = std::pow(std::max(0.0, 1 - weight_variable(patch.frame(), cloud_.points.col(i))), 4);
    const double distance = std::min(patch.step_to_surface(cloud_.points.col(i)).norm(), patch.frame().radius);
    sum += weight / (own_weight + weight) * distance;
  }
  return sum;
}

void PatchFitter::left_out_distances(const FittedPatch& patch, std::span<const Index> ids, double* distance) const {
  const Patch& frame = patch.frame();
  const Eigen::MatrixX3d q = local(cloud_, {ids.begin(), ids.end()}, frame).transpose();
  Eigen::Map<Eigen::VectorXd>(distance, q.rows()) = patch.pieces[main_].distances(q);
  for (std::size_t p = 0; p < patch.pieces.size(); ++p) {
    std::vector<Index> rows, columns;  // in the samples of the piece and in `ids`
    for (Index i = 0; i < q.rows(); ++i) {
      const auto found = std::find(groups_[p].begin(), groups_[p].end(), ids[i]);
      if (found == groups_[p].end()) continue;
      rows.push_back(found - groups_[p].begin());
      columns.push_back(i);
    }
    if (p != main_) {
      const Eigen::VectorXd own = patch.pieces[p].distances(q(columns, Eigen::all));
      for (Index i = 0; i < own.size(); ++i) distance[columns[i]] = own[i];
    }
    const Eigen::VectorXd leverage = fitters_[fitter_of_[p]].leverage(patch.pieces[p], rows);
    for (Index i = 0; i < leverage.size(); ++i) distance[columns[i]] /= std::max(1 - leverage[i], smallest_freedom);
  }
}

}  // namespace csrbf
