#include "csrbf/surface/normals/given_normals.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/surface/normals/contradictions.hpp"
#include "csrbf/surface/normals/neighborhood.hpp"

namespace csrbf {
namespace {

constexpr Index run_size = 512;           // samples judged together; by hand: smaller is more local, less certain
constexpr Index fewest = 128;             // samples that show how much their normals differ
constexpr double lower_quartile = 0.25;   // of the differences in a run: creases and curvature spoil the largest
constexpr double quartile_of_unit = 0.6;  // ... which is this for errors of 1 in both directions; by simulation
constexpr double median_of_unit = 1.177;  // median length of two such errors, (2 ln 2)^(1/2)
constexpr double quartile_of_sum = 0.45;  // of the absolute sum of two such errors in one direction: .3186 * 2^(1/2)
constexpr Index chord_neighbors = 3;      // by hand: more are farther away, where the curvature changes
constexpr double harmless = 0.08;         // radians; smaller errors are averaged out by the fit. Chosen by hand
constexpr double least_ratio = 0.45;   // of s^2 to t^2 above which normals are corrected: exact ones on 9 meshes with
                                       // 1000 to 20,000 samples stay below 0.35
constexpr double averaged_out = 0.35;  // radians; errors up to this, and up to `per_noise` times the slopes that the
constexpr double per_noise = 1.25;     // noise of the positions makes, are averaged out by patches as wide as that
                                       // noise asks for. By chamfer distances of 20 meshes, 5 to 50 % of the spacing
constexpr double explained = 2.5;      // standard deviations that an error may have. Chosen by hand
constexpr int sweeps = 8;              // of turning single normals; few are left after one

// b or -b, whichever is closer to a.
Point<3> towards(const Point<3>& a, const Point<3>& b) {
  return a.dot(b) < 0 ? Point<3>(-b) : b;
}

// The second smallest of some values.
class SecondSmallest {
 public:
  void add(double value) {
    if (value < least_) std::swap(value, least_);
    second_ = std::min(second_, value);
  }
  [[nodiscard]] double get() const { return second_; }

 private:
  double least_ = std::numeric_limits<double>::infinity(), second_ = least_;
};

// Differences between the normals of a sample and its neighbours, up to sign.
double difference(const Points<3>& normals, const NeighborTable& near, Index i) {
  const Point<3> n = normals.col(i);
  SecondSmallest smallest;
  for (const std::uint32_t j : near.of(i)) smallest.add((towards(n, normals.col(j)) - n).squaredNorm());
  return std::sqrt(smallest.get());
}

class Judge {
 public:
  Judge(const Points<3>& points, const KdTree<3>& tree, const NeighborTable& near, const Points<3>& given)
      : points_(points), tree_(tree), near_(near), given_(given), n_(points.cols()) {}

  NormalCorrection correct(Points<3>& normals) {
    NormalCorrection result;
    find_suspects();
    result.some_left = averaged_ > 0;
    if (suspects_.empty()) return result;
    estimate();
    // Where most normals agree, the others have to differ clearly: curved detail looks like small errors.
    const double least = 2 * (std::ssize(suspects_) + averaged_) > runs() ? harmless : 2 * harmless;
    std::vector<Measured> wrong;
    for (const Index run : suspects_) {
      const Measured found{run, measure(run), error_by_chords(run)};
      const double s2 = found.error.given * found.error.given, t2 = found.error.positions * found.error.positions;
      const auto is_small = [&](double s) { return !(s > least && s * s > least_ratio * (s2 + t2 - s * s)); };
      if (!is_small(found.error.given) && !is_small(found.by_chords)) wrong.push_back(found);
    }
    // Where the errors of most runs are averaged out, the others have to differ clearly, as above.
    const std::ptrdiff_t left = averaged_ + std::count_if(wrong.begin(), wrong.end(), [](const Measured& m) {
                                  return is_averaged_out(m, averaged_out);
                                });
    const double limit = 2 * left > averaged_ + std::ssize(wrong) ? 2 * averaged_out : averaged_out;
    result.some_left =
        std::erase_if(wrong, [&](const Measured& m) { return is_averaged_out(m, limit); }) > 0 || result.some_left;
    std::vector<double> errors;
    for (const auto& [run, error, by_chords] : wrong) {
      errors.push_back(error.given);
      const Index begin = first(run), end = first(run + 1);
      result.corrected += end - begin;
      parallel_for(end - begin, 64, [&, &error = error](Index from, Index to) {
        for (Index i = begin + from; i < begin + to; ++i) normals.col(i) = better(i, error);
      });
    }
    if (!errors.empty()) result.error = median(errors);
    return result;
  }

