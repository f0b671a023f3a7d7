#include "csrbf/surface/prepare/clutter.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/core/small_matrices.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>
#include <random>

namespace csrbf {
namespace {

// Chosen by hand unless noted.
constexpr Index reach_rank = 5;          // neighbour whose distance measures the spacing
constexpr double sparse = 2.5;           // a sparse point has this many times the usual distance; clean scans: few
constexpr std::size_t fewest = 30;       // sparse points that show what they are
constexpr Index grid = 4;                // cells of the bounding box in each direction, to see where they are
constexpr double least_occupied = 0.75;  // share of cells with sparse points, of those that clutter would occupy
constexpr Index points_surrounded = 300, points_around = 2000;  // asked, and sought around them
constexpr double share_in_octant = 0.01;                        // of these, at least
constexpr Index own_neighbors = 9;       // among sparse points, to see whether they lie on sheets
constexpr double cloudy = 0.09;          // mean share of the least variance: in clutter 0.12, on sheets below 0.05
constexpr Index density_rank = 8;        // neighbour out to which points are counted
constexpr double as_clutter = 3;         // of clutter expected within that; more than 7 have a probability of 1 %
constexpr Index plane_neighbors = 16;    // that a point is compared with
constexpr int reweightings = 2;          // of the plane through them
constexpr double thinnest = 0.15;        // spacings: least standard deviation of a sheet
constexpr Index sheet_neighbors = 24;    // among which several sheets are sought
constexpr Index corners_from = 8;        // nearest neighbours whose triples span planes of several sheets
constexpr double different_planes = 4;   // of them: one fits by chance this many times as often
constexpr double fewest_on_sheet = 6;    // neighbours
constexpr double narrowest = 0.4;        // spacings: least standard deviation across a row of them
constexpr double near_plane = 2.2;       // spacings around the surface where sparse points are not seen
constexpr double like = 0.7;             // cosine between like normals, up to sign
constexpr std::size_t few_alike = 2;     // neighbours that a sample's normal agrees with at least
constexpr double share_tried = 0.02;     // clutter assumed to find out how much there is
constexpr Index points_screened = 1000;  // for that, ...
constexpr Index points_tried = 4000;     // ... more if some are clutter
constexpr Index places_tried = 2000;     // in the box, to see where clutter would be noticed
constexpr double least_seen = 0.1;       // share of the box where it must be
constexpr double least_share = 0.03;     // of clutter
constexpr double most_share = 0.5;       // of clutter
constexpr int rounds = 4;                // of removing; later ones find hardly any

double spacing_of(double reach, Index rank) {
  return reach * std::sqrt(std::numbers::pi / static_cast<double>(rank));
}

// Probability of a Poisson variable of that mean to be at most `count`.
double at_most(Index count, double mean) {
  double term = std::exp(-mean), sum = term;
  for (Index k = 1; k <= count; ++k) sum += term *= mean / static_cast<double>(k);
  return sum;
}

// Samples per volume at a height over a sheet of standard deviation s with one sample per h^2, times the probability
// that not more of them are near than are, of so many expected ones.
double density_off_sheet(double height, double s, double h, double expected) {
  const double t = height / s;
  return std::exp(-0.5 * t * t) / (std::sqrt(2 * std::numbers::pi) * s * h * h) * at_most(density_rank, expected);
}

// Cells of the bounding box with points, as a share of those that evenly scattered points would occupy.
double occupied(const Points<3>& points, const Box<3>& box) {
  constexpr Index cells = grid * grid * grid;
  std::vector<char> seen(cells, 0);
  const Point<3> size = (box.hi - box.lo).cwiseMax(std::numeric_limits<double>::min());
  for (Index i = 0; i < points.cols(); ++i) {
    Index cell = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double x = (points(axis, i) - box.lo[axis]) / size[axis];
      cell = grid * cell + std::clamp<Index>(static_cast<Index>(x * grid), 0, grid - 1);
    }
    seen[cell] = 1;
  }
  const double expected = cells * (1 - std::exp(-static_cast<double>(points.cols()) / cells));
  return static_cast<double>(std::count(seen.begin(), seen.end(), 1)) / expected;
}

// Mean share of the variance in the direction of least variance among neighbours: 0 on planes, 1/3 at most.
double variation(const Points<3>& points) {
  const KdTree<3> tree(points);
  std::vector<double> share(points.cols());
  parallel_for(points.cols(), 512, [&](Index begin, Index end) {
    std::vector<Index> ids(own_neighbors + 1);
    std::vector<double> squared(ids.size());
    for (Index i = begin; i < end; ++i) {
      const Index found = tree.nearest(points.col(i), std::ssize(ids), ids.data(), squared.data());
      Points<3> around = points(Eigen::all, std::span(ids).first(static_cast<std::size_t>(found)));
      around.colwise() -= around.rowwise().mean().eval();
      const Eigen::Matrix3d covariance = around * around.transpose();
      const double least = symmetric_eigen_direct(covariance).values[0];
      share[i] = std::max(0.0, least) / std::max(covariance.trace(), std::numeric_limits<double>::min());
    }
  });
  return std::accumulate(share.begin(), share.end(), 0.0) / static_cast<double>(share.size());
}

// The neighbours of a place and the sheets through them.
class Sheets {
 public:
  Sheets(const Points<3>& points, const Points<3>& normals, const KdTree<3>& tree)
      : points_(points), normals_(normals), tree_(tree), ids_(sheet_neighbors + 1), squared_(ids_.size()) {}

