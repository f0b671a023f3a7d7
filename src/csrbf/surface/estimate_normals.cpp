#include "csrbf/surface/estimate_normals.hpp"

#include "csrbf/core/disjoint_sets.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/surface/normals/contradictions.hpp"
#include "csrbf/surface/normals/height_field.hpp"
#include "csrbf/surface/normals/neighborhood.hpp"
#include "csrbf/surface/normals/thin_sheets.hpp"
#include "csrbf/surface/normals/winding_consistency.hpp"
#include "csrbf/surface/normals/winding_sides.hpp"

#include <array>
#include <optional>

namespace csrbf {
namespace {

constexpr std::string_view stage = "estimate normals", where = "estimate_normals";
// Chosen by hand.
constexpr Index shared_from = 33;            // neighbourhoods of at least this many points are shared ...
constexpr Index share = 16;                  // ... by up to a sixteenth of their points
constexpr Index graph_neighbors = 12;        // of orient_normals(), its default
constexpr Index fewest_consistent = 50;      // points whose winding number shows an inside
constexpr Index most_consistent = 100'000;   // ... more: no better than by neighbours, and slower
constexpr double has_inside = 0.15;          // mean winding number on the points; 0.1 on sheets without inside
constexpr double no_inside = 0.45;           // mean (2 w - 1)^2 there; 0.51 and more on terrains, 0.4 on thin plates
constexpr double little_inside = 0.1;        // ... above which hills of a sheet may have been taken for solids
constexpr double close = 0.985, far = 0.87;  // cosines of 10 and 30 degrees between the fitted normal and that by the
                                             // winding number: the first counts alone, the second does
constexpr double seen_as_one = 0.2;          // share of the points: two scans agree along their shift, walls nowhere
constexpr double noise_of_two_scans = 0.3;   // at least, in spacings
constexpr std::array two_scans_apart = {2.0, 2.8, 4.0};  // distances, in spacings, in which two scans look like one
constexpr double much_better = 0.7;                      // largest ratio of defects of two scans, and of energies
constexpr double solid = 0.3;      // mean winding number at least, 1/2 in theory; a rough sheet taken for two has .15
constexpr double undecided = 0.5;  // defect of signs that enclose nothing
constexpr double encloses_well = 0.1;  // defect below which no other normals are tried: right ones have .02 to .05
constexpr double usual_contradictions =
    1e-4;                                 // share of neighbours; bodies turned in part have two times that and more
constexpr double few_differences = 2e-3;  // share of the signs that two ways of orientation may give otherwise
constexpr double clearly_better = 0.8;    // largest ratio of the errors of the winding number beside and on the points
constexpr double far_fewer = 0.2;         // largest ratio of contradictions
constexpr double nested = 0.7;            // mean winding number that solids, 1/2, and sheets do not have
constexpr double noise_followed = 0.2;  // share of other axes where noise is followed: 0.4 to 0.6, else 0.01 mostly ...
constexpr double noise_followed_at_most = 0.5;  // ... if even more neighbours might suit: parts may be thinner
constexpr double clear_agreement = 0.25;        // ... with the others, 1 if all agree: 0.3 or more, 0.17 if wrong
constexpr double few_seams = 0.005;             // share of contradictions of signs by neighbours that are right there
constexpr double line = 1e-14;                  // of the largest variance: the cloud lies on a line

// The different points in unit coordinates and Morton order.
struct Cloud {
  Points<3> points;
  std::vector<Index> unique_of;  // of each input point
};

Cloud sort_unique(const PointsRef<3>& input) {
  const Box<3> box = bounding_box<3>(input);
  const Point<3> center = 0.5 * box.lo + 0.5 * box.hi;
  const double size = (0.5 * box.hi - 0.5 * box.lo).maxCoeff(), scale = size > 0 ? size : 1;
  const std::vector<Index> order = morton_order<3>(input);
  Cloud cloud{Points<3>(3, input.cols()), std::vector<Index>(order.size())};
  Index count = 0;
  for (const Index i : order) {
    const Point<3> p = (input.col(i) - center) / scale;
    if (count == 0 || p != cloud.points.col(count - 1)) cloud.points.col(count++) = p;
    cloud.unique_of[i] = count - 1;
  }
  cloud.points.conservativeResize(3, count);
  return cloud;
}

void check(const PointsRef<3>& points, const NormalOptions& options) {
  require(options.neighbors == 0 || options.neighbors >= 3, where, "neighbors", options.neighbors,
          "must be 0 (automatic) or at least 3");
  require(points.allFinite(), where, "points", "NaN or infinity", "must be finite; remove such points");
  require(std::int64_t{points.cols()} < (std::int64_t{1} << 31), where, "points.cols()", points.cols(),
          "must be below 2^31");
  if (options.orient == Orient::viewpoint)
    require(options.viewpoint.allFinite(), where, "viewpoint", options.viewpoint.transpose(), "must be finite");
}

void check_spread(const Points<3>& points) {
  require(points.cols() >= 3, where, "number of different points", points.cols(),
          "a surface needs points in 3 dimensions, at least 3 of them");
  const Points<3> centered = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d covariance = centered * centered.transpose();
  const Eigen::Vector3d variance = symmetric_eigen(covariance).values;
  require(variance[1] > line * variance[2], where, "points", "all on one line",
          "a surface needs points that spread in at least two directions");
}

// Normals, and a neighbour table where it comes as a by-product.
struct Fit {
  Points<3> normals;
  NeighborTable table;
};

// The table gets `graph` neighbours per point, or stays empty if the fits do not provide them.
Fit fit_all(const Points<3>& points, const KdTree<3>& tree, Index neighbors, Index graph, const Progress& progress) {
  const Index n = points.cols(), per_fit = neighbors >= shared_from ? neighbors / share : 1;
  Fit fit{Points<3>(3, n), {}};
  graph = std::min(graph, n - 1);
  if (per_fit == 1 && neighbors > graph) {
    fit.table.k = graph;
    fit.table.index.resize(n * graph);
    fit.table.reach.resize(n);
  }
  const Index slice = std::max<Index>(n / 16, 1 << 16) / per_fit * per_fit;
  for (Index first = 0; first < n; first += slice) {
    report(progress, stage, 0.1 + 0.5 * static_cast<double>(first) / static_cast<double>(n));
    const Index last = std::min(n, first + slice), grain = std::max<Index>(1, 512 / per_fit) * per_fit;
    const auto compute = [&](Index begin, Index end) {
      Neighborhood near(points, tree);
      for (Index i = first + begin; i < first + end; i += per_fit)
        fit_normals(points, i, std::min(first + end, i + per_fit), neighbors, near, fit.normals, fit.table);
    };
    parallel_for(last - first, grain, compute);
  }
  return fit;
}

Points<3> put(const ThinSheets& sheets, Points<3> normals) {
  for (Index i = 0; i < sheets.normals.cols(); ++i)
    if (sheets.has(i)) normals.col(i) = sheets.normals.col(i);
  return normals;
}

Eigen::VectorXd spacing_of(const NeighborTable& table) {
  Eigen::VectorXd spacing(table.size());
  for (Index i = 0; i < spacing.size(); ++i) spacing[i] = std::sqrt(table.area(i));
  return spacing;
}

// The normals with the signs of others.
Points<3> on_side(Points<3> normals, const Points<3>& others) {
  for (Index i = 0; i < normals.cols(); ++i)
    if (normals.col(i).dot(others.col(i)) < 0) normals.col(i) = -normals.col(i).eval();
  return normals;
}

// If two scans that do not fit saw one surface twice, so that the distance of the sheets is noise: normals of that
// surface. Such encloses a solid, with other normals there is hardly any, and scans agree in some places, along their
// shift. Together they have twice the winding number, and rounds at all points may turn one of them; points so far
// apart that they do not tell the scans apart then give the fitted normals their signs.
std::optional<ConsistentNormals> normals_of_two_scans(const Points<3>& points, const KdTree<3>& tree,
                                                      const Points<3>& fitted, const Points<3>& other,
                                                      const ThinSheets& sheets) {
  Index single = 0;
  for (Index i = 0; i < points.cols(); ++i) single += sheets.has(i) ? 0 : 1;
  if (static_cast<double>(single) < seen_as_one * static_cast<double>(points.cols())) return std::nullopt;
  const Eigen::VectorXd spacing = spacing_of(make_neighbor_table(points, tree, graph_neighbors));
  const double usual = median(std::vector<double>(spacing.begin(), spacing.end()));
  const Points<3> places = free_places(points, tree, sheets.normals, Eigen::VectorXd::Constant(points.cols(), usual));
  if (places.cols() == 0) return std::nullopt;
  const auto defect_of = [&](const Points<3>& normals) {
    return winding_defect(points, on_side(fitted, normals), spacing, places);
  };
  std::optional<ConsistentNormals> best;
  const double present = defect_of(other);
  if (present < encloses_well) return std::nullopt;
  double least = much_better * present;
  ConsistentNormals at_all = consistent_normals(points, tree, noise_of_two_scans * usual);
  if (const double defect = defect_of(at_all.normals); defect < least) {
    least = much_better * defect;
    best = std::move(at_all);
  }
  for (const double distance : two_scans_apart) {
    const Points<3> some = points(Eigen::all, points_apart(points, tree, distance * usual));
    if (some.cols() < fewest_consistent) break;
    const KdTree<3> tree_of_some(some);
    ConsistentNormals one = consistent_normals(some, tree_of_some);
    Points<3> nearest(3, points.cols());
    Index id = 0;
    double squared = 0;
    for (Index i = 0; i < points.cols(); ++i) {
      tree_of_some.nearest(points.col(i), 1, &id, &squared);
      nearest.col(i) = one.normals.col(id);
    }
    const double defect = defect_of(nearest);
    if (defect >= least) continue;
    least = defect;
    one.normals = on_side(fitted, nearest);
    best = std::move(one);
  }
  return best;
}

// Whether normals from the two sheets of thin parts fit much better: at the points, and at places that fitted neither.
bool sheets_fit_better(const Points<3>& points, const KdTree<3>& tree, const ThinSheets& sheets,
                       const ConsistentNormals& one, const ConsistentNormals& two) {
  if (!(two.energy < much_better * one.energy)) return false;
  const Eigen::VectorXd spacing = spacing_of(make_neighbor_table(points, tree, graph_neighbors));
  const Points<3> places = free_places(points, tree, sheets.normals, spacing);
  if (places.cols() == 0) return false;
  return winding_defect(points, put(sheets, two.normals), spacing, places) <
         winding_defect(points, one.normals, spacing, places);
}

// Whether more than this share of the axes differ.
bool axes_differ(const Points<3>& consistent, const Points<3>& fitted, double share) {
  const Index differ = ((consistent.array() * fitted.array()).colwise().sum().abs() < far).count();
  return static_cast<double>(differ) > share * static_cast<double>(fitted.cols());
}

enum class Inside { none, little, clear };

// Gives the normals, fitted to so many neighbours, signs, and where they are far off, on thin parts and creases, other
// axes, but for sheets without inside. `apart`: plates were taken for one rough sheet, and it started again from their
// sheets. `follows_noise`: fits to many points average noise, but where it is wider than the spacing, consistent
// normals follow it.
Inside orient_by_winding(const Points<3>& points, const KdTree<3>& tree, ThinSheets& sheets, bool& apart,
                         Points<3>& normals, const NeighborChoice& fit, bool& follows_noise) {
  if (points.cols() < fewest_consistent || points.cols() > most_consistent) return Inside::none;
  ConsistentNormals consistent = consistent_normals(points, tree);
  if (sheets.any()) {
    ConsistentNormals from_sheets = consistent_normals(points, tree, put(sheets, consistent.normals), sheets.noise);
    apart = contradict(points, tree, consistent.normals, sheets) ||
            sheets_fit_better(points, tree, sheets, consistent, from_sheets);
    if (apart) {
      consistent = std::move(from_sheets);
      consistent.normals = put(sheets, std::move(consistent.normals));
    }
    if (auto one = normals_of_two_scans(points, tree, normals, consistent.normals, sheets)) {
      consistent = *std::move(one);
      sheets = {};
      apart = false;
    }
  }
  if (!apart && !(consistent.mean_winding > has_inside && consistent.energy < no_inside)) {
    sheets = {};
    return Inside::none;
  }
  follows_noise = !apart && fit.neighbors >= shared_from &&
                  axes_differ(consistent.normals, normals, fit.suits ? noise_followed : noise_followed_at_most);
  for (Index i = 0; i < normals.cols(); ++i) {
    const Point<3> global = consistent.normals.col(i);
    const double cosine = normals.col(i).dot(global);
    if (cosine == 0) continue;  // a wire has no normal
    if (cosine < 0) normals.col(i) = -normals.col(i).eval();
    if (std::abs(cosine) > close) continue;
    normals.col(i) += std::min(1.0, (close - std::abs(cosine)) / (close - far)) * (global - normals.col(i));
    normals.col(i).normalize();
  }
  return consistent.energy > little_inside ? Inside::little : Inside::clear;
}

// Signs by neighbours and by the winding number, where they differ.
class Rivals {
 public:
  Rivals(const Points<3>& points, const KdTree<3>& tree, const NeighborTable& table, const Points<3>& by_winding,
         const Points<3>& by_neighbors)
      : contradictions_{Contradictions(points, by_winding, table).share(by_winding),
                        Contradictions(points, by_neighbors, table).share(by_neighbors)} {
    Index differences = 0;
    for (Index i = 0; i < points.cols(); ++i) differences += by_winding.col(i).dot(by_neighbors.col(i)) < 0 ? 1 : 0;
    differ_ = static_cast<double>(differences) > few_differences * static_cast<double>(points.cols());
    if (!differ_) return;
    const Eigen::VectorXd spacing = spacing_of(table);
    const Points<3> places = free_places(points, tree, by_neighbors, spacing);
    winding_ = winding_sides(points, by_winding, spacing, places);
    neighbors_ = winding_sides(points, by_neighbors, spacing, places);
  }

