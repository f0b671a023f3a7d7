#include "csrbf/surface/composite/join_pieces.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double on_surface = 0.05;  // of the radius: largest distance of a sample from the surface that it supports
constexpr double enough = 0.9;       // least weighted share of samples on the surface

// Values of all pieces at the samples of one of them.
struct Values {
  std::size_t own = 0;
  Eigen::MatrixXd value;   // samples x pieces
  Eigen::VectorXd weight;  // of the samples
};

double joined(double a, double b, Join join) {
  return join == Join::intersection ? std::min(a, b) : std::max(a, b);
}

// Whether two pieces are one surface with different normals: they bound no solid.
bool coincide(const Values& a, const Values& b) {
  const auto distance = [](const Values& from, std::size_t to) {
    return from.value.col(static_cast<Index>(to)).cwiseAbs().dot(from.weight) / from.weight.sum();
  };
  return distance(a, b.own) < on_surface && distance(b, a.own) < on_surface;
}

struct Order {
  std::vector<std::size_t> pieces;
  std::vector<Join> joins;  // the first is not used
  double share = -1;        // of samples on the surface
};

// Weighted share of samples where the joined value is that of their own piece.
double share_on_surface(const std::vector<Values>& all, const Order& order) {
  double on = 0, total = 0;
  for (const Values& values : all) {
    if (std::find(order.pieces.begin(), order.pieces.end(), values.own) == order.pieces.end()) continue;
    const auto own = static_cast<Index>(values.own);
    for (Index k = 0; k < values.value.rows(); ++k) {
      double f = values.value(k, static_cast<Index>(order.pieces[0]));
      for (std::size_t p = 1; p < order.pieces.size(); ++p)
        f = joined(f, values.value(k, static_cast<Index>(order.pieces[p])), order.joins[p]);
      total += values.weight[k];
      if (std::abs(f - values.value(k, own)) <= on_surface) on += values.weight[k];
    }
  }
  return total > 0 ? on / total : 0;
}

// The best order of the pieces with all ways to join them.
Order best_order(const std::vector<Values>& all, std::vector<std::size_t> pieces) {
  Order best;
  std::sort(pieces.begin(), pieces.end());
  do {
    if (pieces.size() > 1 && pieces[0] > pieces[1]) continue;  // the first two commute
    for (unsigned code = 0; code < (1U << (pieces.size() - 1)); ++code) {
      Order order{pieces, {Join::first}, 0};
      for (std::size_t p = 1; p < pieces.size(); ++p)
        order.joins.push_back((code >> (p - 1) & 1U) != 0 ? Join::unite : Join::intersection);
      order.share = share_on_surface(all, order);
      if (order.share > best.share) best = std::move(order);
    }
  } while (std::next_permutation(pieces.begin(), pieces.end()));
  return best;
}

}  // namespace

std::vector<std::size_t> join_pieces(std::vector<FittedPiece>& pieces, const std::vector<Points<3>>& samples) {
  std::vector<Values> all(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Points<3>& q = samples[p];
    all[p] = {p, Eigen::MatrixXd(q.cols(), std::ssize(pieces)), Eigen::VectorXd(q.cols())};
    all[p].weight = (1 - q.colwise().squaredNorm().array()).max(0.0).square().matrix().transpose();
    const Eigen::MatrixX3d rows = q.transpose();
    for (std::size_t other = 0; other < pieces.size(); ++other)
      all[p].value.col(static_cast<Index>(other)) = pieces[other].evaluate(rows).col(0);
  }
  std::vector<std::size_t> kept = {0};
  for (std::size_t p = 1; p < pieces.size(); ++p)
    if (!coincide(all[0], all[p])) kept.push_back(p);
  Order best = best_order(all, kept);
  while (best.share < enough && kept.size() > 1) {
    Order without;
    for (std::size_t dropped = 1; dropped < kept.size(); ++dropped) {
      std::vector<std::size_t> rest = kept;
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(dropped));
      Order order = best_order(all, rest);
      if (order.share > without.share) without = std::move(order);
    }
    best = std::move(without);
    kept = best.pieces;
    std::sort(kept.begin(), kept.end());
  }
  std::vector<FittedPiece> ordered;
  for (std::size_t p = 0; p < best.pieces.size(); ++p) {
    ordered.push_back(std::move(pieces[best.pieces[p]]));
    ordered.back().patch.join = best.joins[p];
  }
  pieces = std::move(ordered);
  return best.pieces;
}

}  // namespace csrbf