  [[nodiscard]] bool is_clutter(Index i, double density) {
    const double r = find_near(points_.col(i), i);
    if (alone(r, density)) return true;
    if (std::ssize(near_) < density_rank) return false;
    const Point<3> own = normals_.cols() > 0 ? Point<3>(normals_.col(i)) : Point<3>::Zero();
    return unlike(i) || off_sheets(points_.col(i), own, r, density);
  }

  // Whether a point without a normal that were added at x would be clutter.
  [[nodiscard]] bool would_be_clutter(const Point<3>& x, double density) {
    const double r = find_near(x, -1);
    return alone(r, density) || (std::ssize(near_) >= density_rank && off_sheets(x, Point<3>::Zero(), r, density));
  }

  // The distance out to which the neighbours of the last one were counted.
  [[nodiscard]] double reach() const { return reach_; }
  // The squared distance within which other points would have told something else of the last one.
  [[nodiscard]] double squared_view() const { return squared_view_; }

 private:
  // Sets near_ to the points around x but i; returns the distance out to which they are counted.
  double find_near(const Point<3>& x, Index i) {
    const Index found = tree_.nearest(x, std::ssize(ids_), ids_.data(), squared_.data());
    squared_view_ = found == std::ssize(ids_) ? squared_.back() : std::numeric_limits<double>::infinity();
    near_.clear();
    for (Index k = 0; k < found; ++k)
      if (ids_[k] != i && std::ssize(near_) < sheet_neighbors) near_.push_back(ids_[k]);
    return reach_ = (points_.col(near_[std::min<std::size_t>(near_.size(), density_rank) - 1]) - x).norm();
  }

  [[nodiscard]] std::span<const Index> near_in_plane() const {
    return std::span(near_).first(std::min<std::size_t>(near_.size(), plane_neighbors));
  }

  [[nodiscard]] static bool alone(double r, double density) {
    return density * 4 / 3 * std::numbers::pi * r * r * r > as_clutter;
  }

  [[nodiscard]] bool off_sheets(const Point<3>& x, const Point<3>& own, double r, double density) const {
    return sheet(x, r) < density && !one_of_several_sheets(x, own, r, different_planes * density);
  }

  [[nodiscard]] bool unlike(Index i) const {
    if (normals_.cols() == 0) return false;
    const auto near = near_in_plane();
    const auto alike = std::count_if(near.begin(), near.end(),
                                     [&](Index j) { return std::abs(normals_.col(i).dot(normals_.col(j))) > like; });
    return static_cast<std::size_t>(alike) < few_alike;
  }

