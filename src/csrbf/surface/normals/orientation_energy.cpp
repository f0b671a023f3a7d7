#include "csrbf/surface/normals/orientation_energy.hpp"

#include "csrbf/spatial/morton_order.hpp"
#include "csrbf/surface/winding/winding_sum.hpp"

namespace csrbf::orientation {
namespace {

// All chosen by hand.
constexpr double least_sampled = 1500;      // in total at least ...
constexpr Index points_per_cluster = 6;     // ... and of each cluster; more: slower, less random
constexpr double distances[] = {2, 8, 32};  // of the probes, in spacings: clusters of every size act at one of them
constexpr Index probes_per_point = 7;       // one on the surface, one on each side at every distance
constexpr double surface_share = 0.5;       // weight of the probes on it: random signs give w = 0, ideal for all others
constexpr double vote_weight = 5;         // of neighbours against the energy, which noise changes like a small cluster
constexpr double vote_in_unevenness = 2;  // ... against the unevenness; 0.5 gave the same signs
constexpr Index sample_neighbors = 12;    // between which that is measured
constexpr double largest_body = 0.5;      // share of the surface: of a room with furniture, the walls are more
constexpr double loosely = 0.2;           // neighbours over the square root of the points of a body; else 2 and more
constexpr double least_gain = 1e-6;       // decrease of the energy that counts: single precision has 1e-7
constexpr int max_sweeps = 12;            // over all moves: bounds time

using Members = std::vector<std::vector<Index>>;

// Some points of every cluster, at regular intervals in its order; weights are shares of the area.
struct Sample {
  std::vector<Index> points;
  std::vector<std::int32_t> clusters;
  std::vector<double> weights;
};

Sample draw(const NeighborTable& table, const Members& members) {
  std::vector<double> areas(members.size(), 0);
  double total = 0;
  for (std::size_t c = 0; c < members.size(); ++c) {
    for (const Index i : members[c]) areas[c] += table.area(i);
    total += areas[c];
  }
  Sample sample;
  for (std::size_t c = 0; c < members.size(); ++c) {
    const auto available = static_cast<Index>(members[c].size());
    const auto share = static_cast<Index>(std::ceil(least_sampled * areas[c] / total));
    const Index count = std::min(available, std::max(points_per_cluster, share));
    for (Index k = 0; k < count; ++k) {
      sample.points.push_back(members[c][(2 * k + 1) * available / (2 * count)]);
      sample.clusters.push_back(static_cast<std::int32_t>(c));
      sample.weights.push_back(areas[c] / total / static_cast<double>(count));
    }
  }
  return sample;
}

float well(float w, bool on_surface) {
  const float off = on_surface ? w - 0.5F : std::min(std::abs(w), std::abs(w - 1));
  return 4 * off * off;
}

// The cluster and everything below it in the tree.
Members subtrees(const std::vector<std::int32_t>& parent) {
  Members below(parent.size());
  for (std::size_t c = parent.size(); c-- > 0;) {
    below[c].push_back(static_cast<Index>(c));
    if (parent[c] < 0) continue;
    auto& up = below[parent[c]];
    up.insert(up.end(), below[c].begin(), below[c].end());
  }
  return below;
}

}  // namespace

Energy::Energy(const Points<3>& points, const Points<3>& normals, const NeighborTable& table, const Graph& graph,
               const Clusters& clusters) {
  Members members(static_cast<std::size_t>(clusters.size()));
  for (Index i = 0; i < points.cols(); ++i)
    if (const std::int32_t c = clusters.of[i]; c >= 0) members[c].push_back(i);
  const Sample sample = draw(table, members);

  // Probes on the surface, then the others along a Morton curve.
  on_surface_ = std::ssize(sample.points);
  cluster_ = sample.clusters;
  Points<3> probes(3, probes_per_point * on_surface_);
  for (Index s = 0; s < on_surface_; ++s) {
    const Index i = sample.points[s];
    const double spacing = std::sqrt(table.area(i));
    probes.col(s) = points.col(i);
    Index block = 1;
    for (const double distance : distances)
      for (const double side : {1.0, -1.0})
        probes.col(on_surface_ * block++ + s) = points.col(i) + side * distance * spacing * normals.col(i);
  }
  const Points<3> on_surface = probes.leftCols(on_surface_);
  samples_ = make_neighbor_table(on_surface, KdTree<3>(on_surface), sample_neighbors);
  const std::vector<Index> order = morton_order<3>(probes.rightCols(probes.cols() - on_surface_));
  Points<3> sorted = probes;
  weight_.resize(probes.cols());
  for (Index k = 0; k < probes.cols(); ++k) {
    const Index from = k < on_surface_ ? k : on_surface_ + order[k - on_surface_];
    sorted.col(k) = probes.col(from);
    const double share = k < on_surface_ ? surface_share : (1 - surface_share) / (probes_per_point - 1);
    weight_[k] = static_cast<float>(share * sample.weights[from % on_surface_]);
  }
  sum_winding(sorted, points, normals, table, clusters, members);
  count_votes(points, normals, graph, clusters);
  for (Index c = 0; c < clusters.size(); ++c) moves_.push_back({c});
  for (auto& subtree : subtrees(clusters.parent))
    if (subtree.size() > 1) moves_.push_back(std::move(subtree));
}

void Energy::sum_winding(const Points<3>& probes, const Points<3>& points, const Points<3>& normals,
                         const NeighborTable& table, const Clusters& clusters, const Members& members) {
  winding_.resize(probes.cols(), std::ssize(members));
  for (Index c = 0; c < winding_.cols(); ++c) {
    const Index size = std::ssize(members[c]);
    winding::Samples samples{Points<3>(3, size), Points<3>(3, size), Eigen::VectorXd(size), Eigen::VectorXd(size)};
    for (Index k = 0; k < size; ++k) {
      const Index i = members[c][k];
      samples.points.col(k) = points.col(i);
      samples.normals.col(k) = clusters.sign[i] * normals.col(i);
      samples.areas[k] = table.area(i);
      samples.eps[k] = std::sqrt(samples.areas[k]);
    }
    winding_.col(c) =
        winding::sum_at(winding::make_tree({samples.points, samples.normals, samples.areas, samples.eps}), probes);
  }
}

void Energy::count_votes(const Points<3>& points, const Points<3>& normals, const Graph& graph,
                         const Clusters& clusters) {
  votes_.setZero(clusters.size(), clusters.size());
  std::vector<double> sizes(clusters.size(), 0);
  for (const std::int32_t c : clusters.of)
    if (c >= 0) sizes[c] += 1;
  const double share = 1 / static_cast<double>(std::max<std::size_t>(1, graph.near));
  loose_ = loosely * share * std::sqrt(static_cast<double>(points.cols()));
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const auto [a, b] = graph.edges[e];
    const std::int32_t ca = clusters.of[a], cb = clusters.of[b];
    if (ca == cb) continue;
    double vote = share * std::max(0.0, 1 - cost(points.col(a), normals.col(a), points.col(b), normals.col(b)));
    // A bridge represents the pairs that would be neighbours if the smaller side were as close as its own points are.
    if (e >= graph.near) vote *= 3 * std::sqrt(std::min(sizes[ca], sizes[cb]));
    if (normals.col(a).dot(normals.col(b)) < 0) vote = -vote;
    vote *= clusters.sign[a] * clusters.sign[b];
    votes_(ca, cb) += vote;
    votes_(cb, ca) += vote;
  }
}

