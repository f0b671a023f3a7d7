#include "csrbf/surface/tiles/tiled_field.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/taylor.hpp"

#include <limits>

namespace csrbf {
namespace {

using Expansion = Taylor<3>;

// Points of a block that one field is asked for, and its answers.
struct Question {
  std::vector<Index> ids;
  Jet<3> jet;

  void ask(const Field<3>& field, const PointsRef<3>& x, Derivatives derivatives) {
    const Points<3> points = x(Eigen::all, ids);
    jet = Jet<3>(points.cols(), derivatives);
    const auto data = [](auto& array) { return array.cols() > 0 ? array.data() : nullptr; };
    field.evaluate_block(points, {jet.value.data(), data(jet.gradient), data(jet.hessian)});
  }

  [[nodiscard]] Expansion expansion(Index k) const {
    Expansion result(jet.value[k]);
    if (jet.gradient.cols() > 0) result.gradient = jet.gradient.col(k);
    if (jet.hessian.cols() > 0) result.hessian = jet.hessian_matrix(k);
    return result;
  }
};

void store(const Expansion& f, Index i, const JetBlock& out) {
  out.value[i] = f.value;
  for (Index c = 0; c < 3 && out.gradient != nullptr; ++c) out.gradient[3 * i + c] = f.gradient[c];
  if (out.hessian == nullptr) return;
  for (Index c = 0, entry = 0; c < 3; ++c)
    for (Index d = c; d < 3; ++d, ++entry) out.hessian[6 * i + entry] = f.hessian(c, d);
}

// The weight of a tile: a product of steps across its faces.
Expansion weight(const Box<3>& box, double blend, const Point<3>& x) {
  Expansion w(1.0);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {1.0, -1.0}) {
      const double face = side > 0 ? box.lo[axis] : box.hi[axis];
      if (!std::isfinite(face)) continue;
      Expansion depth(0.5 + side * (x[axis] - face) / (2 * blend));
      depth.gradient[axis] = side / (2 * blend);
      w = w * smooth_step(depth);
    }
  return w;
}

// Answers where there is no field.
void store_nothing(const Question& question, const JetBlock& out) {
  Expansion nothing(std::numeric_limits<double>::quiet_NaN());
  for (const Index i : question.ids) store(nothing, i, out);
}

}  // namespace

TiledField::TiledField(TilePlan plan, std::vector<Tile> tiles, const Box<3>& bounds, double feature_size)
    : plan_(std::move(plan)), tiles_(std::move(tiles)), bounds_(bounds), feature_size_(feature_size) {
  require(std::ssize(tiles_) == plan_.size(), "TiledField", "tiles", tiles_.size(), "must be those of the plan");
}

Points<3> TiledField::seeds() const {
  std::vector<Point<3>> seeds;
  for (Index t = 0; t < plan_.size(); ++t) {
    if (tiles_[t].inside == nullptr) continue;
    const Points<3> all = tiles_[t].inside->seeds();
    for (Index i = 0; i < all.cols(); ++i)
      if (plan_.tile_of(all.col(i)) == t) seeds.emplace_back(all.col(i));
  }
  Points<3> result(3, std::ssize(seeds));
  for (Index i = 0; i < result.cols(); ++i) result.col(i) = seeds[i];
  return result;
}

void TiledField::evaluate_block(const PointsRef<3>& x, const JetBlock& out) const {
  std::vector<std::pair<Index, Question>> deep;  // by tile
  Question rim;
  Box<3> rim_box;
  for (Index i = 0; i < x.cols(); ++i) {
    const Index tile = plan_.tile_of(x.col(i));
    if (!plan_.is_deep(x.col(i), tile)) {
      rim.ids.push_back(i);
      rim_box.add(Point<3>(x.col(i)));
      continue;
    }
    auto found = std::find_if(deep.begin(), deep.end(), [&](const auto& entry) { return entry.first == tile; });
    if (found == deep.end()) found = deep.insert(deep.end(), {tile, {}});
    found->second.ids.push_back(i);
  }
  for (auto& [tile, question] : deep) {
    const Tile& fields = tiles_[tile];
    if (fields.inside == nullptr && fields.rim == nullptr) {
      store_nothing(question, out);
      continue;
    }
    question.ask(fields.inside != nullptr ? *fields.inside : *fields.rim, x, out.derivatives());
    for (std::size_t k = 0; k < question.ids.size(); ++k)
      store(question.expansion(static_cast<Index>(k)), question.ids[k], out);
  }
  if (rim.ids.empty()) return;

  std::vector<Expansion> sum(rim.ids.size()), total(rim.ids.size());
  for (const Index tile : plan_.tiles_in(rim_box.inflated(plan_.blend()))) {
    const Tile& fields = tiles_[tile];
    if (fields.inside == nullptr && fields.rim == nullptr) continue;
    Question question;
    std::vector<std::size_t> at;  // entries of `sum`
    std::vector<Expansion> weights;
    for (std::size_t k = 0; k < rim.ids.size(); ++k) {
      const Expansion w = weight(plan_.box(tile), plan_.blend(), x.col(rim.ids[k]));
      if (!(w.value > 0)) continue;
      question.ids.push_back(rim.ids[k]);
      weights.push_back(w);
      at.push_back(k);
    }
    if (at.empty()) continue;
    question.ask(fields.rim != nullptr ? *fields.rim : *fields.inside, x, out.derivatives());
    for (std::size_t k = 0; k < at.size(); ++k) {
      sum[at[k]] = sum[at[k]] + weights[k] * question.expansion(static_cast<Index>(k));
      total[at[k]] = total[at[k]] + weights[k];
    }
  }
  for (std::size_t k = 0; k < rim.ids.size(); ++k) store(sum[k] / total[k], rim.ids[k], out);
}

}  // namespace csrbf