  // Samples per volume that a sheet through the neighbours would have at x, times the probability that not more of them
  // are within r.
  [[nodiscard]] double sheet(const Point<3>& x, double r) const {
    const Points<3> q = points_(Eigen::all, near_in_plane());
    Eigen::VectorXd weight = Eigen::VectorXd::Ones(q.cols());
    Point<3> mean, normal;
    double deviation = 0;
    std::vector<double> along;
    for (int round = 0; round < reweightings; ++round) {
      mean = q * weight / weight.sum();
      const Points<3> d = q.colwise() - mean;
      const Eigen::Matrix3d covariance = d * weight.asDiagonal() * d.transpose();
      normal = symmetric_eigen(covariance).vectors.col(0);
      const Eigen::VectorXd height = (normal.transpose() * d).transpose().cwiseAbs();
      deviation = median(std::vector<double>(height.begin(), height.end())) / median_of_normal;
      const double scale = std::max(2 * deviation, std::numeric_limits<double>::min());
      weight = 1 / (1 + (height / scale).array().square());
      along.clear();
      for (Index k = 0; k < q.cols(); ++k) along.push_back(d.col(k).squaredNorm() - height[k] * height[k]);
    }
    const double middle = std::sqrt(std::max(0.0, median(along)));
    const double h = spacing_of(middle, q.cols() / 2), s = std::max(deviation, thinnest * h);
    return density_off_sheet(normal.dot(x - mean), s, h, std::numbers::pi * r * r / (h * h));
  }

  // Whether it is at least `enough` for one of the planes through three of the nearest neighbours that contain enough
  // others and are perpendicular to its own normal, if it has one: both sides of a thin plate and the faces of an edge
  // are sheets of their own.
  [[nodiscard]] bool one_of_several_sheets(const Point<3>& x, const Point<3>& own, double r, double enough) const {
    const Points<3> q = points_(Eigen::all, near_);
    const double reach = (q.col(q.cols() - 1) - x).norm(), thin = thinnest * spacing_of(reach, q.cols());
    for (Index c = 2; c < corners_from; ++c)
      for (Index b = 1; b < c; ++b)
        for (Index a = 0; a < b; ++a) {
          const Point<3> normal = (q.col(b) - q.col(a)).cross(q.col(c) - q.col(a)).normalized();
          if (through_those_near(q, q.col(a), normal, thin, x, own, r) >= enough) return true;
        }
    return false;
  }

  // That for the plane through the neighbours near a given one; 0 if they are few or nearly in a row.
  [[nodiscard]] static double through_those_near(const Points<3>& q, const Point<3>& at, const Point<3>& along,
                                                 double thin, const Point<3>& x, const Point<3>& own, double r) {
    const Eigen::VectorXd close =
        ((along.transpose() * (q.colwise() - at)).transpose().array().abs() < 2 * thin).cast<double>();
    const double count = close.sum();
    if (count < fewest_on_sheet) return 0;
    const Point<3> mean = q * close / count;
    const Points<3> d = q.colwise() - mean;
    const Eigen::Matrix3d covariance = d * close.asDiagonal() * d.transpose() / count;
    const SymmetricEigen spread = symmetric_eigen_direct(covariance);
    const double h = (q.col(q.cols() - 1) - x).norm() * std::sqrt(std::numbers::pi / count);
    if (spread.values[1] < narrowest * narrowest * h * h) return 0;
    const Point<3> normal = spread.vectors.col(0);
    if (!own.isZero() && std::abs(normal.dot(own)) < like) return 0;
    const double area = 4 * std::numbers::pi * std::sqrt(spread.values[1] * spread.values[2]);  // of an ellipse
    const double s = std::max(std::sqrt(std::max(0.0, spread.values[0])), thin);
    return density_off_sheet(normal.dot(x - mean), s, h, std::numbers::pi * r * r / std::min(h * h, area / count));
  }