Eigen::VectorXf Energy::winding(const Signs& signs) const {
  Eigen::VectorXf w = Eigen::VectorXf::Zero(winding_.rows());
  for (Index c = 0; c < winding_.cols(); ++c) w += static_cast<float>(signs[c]) * winding_.col(c);
  return w;
}

double Energy::of_winding(const Eigen::VectorXf& w) const {
  // Noise inflates the areas by some factor: undo the one that makes w = 1/2 on the surface, within [0.3, 1.5].
  double w1 = 0, w2 = 0;
  for (Index s = 0; s < on_surface_; ++s) {
    w1 += weight_[s] * w[s];
    w2 += weight_[s] * w[s] * w[s];
  }
  const auto scale = static_cast<float>(std::clamp(w2 > 0 ? 0.5 * std::abs(w1) / w2 : 1.0, 0.3, 1.5));
  double sum = 0;
  for (Index s = 0; s < w.size(); ++s) sum += weight_[s] * well(scale * w[s], s < on_surface_);
  return sum;
}

double Energy::of(const Signs& signs) const {
  return of_winding(winding(signs));
}

double Energy::mean_winding(const Signs& signs) const {
  return static_cast<double>(weight_.head(on_surface_).dot(winding(signs).head(on_surface_))) / surface_share;
}

