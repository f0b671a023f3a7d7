#include "csrbf/surface/prepare/find_normals.hpp"

#include "csrbf/core/percentile.hpp"
#include "csrbf/surface/estimate_normals.hpp"
#include "csrbf/surface/normals/contradictions.hpp"
#include "csrbf/surface/normals/given_normals.hpp"
#include "csrbf/surface/normals/inward_parts.hpp"
#include "csrbf/surface/normals/orient_normals.hpp"
#include "csrbf/surface/normals/plane_normals.hpp"
#include "csrbf/surface/normals/winding_sides.hpp"
#include "csrbf/surface/prepare/unfit_normals.hpp"

#include <sstream>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double usual_contradictions = 5e-4;     // share of opposite neighbouring normals that is not examined
constexpr Index examined = 50'000;                // points of a large cloud on which re-orientation is tried first
constexpr double clearly_better = 0.8;            // largest ratio of its error to that of the given normals
constexpr double little_energy = 0.1;             // of a solid: signs by neighbours need no others
constexpr double has_inside = 0.15;               // mean winding number below which there is no solid
constexpr double coarser = 4;                     // usual spacings: samples farther apart may miss what others show
constexpr Index fewest_told = 500;                // samples: fewer are sparse in places by chance
constexpr double large_share = 0.1;               // of the surface; both leave random and scanned clouds alone
constexpr Index few_turned = 10;                  // one in so many: of more, neighbours that are wrong, too, miss some
constexpr double remaining_contradictions = 0.2;  // share of contradictions left by a successful re-orientation at most

// Fills in missing normals: estimated, on the side of the nearest given ones, or of most if none is near. Only the
// latter need an orientation, which takes most of the time.
void fill_missing(const Points<3>& points, const KdTree<3>& all, const NeighborTable& near, Points<3>& normals,
                  const Progress& progress) {
  std::vector<Index> given, missing;
  for (Index i = 0; i < normals.cols(); ++i) (normals.col(i).squaredNorm() > 0 ? given : missing).push_back(i);
  const Points<3> known = points(Eigen::all, given);
  const KdTree<3> tree(known);
  constexpr Index none = -1;
  std::vector<Index> nearest;  // of every missing one
  for (const Index i : missing) {
    Index found = 0;
    double d2 = 0;
    tree.nearest(points.col(i), 1, &found, &d2);
    nearest.push_back(std::sqrt(d2) <= near.reach[i] ? given[found] : none);  // equal for the last neighbour
  }
  const bool oriented = std::find(nearest.begin(), nearest.end(), none) != nearest.end();
  const Points<3> estimated = estimate_normals(points, all, oriented ? Orient::consistent : Orient::none, progress);
  double agreement = 0;
  if (oriented)
    for (const Index i : given) agreement += estimated.col(i).dot(normals.col(i));
  for (std::size_t k = 0; k < missing.size(); ++k) {
    const auto n = estimated.col(missing[k]);
    const double side = nearest[k] == none ? agreement : n.dot(normals.col(nearest[k]));
    normals.col(missing[k]) = side < 0 ? Point<3>(-n) : Point<3>(n);
  }
}

// Share of the contradictions among normals that remains after orienting them; 1 if there were hardly any.
double remaining_after_orientation(const Points<3>& points, Points<3>& normals, const Progress& progress) {
  const double contradictions = 1 - orientation_consistency(points, normals);
  if (contradictions < usual_contradictions) return 1;
  orient_normals(points, normals, {.progress = progress});
  return (1 - orientation_consistency(points, normals)) / contradictions;
}

// How badly normals enclose a solid. Random signs hardly have defects, for their winding number is 0 nearly everywhere,
// but much energy; sheets close to each other have defects whatever their signs.
double error_of(const WindingSides& sides) {
  return sides.defect + sides.energy;
}

// Whether other normals enclose a solid clearly better than the given ones; if they enclose none, whether the given
// ones are not those of two sheets.
bool encloses_better(const OrientedPoints& given, const Points<3>& other, const NeighborTable& near) {
  const WindingSides turned = winding_sides(given.points, other, local_spacing(other, near));
  if (turned.mean < has_inside) return !Contradictions(given.points, given.normals, near).are_of_sheets(given.normals);
  const WindingSides before = winding_sides(given.points, given.normals, local_spacing(given.normals, near));
  return error_of(turned) < clearly_better * error_of(before);
}