 private:
  struct Error {
    double given = 0, positions = 0;  // standard deviations in each direction
  };

  struct Measured {
    Index run;
    Error error;
    double by_chords;
  };

  [[nodiscard]] Index runs() const { return std::max<Index>(1, n_ / run_size); }
  [[nodiscard]] Index first(Index run) const { return run * n_ / runs(); }

  // Runs whose normals differ enough to be looked at; curvature counts here, too. Those whose errors are averaged out
  // even so are only counted: the normals of their positions cost most of the time.
  void find_suspects() {
    enum : char { exact, suspect, averaged };
    std::vector<char> kind(runs(), exact);
    parallel_for(runs(), 4, [&](Index begin, Index end) {
      std::vector<double> d;
      for (Index run = begin; run < end; ++run) {
        d.clear();
        for (Index i = first(run); i < first(run + 1); ++i) d.push_back(difference(given_, near_, i));
        const double given = percentile(d, lower_quartile) / quartile_of_unit;
        if (given > harmless)
          kind[run] = is_averaged_out({run, {.given = given}, error_by_chords(run)}, averaged_out) ? averaged : suspect;
      }
    });
    for (Index run = 0; run < runs(); ++run)
      if (kind[run] == suspect) suspects_.push_back(run);
    averaged_ = std::count(kind.begin(), kind.end(), averaged);
  }

  // Normals of the positions in these runs, zero elsewhere.
  void estimate() {
    positions_.setZero(3, n_);
    const Index neighbors = choose_neighbors(points_, tree_).neighbors,
                share = std::max<Index>(1, neighbors / shared_by);
    std::vector<std::pair<Index, Index>> parts;
    for (const Index run : suspects_)
      for (Index i = first(run); i < first(run + 1); i += share)
        parts.emplace_back(i, std::min(first(run + 1), i + share));
    parallel_for(std::ssize(parts), std::max<Index>(1, 512 / share), [&](Index begin, Index end) {
      Neighborhood neighborhood(points_, tree_);
      NeighborTable none;
      for (Index p = begin; p < end; ++p)
        fit_normals(points_, parts[p].first, parts[p].second, neighbors, neighborhood, positions_, none);
    });
  }

  // The given normal minus that of the positions, up to sign.
  [[nodiscard]] Point<3> residual(Index i) const {
    return towards(positions_.col(i), given_.col(i)) - positions_.col(i);
  }

  // As `difference`, but without what the positions explain.
  [[nodiscard]] double unexplained(Index i) const {
    const Point<3> n = given_.col(i), e = positions_.col(i), r = residual(i);
    SecondSmallest smallest;
    for (const std::uint32_t j : near_.of(i)) {
      double d2 = (towards(n, given_.col(j)) - n).squaredNorm();
      const double side = e.dot(positions_.col(j));
      if (side != 0) d2 = std::min(d2, ((side < 0 ? -1 : 1) * residual(j) - r).squaredNorm());
      smallest.add(d2);
    }
    return std::sqrt(smallest.get());
  }

  // The errors by the chords to the nearest neighbours: on a surface that bends evenly these are perpendicular to the
  // sum of the normals at both ends, however far they are turned.
  [[nodiscard]] double error_by_chords(Index run) const {
    std::vector<double> sums;
    const auto ends = static_cast<std::size_t>(std::min(near_.k, chord_neighbors));
    for (Index i = first(run); i < first(run + 1); ++i)
      for (const std::uint32_t j : near_.of(i).first(ends)) {
        const Point<3> n = given_.col(i), chord = points_.col(j) - points_.col(i);
        sums.push_back(std::abs((n + towards(n, given_.col(j))).dot(chord.normalized())));
      }
    return percentile(sums, lower_quartile) / quartile_of_sum;
  }

