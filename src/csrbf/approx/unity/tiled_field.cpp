#include "csrbf/approx/unity/tiled_field.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/taylor.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <limits>

namespace csrbf {
namespace {

template <int Dim>
using Expansion = Taylor<Dim>;

// Points of a block that one field is asked for, and its answers.
template <int Dim>
struct Question {
  std::vector<Index> ids;
  Jet<Dim> jet;

  void ask(const Field<Dim>& field, const PointsRef<Dim>& x, Derivatives derivatives) {
    const Points<Dim> points = x(Eigen::all, ids);
    jet = Jet<Dim>(points.cols(), derivatives);
    const auto data = [](auto& array) { return array.cols() > 0 ? array.data() : nullptr; };
    field.evaluate_block(points, {jet.value.data(), data(jet.gradient), data(jet.hessian)});
  }

  [[nodiscard]] Expansion<Dim> expansion(Index k) const {
    Expansion<Dim> result(jet.value[k]);
    if (jet.gradient.cols() > 0) result.gradient = jet.gradient.col(k);
    if (jet.hessian.cols() > 0) result.hessian = jet.hessian_matrix(k);
    return result;
  }
};

template <int Dim>
void store(const Expansion<Dim>& f, Index i, const JetBlock& out) {
  out.value[i] = f.value;
  for (Index c = 0; c < Dim && out.gradient != nullptr; ++c) out.gradient[Dim * i + c] = f.gradient[c];
  if (out.hessian == nullptr) return;
  for (Index c = 0, entry = 0; c < Dim; ++c)
    for (Index d = c; d < Dim; ++d, ++entry) out.hessian[symmetric_size<Dim> * i + entry] = f.hessian(c, d);
}

// The weight of a tile: a product of steps across its faces.
template <int Dim>
Expansion<Dim> weight(const Box<Dim>& box, double blend, const Point<Dim>& x) {
  Expansion<Dim> w(1.0);
  for (int axis = 0; axis < Dim; ++axis)
    for (const double side : {1.0, -1.0}) {
      const double face = side > 0 ? box.lo[axis] : box.hi[axis];
      if (!std::isfinite(face)) continue;
      Expansion<Dim> depth(0.5 + side * (x[axis] - face) / (2 * blend));
      depth.gradient[axis] = side / (2 * blend);
      w = w * smooth_step(depth);
    }
  return w;
}

// Answers where there is no field.
template <int Dim>
void store_nothing(const Question<Dim>& question, const JetBlock& out) {
  Expansion<Dim> nothing(std::numeric_limits<double>::quiet_NaN());
  for (const Index i : question.ids) store<Dim>(nothing, i, out);
}

}  // namespace

template <int Dim>
TiledField<Dim>::TiledField(TilePlan<Dim> plan, std::vector<Tile> tiles, const Box<Dim>& bounds, double feature_size)
    : plan_(std::move(plan)), tiles_(std::move(tiles)), bounds_(bounds), feature_size_(feature_size) {
  require(std::ssize(tiles_) == plan_.size(), "TiledField", "tiles", tiles_.size(), "must be those of the plan");
  whole_tiles_ = std::count_if(tiles_.begin(), tiles_.end(), [](const Tile& t) { return t.inside != nullptr; });
}

template <int Dim>
Points<Dim> TiledField<Dim>::seeds() const {
  std::vector<Point<Dim>> seeds;
  for (Index t = 0; t < plan_.size(); ++t) {
    if (tiles_[t].inside == nullptr) continue;
    const Points<Dim> all = tiles_[t].inside->seeds();
    for (Index i = 0; i < all.cols(); ++i)
      if (plan_.tile_of(all.col(i)) == t) seeds.emplace_back(all.col(i));
  }
  Points<Dim> result(3, std::ssize(seeds));
  for (Index i = 0; i < result.cols(); ++i) result.col(i) = seeds[i];
  return result;
}

template <int Dim>
double TiledField<Dim>::least_persistence() const {
  double largest = 0;
  for (const Tile& tile : tiles_)
    for (const auto* field : {&tile.inside, &tile.rim})
      if (*field != nullptr) largest = std::max(largest, (*field)->least_persistence());
  return largest;
}

template <int Dim>
std::vector<Index> TiledField<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  if (whole_tiles_ < 2) return {};
  const std::vector<Index> along_curve = rough_morton_order<Dim>(x);
  std::vector<std::vector<Index>> by_tile(static_cast<std::size_t>(plan_.size()));
  for (const Index i : along_curve) by_tile[static_cast<std::size_t>(plan_.tile_of(x.col(i)))].push_back(i);
  std::vector<Index> order;
  order.reserve(along_curve.size());
  for (const std::vector<Index>& ids : by_tile) order.insert(order.end(), ids.begin(), ids.end());
  return order;
}

template <int Dim>
void TiledField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  std::vector<std::pair<Index, Question<Dim>>> deep;  // by tile
  Question<Dim> rim;
  Box<Dim> rim_box;
  for (Index i = 0; i < x.cols(); ++i) {
    const Index tile = plan_.tile_of(x.col(i));
    if (!plan_.is_deep(x.col(i), tile)) {
      rim.ids.push_back(i);
      rim_box.add(Point<Dim>(x.col(i)));
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
    if (std::ssize(question.ids) == x.cols()) {
      (fields.inside != nullptr ? *fields.inside : *fields.rim).evaluate_block(x, out);
      return;
    }
    question.ask(fields.inside != nullptr ? *fields.inside : *fields.rim, x, out.derivatives());
    for (std::size_t k = 0; k < question.ids.size(); ++k)
      store<Dim>(question.expansion(static_cast<Index>(k)), question.ids[k], out);
  }
  if (rim.ids.empty()) return;

  std::vector<Expansion<Dim>> sum(rim.ids.size()), total(rim.ids.size());
  for (const Index tile : plan_.tiles_in(rim_box.inflated(plan_.blend()))) {
    const Tile& fields = tiles_[tile];
    if (fields.inside == nullptr && fields.rim == nullptr) continue;
    Question<Dim> question;
    std::vector<std::size_t> at;  // entries of `sum`
    std::vector<Expansion<Dim>> weights;
    for (std::size_t k = 0; k < rim.ids.size(); ++k) {
      const Expansion<Dim> w = weight<Dim>(plan_.box(tile), plan_.blend(), x.col(rim.ids[k]));
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
  for (std::size_t k = 0; k < rim.ids.size(); ++k) store<Dim>(sum[k] / total[k], rim.ids[k], out);
}

#define CSRBF_INSTANTIATE(Dim) template class TiledField<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