// Flipped regions of given normals disagree along their borders; then another orientation has far fewer disagreements.
// Noise or creases leave about as many in any orientation. In a large cloud, a subset decides which it is. Sheets that
// touch disagree, too, but the given normals enclose a solid at least as well. Between sheets close to each other,
// signs by neighbours may be worse than those by the winding number.
void reorient_if_better(PreparedCloud& result, const NeighborTable& near, const Progress& progress) {
  OrientedPoints& cloud = result.cloud;
  if (Contradictions(cloud.points, cloud.normals, near).share(cloud.normals) < usual_contradictions) return;
  if (cloud.size() > 2 * examined) {
    const auto some = Eigen::seq(0, cloud.size() - 1, cloud.size() / examined);
    Points<3> turned = cloud.normals(Eigen::all, some);
    if (remaining_after_orientation(cloud.points(Eigen::all, some), turned, progress) > remaining_contradictions)
      return;
  }
  Points<3> turned = cloud.normals;
  if (remaining_after_orientation(cloud.points, turned, progress) > remaining_contradictions) return;
  const auto sides_of = [&](const Points<3>& normals) {
    return winding_sides(cloud.points, normals, local_spacing(normals, near));
  };
  const WindingSides sides = sides_of(turned);
  if (cloud.size() <= 2 * examined && sides.energy > little_energy) {
    Points<3> by_winding = cloud.normals;
    const Points<3> estimated = estimate_normals(cloud.points, *result.tree, Orient::consistent, progress);
    for (Index i = 0; i < cloud.size(); ++i)
      if (by_winding.col(i).dot(estimated.col(i)) < 0) by_winding.col(i) = -by_winding.col(i).eval();
    if (error_of(sides_of(by_winding)) < clearly_better * error_of(sides)) turned = std::move(by_winding);
  }
  if (!encloses_better(cloud, turned, near)) return;
  cloud.normals = std::move(turned);
  result.normals = NormalSource::reoriented;
  result.warnings.push_back("the given normals contradict each other: re-oriented");
}

// Gives the points outside of a region, in the user's coordinates, their normals back. Returns how many others have
// changed.
Index restore_outside(const std::optional<Box<3>>& region, const Points<3>& given, PreparedCloud& result) {
  Index changed = 0;
  for (Index i = 0; i < given.cols(); ++i) {
    if (!region->contains(result.origin + result.scale * result.cloud.points.col(i)))
      result.cloud.normals.col(i) = given.col(i);
    else if (result.cloud.normals.col(i) != given.col(i))
      ++changed;
  }
  return changed;
}

void correct(PreparedCloud& result, const NeighborTable& near, const std::optional<Box<3>>& region,
             const Progress& progress) {
  const Points<3> given = region ? result.cloud.normals : Points<3>(3, 0);
  NormalCorrection done = correct_normals(result.cloud.points, *result.tree, near, result.cloud.normals);
  if (region) {
    const Index changed = restore_outside(region, given, result);
    done.corrected = std::min(done.corrected, changed);
    done.turned = std::min(done.turned, changed);
  }
  warn(result.warnings, done.turned, "normals that point against their neighbours turned");
  if (done.corrected > 0 || (done.some_left && done.turned > result.cloud.size() / few_turned))
    orient_normals(result.cloud.points, result.cloud.normals, {.signs_given = true, .progress = progress});
  if (done.corrected == 0) return;
  const auto degrees = std::lround(done.error * 180 / std::numbers::pi);
  warn(result.warnings, done.corrected,
       "normals have errors of about " + std::to_string(degrees) +
           " degrees: corrected by the positions and by each other");
  result.normals = NormalSource::corrected;
}

// Normals of planes through few neighbours are estimated again: they repeat the noise of the positions, which looks
// like detail then. They keep their side, unless the new ones enclose a solid clearly better.
void replace_plane_normals(PreparedCloud& result, const NeighborTable& near, const Progress& progress) {
  OrientedPoints& cloud = result.cloud;
  const Index neighbors = neighbors_of_planes(cloud.points, *result.tree, cloud.normals);
  if (neighbors == 0) return;
  const Points<3> estimated = estimate_normals(cloud.points, *result.tree, Orient::consistent, progress);
  cloud.normals = on_given_side(estimated, cloud.normals, near);
  if (encloses_better(cloud, estimated, near)) cloud.normals = estimated;
  result.normals = NormalSource::corrected;
  result.warnings.push_back("the given normals are those of planes through " + std::to_string(neighbors) +
                            " neighbours: estimated again");
}

// Sets normals to zero that the positions contradict, and returns their number; or finds all of them unusable.
Index leave_out_unfit(PreparedCloud& result, const NeighborTable& near, bool& usable) {
  const UnfitNormals unfit = clear_unfit_normals(result.cloud.points, near, result.cloud.normals);
  if (unfit.unset > 0 && !unfit.all) {
    std::ostringstream text;
    text << "normals are all (" << unfit.value.transpose().format(Eigen::IOFormat(3, Eigen::DontAlignCols, ", ")) << ")"
         << " though their points lie in no plane: taken as missing";
    warn(result.warnings, unfit.unset, text.str());
  }
  if (unfit.all) {
    result.warnings.push_back(
        "the given normals are not those of the points, perhaps in another coordinate frame: all estimated");
    usable = false;
  }
  return unfit.unset;
}

}  // namespace