  const Points<3>& points_;
  const Points<3>& normals_;
  const KdTree<3>& tree_;
  std::vector<Index> ids_, near_;
  std::vector<double> squared_;
  double reach_ = 0, squared_view_ = 0;
};

// 1 for every point that is clutter. `squared_view`: of each point, that of Sheets; where it is not 0 on entry, the
// point is known to be none.
std::vector<char> find_clutter(const Points<3>& points, const Points<3>& normals, const KdTree<3>& tree, double density,
                               std::vector<double>& squared_view) {
  std::vector<char> clutter(points.cols());
  parallel_for(points.cols(), 256, [&](Index begin, Index end) {
    Sheets sheets(points, normals, tree);
    for (Index i = begin; i < end; ++i) {
      if (squared_view[i] > 0) continue;
      clutter[i] = sheets.is_clutter(i, density) ? 1 : 0;
      squared_view[i] = sheets.squared_view();
    }
  });
  return clutter;
}

// Sets the view to 0 of points that had one of those in it that are gone.
void forget_views(const Points<3>& points, const Points<3>& gone, std::vector<double>& squared_view) {
  const KdTree<3> tree(gone);
  parallel_for(points.cols(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      Index nearest = 0;
      double squared_distance = 0;
      tree.nearest(points.col(i), 1, &nearest, &squared_distance);
      if (squared_distance <= squared_view[i]) squared_view[i] = 0;
    }
  });
}

// Points per unit volume around points that are scattered in a part of space: the median.
double density_among(const Points<3>& points) {
  const NeighborTable near = make_neighbor_table(points, KdTree<3>(points), own_neighbors);
  const double ball = 4.0 / 3.0 * std::numbers::pi;
  std::vector<double> density(points.cols());
  for (Index i = 0; i < points.cols(); ++i)
    density[i] = static_cast<double>(near.k) / (ball * near.reach[i] * near.reach[i] * near.reach[i]);
  return median(std::move(density));
}

// Whether most of some points have enough others in all eight octants around them, as outliers inside of a body have,
// while a part of a surface with fewer samples is beside the rest of it.
bool are_amid(const Points<3>& some, const Points<3>& others) {
  const Index step = (some.cols() + points_surrounded - 1) / points_surrounded;
  const Index stride = (others.cols() + points_around - 1) / points_around;
  Index asked = 0, amid = 0;
  for (Index i = 0; i < some.cols(); i += step, ++asked) {
    std::array<Index, 8> octants{};
    for (Index j = 0; j < others.cols(); j += stride) {
      const Point<3> d = others.col(j) - some.col(i);
      ++octants[(d[0] > 0 ? 4 : 0) + (d[1] > 0 ? 2 : 0) + (d[2] > 0 ? 1 : 0)];
    }
    const Index least = *std::min_element(octants.begin(), octants.end());
    amid += static_cast<double>(stride * least) > share_in_octant * static_cast<double>(others.cols()) ? 1 : 0;
  }
  return 2 * amid > asked;
}

// Density of the outliers in the bounding box by the points that are much sparser than usual.
double density_in_space(const Points<3>& points, const NeighborTable& near, const Box<3>& box) {
  if (near.k < reach_rank) return 0;
  std::vector<double> reach(points.cols());
  for (Index i = 0; i < points.cols(); ++i) reach[i] = (points.col(i) - points.col(near.of(i)[reach_rank - 1])).norm();
  const double usual = median(std::vector(reach));
  std::vector<Index> ids, rest;
  for (Index i = 0; i < points.cols(); ++i) (reach[i] > sparse * usual ? ids : rest).push_back(i);
  if (ids.size() < fewest) return 0;
  const Points<3> thin = points(Eigen::all, ids);
  if (variation(thin) < cloudy) return 0;
  if (occupied(thin, box) < least_occupied) {
    return are_amid(thin, points(Eigen::all, rest)) ? density_among(thin) : 0;
  }
  const double h = spacing_of(usual, reach_rank), volume = (box.hi - box.lo).prod();
  const double around = 2 * near_plane * h * h * h * static_cast<double>(points.cols() - thin.cols());
  return static_cast<double>(thin.cols()) / std::max(volume - around, 0.25 * volume);
}