  // Corrected normals repeat the errors of their neighbours, which the fit cannot average out: where positions have
  // noise, it finds more in many independent errors.
  [[nodiscard]] static bool is_averaged_out(const Measured& run, double limit) {
    const double s = run.error.given, slope2 = run.by_chords * run.by_chords - s * s;  // of the positions
    return s < limit && s * s < per_noise * per_noise * slope2;
  }

  [[nodiscard]] Error measure(Index run) const {
    const Index begin = first(run), count = first(run + 1) - begin;
    std::vector<double> differences(count), distances(count);
    parallel_for(count, 64, [&](Index from, Index to) {
      for (Index k = from; k < to; ++k) {
        differences[k] = unexplained(begin + k);
        distances[k] = residual(begin + k).norm();
      }
    });
    const double given = percentile(differences, lower_quartile) / quartile_of_unit,
                 both = median(distances) / median_of_unit;
    return {given, std::sqrt(std::max(0.0, both * both - given * given))};
  }

  [[nodiscard]] Point<3> better(Index i, const Error& error) const {
    const Point<3> n = given_.col(i), e = towards(n, positions_.col(i));
    const double limit2 = 2 * explained * explained * (error.given * error.given + error.positions * error.positions);
    const bool consistent = e.squaredNorm() > 0 && (n - e).squaredNorm() < limit2;
    Point<3> sum = Point<3>::Zero();
    double count = 0;
    const auto add = [&](Index j) {
      const Point<3> ej = positions_.col(j);
      if (consistent && !(ej.squaredNorm() > 0)) return;
      const Point<3> g = towards(n, given_.col(j)), r = consistent ? Point<3>(g - towards(g, ej)) : g;
      if (consistent ? !(r.squaredNorm() < limit2) : !((g - n).squaredNorm() < 2 * limit2)) return;
      sum += r;
      ++count;
    };
    add(i);
    for (const std::uint32_t j : near_.of(i)) add(j);
    if (!consistent) return sum.normalized();
    const double t2 = error.positions * error.positions, s2 = error.given * error.given / count;
    return (e + t2 / (t2 + s2) / count * sum).normalized();
  }

  static constexpr Index shared_by = 16;  // neighbourhoods are shared by this share of their points

  const Points<3>& points_;
  const KdTree<3>& tree_;
  const NeighborTable& near_;
  const Points<3>& given_;
  Index n_;
  std::vector<Index> suspects_;
  std::ptrdiff_t averaged_ = 0;  // runs with errors that the fit averages out for certain
  Points<3> positions_;
};

// Turns normals that point against most neighbours on the same sheet; returns how many.
// Where normals have no other errors, none may agree: on thin blades exact ones look wrong, too.
Index turn_single(const Points<3>& points, const NeighborTable& near, bool strict, Points<3>& normals) {
  const Points<3> before = normals;
  const Contradictions contradictions(points, normals, near);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    std::vector<char> turn(normals.cols(), 0);
    parallel_for(normals.cols(), 1024, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i) {
        Index agree = 0, oppose = 0;
        for (const std::uint32_t j : near.of(i)) {
          agree += normals.col(i).dot(normals.col(j)) > Contradictions::same_side ? 1 : 0;
          oppose += contradictions.between(normals, i, j) ? 1 : 0;
        }
        turn[i] = oppose > 2 * agree && 3 * oppose >= near.k && (agree == 0 || !strict) ? 1 : 0;
      }
    });
    const auto count = std::count(turn.begin(), turn.end(), 1);
    if (count == 0) break;
    for (Index i = 0; i < normals.cols(); ++i)
      if (turn[i] != 0) normals.col(i) = -normals.col(i).eval();
  }
  Index turned = 0;
  for (Index i = 0; i < normals.cols(); ++i) turned += normals.col(i).dot(before.col(i)) < 0 ? 1 : 0;
  return turned;
}

}  // namespace

NormalCorrection correct_normals(const Points<3>& points, const KdTree<3>& tree, const NeighborTable& near,
                                 Points<3>& normals) {
  if (near.size() < fewest || near.k < 2) return {};
  const Points<3> given = normals;
  NormalCorrection result = Judge(points, tree, near, given).correct(normals);
  result.turned = turn_single(points, near, result.corrected == 0 && !result.some_left, normals);
  return result;
}

}  // namespace csrbf