void warn(std::vector<std::string>& warnings, Index count, const std::string& text) {
  if (count > 0) warnings.push_back(std::to_string(count) + " " + text);
}

Eigen::VectorXd local_spacing(const Points<3>& normals, const NeighborTable& near) {
  Eigen::VectorXd spacing(near.size());
  for (Index i = 0; i < near.size(); ++i) {
    const auto on_sheet = [&](std::uint32_t j) {
      return normals.cols() == 0 || normals.col(i).dot(normals.col(j)) > 0;
    };
    const std::ptrdiff_t same_sheet = std::count_if(near.of(i).begin(), near.of(i).end(), on_sheet);
    spacing[i] =
        near.reach[i] * std::sqrt(std::numbers::pi / static_cast<double>(std::max(std::ptrdiff_t{1}, same_sheet)));
  }
  return spacing;
}

Index normalize(Points<3>& normals) {
  Index missing = 0;
  for (Index i = 0; i < normals.cols(); ++i) {
    const double length = normals.col(i).stableNorm();
    if (length > 0 && std::isfinite(length)) {
      normals.col(i) /= length;
    } else {
      normals.col(i).setZero();
      ++missing;
    }
  }
  return missing;
}

Points<3> unit_normals(const Points<3>& given, const std::vector<Index>& ids) {
  if (given.cols() == 0) return given;
  Points<3> normals = given(Eigen::all, ids);
  normalize(normals);
  return normals;
}

void find_normals(PreparedCloud& result, const NeighborTable& near, Normals source, bool given,
                  const std::optional<Box<3>>& region, const Progress& progress) {
  OrientedPoints& cloud = result.cloud;
  bool usable = given && source != Normals::estimate;
  Index missing = usable ? normalize(cloud.normals) : 0;
  if (usable && source == Normals::automatic) missing += leave_out_unfit(result, near, usable);
  if (usable && 2 * missing > cloud.size()) {
    result.warnings.push_back("most normals are missing: all estimated");
    usable = false;
  }
  if (!usable) {
    cloud.normals = estimate_normals(cloud.points, *result.tree, Orient::consistent, progress);
    result.normals = NormalSource::estimated;
    return;
  }
  warn(result.warnings, missing, "missing normals estimated");
  if (missing > 0) fill_missing(cloud.points, *result.tree, near, cloud.normals, progress);
  if (source != Normals::automatic) return;
  replace_plane_normals(result, near, progress);
  if (result.normals == NormalSource::file) correct(result, near, region, progress);
  if (result.normals == NormalSource::file) reorient_if_better(result, near, progress);
}

void turn_outward(PreparedCloud& result, Normals source) {
  if (result.normals != NormalSource::file && result.normals != NormalSource::corrected) return;
  const std::vector<bool> inward = inward_parts(result.cloud, result.components);
  const auto count = std::count(inward.begin(), inward.end(), true);
  if (count == 0) return;
  const std::string where = count == static_cast<std::ptrdiff_t>(inward.size()) ? "" : " on some parts";
  if (source == Normals::file) {
    result.warnings.push_back("the given normals point inward" + where + "; automatic normals would turn them");
    return;
  }
  std::vector<signed char> sign(result.cloud.size(), inward.back() ? -1 : 1);
  for (std::size_t k = 0; k < result.components.size(); ++k)
    for (const Index i : result.components[k]) sign[i] = inward[k] ? -1 : 1;
  for (Index i = 0; i < result.cloud.size(); ++i) result.cloud.normals.col(i) *= sign[i];
  result.normals = NormalSource::reoriented;
  result.warnings.push_back("the given normals point inward" + where + ": turned");
}

void warn_of_sparse_parts(PreparedCloud& result) {
  const Eigen::VectorXd& spacing = result.cloud.spacing;
  if (spacing.size() < fewest_told) return;
  const double least = coarser * median(std::vector(spacing.begin(), spacing.end()));
  const double share = (spacing.array() > least).select(spacing.array().square(), 0).sum() / spacing.squaredNorm();
  if (share < large_share) return;
  std::ostringstream text;
  text << std::lround(100 * share) << " % of the surface has samples that are more than " << coarser
       << " times as far apart as most: what is smaller there is lost";
  result.warnings.push_back(text.str());
}

}  // namespace csrbf