// Density of the outliers in the bounding box where a body is so compact that every outlier is near a sheet, too:
// points that a little clutter would explain better than sheets, over the share of places in the box that would be
// such. Only those count that are farther from others than half of these places: rough sheets have hardly any. 0 if
// there is too little, or if it lies on sheets after all.
double density_among_sheets(const Points<3>& points, const KdTree<3>& tree, const Box<3>& box) {
  const double of_all = static_cast<double>(points.cols()) / (box.hi - box.lo).prod(), few = share_tried * of_all;
  if (points.cols() <= density_rank || !std::isfinite(of_all)) return 0;
  const Points<3> none(3, 0);
  // Of the clutter among so many points or places: distances out to which their neighbours are counted.
  const auto reaches_of_clutter = [&](Index count, const auto& is_clutter) {
    std::vector<double> reaches(count);
    parallel_for(count, 128, [&](Index begin, Index end) {
      Sheets sheets(points, none, tree);
      for (Index t = begin; t < end; ++t) reaches[t] = is_clutter(sheets, t) ? sheets.reach() : 0;
    });
    std::erase(reaches, 0.0);
    return reaches;
  };
  const auto outliers_among = [&](Index count) {
    return reaches_of_clutter(
        count, [&](Sheets& sheets, Index t) { return sheets.is_clutter(t * points.cols() / count, few); });
  };
  const Index screened = std::min(points_screened, points.cols()), tried = std::min(points_tried, points.cols());
  const auto first = static_cast<double>(outliers_among(screened).size());
  if (first < least_share * least_seen * static_cast<double>(screened)) return 0;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform;
  Points<3> places(3, places_tried);
  for (double& x : places.reshaped()) x = uniform(random);
  places = (places.array().colwise() * (box.hi - box.lo).array()).matrix().colwise() + box.lo;
  const std::vector<double> seen = reaches_of_clutter(
      places_tried, [&](Sheets& sheets, Index t) { return sheets.would_be_clutter(places.col(t), few); });
  if (static_cast<double>(seen.size()) < least_seen * places_tried) return 0;
  const double middle = median(std::vector(seen));
  const auto farther = [&](const std::vector<double>& reaches, Index count) {
    const auto far = std::count_if(reaches.begin(), reaches.end(), [&](double r) { return r >= middle; });
    return static_cast<double>(far) / static_cast<double>(count);
  };
  const double share = farther(outliers_among(tried), tried) / farther(seen, places_tried);
  if (share < least_share || share > most_share) return 0;
  std::vector<Index> ids;
  std::vector<double> squared_view(static_cast<std::size_t>(points.cols()), 0.0);
  const std::vector<char> clutter = find_clutter(points, none, tree, few, squared_view);
  for (Index i = 0; i < points.cols(); ++i)
    if (clutter[i] != 0) ids.push_back(i);
  const Points<3> all = points(Eigen::all, ids);
  return occupied(all, box) < least_occupied || variation(all) < cloudy ? 0 : share * of_all;
}

}  // namespace

double clutter_density(const Points<3>& points, const KdTree<3>& tree, const NeighborTable& near) {
  const Box<3> box = bounding_box<3>(points);
  return std::max(density_in_space(points, near, box), density_among_sheets(points, tree, box));
}

std::vector<Index> all_but_clutter(const Points<3>& points, const Points<3>& normals, double density) {
  std::vector<Index> kept(points.cols());
  std::iota(kept.begin(), kept.end(), Index{0});
  std::vector<double> squared_view(kept.size(), 0.0);
  for (int round = 0; round < rounds; ++round) {
    const Points<3> left = points(Eigen::all, kept);
    Points<3> left_normals(3, 0);
    if (normals.cols() > 0) left_normals = normals(Eigen::all, kept);
    const std::vector<char> drop = find_clutter(left, left_normals, KdTree<3>(left), density, squared_view);
    const auto dropped = static_cast<std::size_t>(std::count(drop.begin(), drop.end(), 1));
    if (dropped == 0 || kept.size() - dropped < fewest) break;
    std::vector<Index> gone;
    std::size_t count = 0;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      if (drop[k] != 0) {
        gone.push_back(kept[k]);
      } else {
        squared_view[count] = squared_view[k];
        kept[count++] = kept[k];
      }
    }
    kept.resize(count);
    squared_view.resize(count);
    forget_views(points(Eigen::all, kept), points(Eigen::all, gone), squared_view);
  }
  return kept;
}

}  // namespace csrbf
