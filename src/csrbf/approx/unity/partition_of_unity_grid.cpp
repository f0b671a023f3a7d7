#include "csrbf/approx/unity/lane_sums.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/grid_tiles.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/batched_cholesky.hpp"

#include <algorithm>
#include <array>

namespace csrbf {
namespace {

// Chosen by hand: larger tiles enter fewer supports twice, smaller ones stay in the cache.
constexpr Index nodes_per_tile = 4096;
constexpr Index tasks = 64;  // at least, if there are as many tiles, to balance threads and processes

// Reduces a polynomial by its last variable once that is known: monomial j becomes monomial target[j] of the result
// times the last variable to the power[j].
struct Reduction {
  std::vector<std::int16_t> target, power;
  Index size = 0;  // of the result
};

template <int Dim>
std::array<Reduction, Dim> make_reductions(int degree) {
  std::array<Reduction, Dim> reductions;
  std::vector<std::array<int, Dim>> from;
  const Polynomials<Dim> basis(degree);
  for (Index j = 0; j < basis.size(); ++j) from.push_back(basis.exponents(j));
  for (std::size_t last = Dim; last-- > 1;) {
    std::vector<std::array<int, Dim>> to;
    Reduction& reduction = reductions[last];
    for (const auto& exponents : from) {
      auto rest = exponents;
      rest[last] = 0;
      auto at = std::find(to.begin(), to.end(), rest);
      if (at == to.end()) at = to.insert(to.end(), rest);
      reduction.target.push_back(static_cast<std::int16_t>(at - to.begin()));
      reduction.power.push_back(static_cast<std::int16_t>(exponents[last]));
    }
    reduction.size = static_cast<Index>(to.size());
    from = std::move(to);
  }
  return reductions;
}

// The sums over the supports at the nodes of a tile.
template <int Dim>
class GridEvaluation {
 public:
  GridEvaluation(const typename PartitionOfUnity<Dim>::Data& data, Index component, const GridAxes<Dim>& axes)
      : data_(data),
        component_(component),
        axes_(axes),
        evaluator_(data),
        reductions_(make_reductions<Dim>(data.models.degree)) {
    for (std::size_t a = 0; a < Dim; ++a)
      axes_[a] = axes_[a]
                     .cwiseMax(data.cover.box().lo[static_cast<Index>(a)])
                     .cwiseMin(data.cover.box().hi[static_cast<Index>(a)]);
  }

  void evaluate(const GridTiles<Dim>& tiles, const GridTile<Dim>& tile, double* value) {
    row_ = tile.size(0) + batch_lanes;  // the lanes of a row may reach beyond its end
    const auto rows = static_cast<std::size_t>(tile.nodes() / tile.size(0));
    W_.assign(rows * static_cast<std::size_t>(row_), 0.0);
    S_.assign(W_.size(), 0.0);
    Box<Dim> box;
    for (std::size_t a = 0; a < Dim; ++a) {
      box.lo[static_cast<Index>(a)] = axes_[a][tile.begin[a]];
      box.hi[static_cast<Index>(a)] = axes_[a][tile.end[a] - 1];
    }
    data_.cover.supports_over(box, supports_);
    for (const std::uint32_t support : supports_)
      if (enter(tile, support)) add_rows<Dim - 1>(coefficients_.data(), 1, 0);
    std::size_t at = 0;
    tiles.for_each_row(tile, [&](const std::array<Index, Dim>& /*node*/, Index first) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(tile.size(0)); ++k)
        value[first + static_cast<Index>(k)] = S_[at + k] / W_[at + k];
      at += static_cast<std::size_t>(row_);
    });
  }

 private:
  // The nodes inside a support along one axis: [begin, end) of the tile, their local coordinates and weights, padded
  // with nodes of weight 0.
  struct Range {
    Index begin, end, stride;
    std::vector<double> x, q, weight;
  };

  // Prepares a support; false when none of its nodes is in the tile.
  bool enter(const GridTile<Dim>& tile, std::uint32_t support) {
    support_ = support;
    const Box<Dim>& cell = data_.cover.cell(support);
    const double inverse = 1 / data_.models.radius[support];
    Index stride = 1;
    for (std::size_t a = 0; a < Dim; ++a) {
      Range& range = ranges_[a];
      const auto axis = static_cast<Index>(a);
      const double center = cell.center()[axis], half = 0.5 * data_.cover.growth() * cell.extent()[axis];
      const double* x = axes_[a].data() + tile.begin[a];
      range.begin = std::upper_bound(x, x + tile.size(static_cast<int>(a)), center - half) - x;
      range.end = std::lower_bound(x + range.begin, x + tile.size(static_cast<int>(a)), center + half) - x;
      if (range.begin == range.end) return false;
      range.stride = stride;
      stride *= a == 0 ? row_ : tile.size(static_cast<int>(a));
      const Index n = range.end - range.begin;
      const auto padded = static_cast<std::size_t>((n + batch_lanes - 1) / batch_lanes * batch_lanes);
      range.x.assign(padded, x[range.begin]);
      range.q.assign(padded, 0.0);
      range.weight.assign(padded, 0.0);
      for (Index k = 0; k < n; ++k) {
        const auto at = static_cast<std::size_t>(k);
        range.x[at] = x[range.begin + k];
        range.q[at] = (range.x[at] - data_.models.center(axis, support)) * inverse;
        const double t = (range.x[at] - center) / half, square = 1 - t * t;
        range.weight[at] = square * square * square * square;
      }
    }
    const Index Q = data_.models.polynomial_size();
    const double* c = data_.models.polynomial.data() + (support * data_.models.components + component_) * Q;
    coefficients_.assign(c, c + Q);
    return true;
  }