  // Whether those by neighbours enclose a solid better, for rounds may end before a body inside a cavity is turned; or
  // no worse, with far fewer contradictions.
  [[nodiscard]] bool neighbors_know_better() const {
    const double ratio = error(neighbors_) / error(winding_);
    return differ_ && (ratio < clearly_better || (ratio < 1 && contradictions_[1] < far_fewer * contradictions_[0]));
  }

  // Whether those by the winding number enclose a solid and the others nothing: no hills of a sheet.
  [[nodiscard]] bool winding_encloses() const {
    return differ_ && winding_.mean > solid && winding_.defect < encloses_well && neighbors_.defect > undecided;
  }

  // Whether those by neighbours have shells within shells that face the same way, as no sheets or solids have.
  [[nodiscard]] bool neighbors_nest() const { return differ_ && neighbors_.mean > nested; }

 private:
  static double error(const WindingSides& sides) { return sides.defect + sides.energy; }

  std::array<double, 2> contradictions_;
  bool differ_ = false;
  WindingSides winding_, neighbors_;
};

// Signs by neighbours, with each connected part on the side of most of the other normals; nothing changes where
// neighbours contradict each other, or as many other normals as they agree with.
std::optional<OrientReport> orient_in_noise(const Points<3>& points, const NeighborTable& table,
                                            const Points<3>& others, Points<3>& normals, const Progress& progress) {
  Points<3> found = normals;
  const OrientReport report = orient_normals(points, table, found, progress);
  if (Contradictions(points, found, table).share(found) > few_seams) return std::nullopt;
  DisjointSets parts(static_cast<std::size_t>(points.cols()));
  for (Index i = 0; i < points.cols(); ++i)
    for (const std::uint32_t j : table.of(i)) parts.unite(static_cast<std::uint32_t>(i), j);
  Eigen::VectorXd agreement = Eigen::VectorXd::Zero(points.cols());
  for (Index i = 0; i < points.cols(); ++i)
    agreement[parts.find(static_cast<std::uint32_t>(i))] += found.col(i).dot(others.col(i)) < 0 ? -1 : 1;
  if (agreement.cwiseAbs().sum() < clear_agreement * static_cast<double>(points.cols())) return std::nullopt;
  for (Index i = 0; i < points.cols(); ++i)
    normals.col(i) = (agreement[parts.find(static_cast<std::uint32_t>(i))] < 0 ? -1 : 1) * found.col(i);
  return report;
}

// Gives fitted normals signs: those of one side to height fields; else by the winding number, or by neighbours for
// sheets without inside, of which hills may look like solids, for very large clouds, and where these know better, but
// not by taking plates for a solid.
OrientReport orient(const Points<3>& points, const KdTree<3>& tree, const NeighborChoice& choice, Fit& fit,
                    const Progress& progress) {
  ThinSheets sheets = thin_sheets(points, tree);
  if (!sheets.any() && orient_height_field(points, tree, fit.normals)) return {};
  const Progress part = [&](std::string_view, double fraction) {
    return !progress || progress(stage, 0.7 + 0.3 * fraction);
  };
  bool apart = false;  // whether the sheets give the normals
  bool follows_noise = false;
  OrientReport result{.method = OrientMethod::winding_number};
  Points<3> by_winding = fit.normals;
  const Inside inside = orient_by_winding(points, tree, sheets, apart, by_winding, choice, follows_noise);
  const bool solid = inside != Inside::none;
  // Other axes hide where the signs change.
  const auto fitted_by_winding = [&] {
    return inside == Inside::little ? on_side(fit.normals, by_winding) : by_winding;
  };
  bool decided = solid && apart;
  if (!decided) {
    if (fit.table.k == 0) fit.table = make_neighbor_table(points, tree, graph_neighbors);
    if (follows_noise)
      if (const auto in_noise = orient_in_noise(points, fit.table, by_winding, fit.normals, part)) return *in_noise;
    const Points<3> candidates = fitted_by_winding();
    decided = solid && Contradictions(points, candidates, fit.table).share(candidates) < usual_contradictions;
  }
  if (!decided) {
    const OrientReport by_neighbors = orient_normals(points, fit.table, fit.normals, part);
    const bool fill_plates = contradict(points, tree, fit.normals, sheets);
    if (!solid) apart = fill_plates;
    const auto neighbors_count = [&] {
      const Rivals rivals(points, tree, fit.table, by_winding, fit.normals);
      return (inside == Inside::little && !rivals.neighbors_nest() && !rivals.winding_encloses() &&
              cuts_sheet(points, fit.table, fitted_by_winding(), fit.normals)) ||  // hills
             rivals.neighbors_know_better();
    };
    decided = solid && (fill_plates || !neighbors_count());
    if (!decided) result = by_neighbors;
  }
  if (decided) fit.normals = std::move(by_winding);
  if (apart) fit.normals = put(sheets, std::move(fit.normals));
  return result;
}

// Normals of different points in Morton order; `result` gets what it says of them.
Points<3> normals_of(const Points<3>& points, const KdTree<3>& tree, const NormalOptions& options,
                     NormalReport& result) {
  const NeighborChoice choice =
      options.neighbors > 0 ? NeighborChoice{options.neighbors} : choose_neighbors(points, tree);
  result.neighbors = choice.neighbors;
  const bool consistent = options.orient == Orient::consistent;
  Fit fit = fit_all(points, tree, result.neighbors, consistent ? graph_neighbors : 0, options.progress);
  if (consistent) result.orientation = orient(points, tree, choice, fit, options.progress);
  if (consistent && choice.rough) result.neighbors = refit_normals(points, tree, fit.normals);
  return std::move(fit.normals);
}

}  // namespace

Points<3> estimate_normals(const PointsRef<3>& points, const NormalOptions& options, NormalReport* details) {
  check(points, options);
  report(options.progress, stage, 0);
  const Cloud cloud = sort_unique(points);
  check_spread(cloud.points);
  NormalReport result;
  result.duplicates = points.cols() - cloud.points.cols();
  const Points<3> normals = normals_of(cloud.points, KdTree<3>(cloud.points), options, result);
  Points<3> output(3, points.cols());
  for (Index i = 0; i < points.cols(); ++i) {
    output.col(i) = normals.col(cloud.unique_of[i]);
    if (options.orient == Orient::viewpoint && output.col(i).dot(options.viewpoint - points.col(i)) < 0)
      output.col(i) = -output.col(i).eval();
    result.undetermined += output.col(i).squaredNorm() > 0 ? 0 : 1;
  }
  report(options.progress, stage, 1);
  if (details != nullptr) *details = result;
  return output;
}

Points<3> estimate_normals(const Points<3>& points, const KdTree<3>& tree, Orient orient, const Progress& progress) {
  report(progress, stage, 0);
  NormalReport unused;
  Points<3> normals = normals_of(points, tree, {.orient = orient, .progress = progress}, unused);
  report(progress, stage, 1);
  return normals;
}

}  // namespace csrbf