void Energy::turn_each_outward(Signs& signs, double least) const {
  std::vector<double> sum(signs.size(), 0), total(signs.size(), 0);
  for (Index s = 0; s < on_surface_; ++s) {
    const std::int32_t c = cluster_[s];
    sum[c] += weight_[s] * winding_(s, c);
    total[c] += weight_[s];
  }
  for (std::size_t c = 0; c < signs.size(); ++c)
    if (std::abs(sum[c]) > least * total[c]) signs[c] = sum[c] < 0 ? -1 : 1;
}

bool Energy::turn_bodies_outward(Signs& signs, double least) const {
  bool turned = false;
  for (const std::vector<Index>& body : moves_) {
    std::vector<char> in(signs.size(), 0);
    Eigen::VectorXf w = Eigen::VectorXf::Zero(on_surface_);
    double joining = 0, sum = 0, share = 0;
    for (const Index c : body) {
      in[c] = 1;
      w += static_cast<float>(signs[c]) * winding_.col(c).head(on_surface_);
    }
    for (const Index c : body)
      for (std::size_t d = 0; d < signs.size(); ++d)
        if (in[d] == 0) joining += std::max(0.0, signs[c] * signs[d] * votes_(c, static_cast<Index>(d)));
    for (Index s = 0; s < on_surface_; ++s) {
      if (in[cluster_[s]] == 0) continue;
      sum += weight_[s] * w[s];
      share += weight_[s] / surface_share;
    }
    if (!(sum < -least * surface_share * share && share < largest_body && joining < loose_ * std::sqrt(share)))
      continue;
    Signs other = signs;
    for (const Index c : body) other[c] = static_cast<signed char>(-signs[c]);
    if (unevenness(other) > unevenness(signs)) continue;
    signs = std::move(other);
    turned = true;
  }
  return turned;
}

void Energy::descend(Signs& signs) const {
  Signs opposite = signs;
  for (signed char& sign : opposite) sign = static_cast<signed char>(-sign);
  if (descend_from(opposite) < descend_from(signs)) signs = opposite;
}

double Energy::descend_from(Signs& signs) const {
  return descend_by([&](const Eigen::VectorXf& w) { return of_winding(w); }, vote_weight, signs);
}

void Energy::even_out(Signs& signs) const {
  descend_by([&](const Eigen::VectorXf& w) { return unevenness_of(w); }, vote_in_unevenness, signs);
}

double Energy::unevenness_of(const Eigen::VectorXf& w) const {
  double sum = 0;
  for (Index s = 0; s < on_surface_; ++s)
    for (const std::uint32_t other : samples_.of(s)) {
      const double step = w[s] - w[other];
      sum += weight_[s] * step * step;
    }
  return sum / (surface_share * static_cast<double>(samples_.k));
}

double Energy::unevenness(const Signs& signs) const {
  return unevenness_of(winding(signs));
}

template <class Measure>
double Energy::descend_by(const Measure& measure, double weight_of_votes, Signs& signs) const {
  Eigen::VectorXf w = winding(signs), turned(w.size());
  double energy = measure(w);
  std::vector<char> moves(signs.size());
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    bool improved = false;
    for (const std::vector<Index>& move : moves_) {
      std::fill(moves.begin(), moves.end(), char{0});
      for (const Index c : move) moves[c] = 1;
      turned = w;
      double lost = 0;
      for (const Index c : move) {
        const int sign = signs[c];
        turned -= static_cast<float>(2 * sign) * winding_.col(c);
        for (std::size_t d = 0; d < signs.size(); ++d)
          if (moves[d] == 0) lost += sign * signs[d] * votes_(c, static_cast<Index>(d));
      }
      const double after = measure(turned);
      if (!(after + weight_of_votes * lost < energy - least_gain)) continue;
      w = turned;
      energy = after;
      improved = true;
      for (const Index c : move) signs[c] = static_cast<signed char>(-signs[c]);
    }
    if (!improved) break;
  }
  return energy;
}

}  // namespace csrbf::orientation