  // For every node along axis A, with the polynomial in the coordinates up to A and the weight of those above.
  template <int A>
  void add_rows(const double* c, double weight, Index offset) {
    const Range& range = ranges_[A];
    if constexpr (A == 0) {
      add_row(c, weight, offset + range.begin);
    } else {
      const Reduction& reduction = reductions_[A];
      std::vector<double>& reduced = reduced_[A];
      for (Index k = range.begin; k < range.end; ++k) {
        const auto at = static_cast<std::size_t>(k - range.begin);
        const double q = range.q[at];
        double powers[32];
        powers[0] = 1;
        for (int p = 1; p <= data_.models.degree; ++p) powers[p] = powers[p - 1] * q;
        reduced.assign(reduction.size, 0.0);
        for (std::size_t j = 0; j < reduction.target.size(); ++j)
          reduced[reduction.target[j]] += c[j] * powers[reduction.power[j]];
        node_[A] = range.x[at];
        add_rows<A - 1>(reduced.data(), weight * range.weight[at], offset + k * range.stride);
      }
    }
  }

  void add_row(const double* c, double weight, Index offset) {
    const Range& range = ranges_[0];
    const auto padded = static_cast<Index>(range.q.size());
    double *W = W_.data() + offset, *S = S_.data() + offset;
    if (data_.models.centers_each == 0 && !data_.is_wide(support_)) {
      lane_sums::add_row(range.q.data(), range.weight.data(), padded, c, data_.models.degree, weight, W, S);
      return;
    }
    for (Index begin = 0; begin < padded; begin += batch_lanes) {
      for (Index a = 0; a < Dim; ++a)
        for (Index l = 0; l < batch_lanes; ++l) lane_x_[batch_lanes * a + l] = a == 0 ? range.x[begin + l] : node_[a];
      evaluator_.evaluate(support_, component_, lane_x_, Derivatives::none, &f_);
      for (Index l = 0; l < batch_lanes; ++l) {
        const double w = weight * range.weight[begin + l];
        W[begin + l] += w;
        S[begin + l] += w * f_[l];
      }
    }
  }

  const typename PartitionOfUnity<Dim>::Data& data_;
  Index component_;
  GridAxes<Dim> axes_;  // moved into the box
  SupportEvaluator<Dim> evaluator_;
  std::array<Reduction, Dim> reductions_;
  std::array<Range, Dim> ranges_;
  std::array<std::vector<double>, Dim> reduced_;
  std::array<double, Dim> node_{};
  std::vector<double> coefficients_, W_, S_;
  std::vector<std::uint32_t> supports_;
  std::uint32_t support_ = 0;
  Index row_ = 0;  // from one row of W and S to the next
  alignas(64) double lane_x_[Dim * batch_lanes];
  alignas(64) double f_[batch_lanes];
};

bool ascends(const Eigen::VectorXd& x) {
  return std::is_sorted(x.data(), x.data() + x.size()) && x.allFinite();
}

}  // namespace

template <int Dim>
Eigen::VectorXd PartitionOfUnity<Dim>::evaluate_grid(const GridAxes<Dim>& axes) const {
  if (!std::all_of(axes.begin(), axes.end(), ascends)) return Field<Dim>::evaluate_grid(axes);
  const GridTiles<Dim> tiles(axes, nodes_per_tile);
  Eigen::VectorXd value(tiles.nodes());
  if (value.size() == 0) return value;
  const Index grain = std::max<Index>(1, tiles.size() / tasks);
  const auto compute = [&](Index begin, Index end) {
    GridEvaluation<Dim> evaluation(*data_, component_, axes);
    for (Index i = begin; i < end; ++i) evaluation.evaluate(tiles, tiles[i], value.data());
  };
  parallel_for(tiles.size(), grain, compute);
  return value;
}

#define CSRBF_INSTANTIATE(Dim) \
  template Eigen::VectorXd PartitionOfUnity<Dim>::evaluate_grid(const GridAxes<Dim>& axes) const;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
