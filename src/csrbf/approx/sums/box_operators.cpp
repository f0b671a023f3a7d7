#include "csrbf/approx/sums/box_operators.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/linalg/panel_product.hpp"
#include "csrbf/spatial/squared_distances.hpp"

#include <algorithm>
#include <random>

namespace csrbf {
namespace {

// Chosen by hand.
constexpr int largest_orders[] = {20, 14, 10};  // in 1, 2 and 3 dimensions: up to 1000 nodes
constexpr double interpolation_share = .2;      // of the tolerance, root mean square: both boxes are interpolated in
constexpr double truncation_share = .5;         // of the tolerance
constexpr double compact_share = .25;           // for kernels with an edge, where errors add up in few boxes
constexpr double largest_error = 4;             // of interpolation, in units of the tolerance: at the edge of a support
constexpr double negligible_share = 1e-3;       // of the tolerance: many such boxes may add up
constexpr Index test_points = 40;               // per box, for the error of interpolation
constexpr Index basis_samples = 1500;           // far points that the basis is made for, about

// Boxes between two boxes along the axis on which they are farthest.
template <std::size_t Dim>
int largest(const std::array<int, Dim>& offset) {
  return *std::max_element(offset.begin(), offset.end());
}

// Rows of the nodes of one slab, padded.
template <int Dim>
Index slab_rows(int order) {
  Index rows = 1;
  for (int d = 1; d < Dim; ++d) rows *= order;
  return padded_rows(rows);
}

// Calls use(row, digits) for every node.
template <int Dim, class Use>
void for_each_node(int order, const Use& use) {
  const Index slab = slab_rows<Dim>(order);
  Index rest = 1;
  for (int d = 1; d < Dim; ++d) rest *= order;
  std::array<int, Dim> digits{};
  for (int first = 0; first < order; ++first) {
    digits[0] = first;
    for (Index k = 0; k < rest; ++k) {
      Index left = k;
      for (int d = 1; d < Dim; ++d, left /= order) digits[d] = static_cast<int>(left % order);
      use(slab * first + k, digits);
    }
  }
}

// Points spread over the box [-1, 1]^Dim.
template <int Dim>
Points<Dim> spread_points(Index count) {
  Points<Dim> x(Dim, count);
  std::mt19937_64 random(1);  // its sequence is fixed by the standard
  for (Index i = 0; i < count; ++i)
    for (int d = 0; d < Dim; ++d) x(d, i) = 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1;
  return x;
}

// Interpolation from the nodes (columns, padded) at points (rows) of the box.
template <int Dim>
Eigen::MatrixXd interpolation(const Chebyshev& chebyshev, const Points<Dim>& x) {
  std::array<Eigen::MatrixXd, Dim> axis;
  for (int d = 0; d < Dim; ++d) axis[d] = chebyshev.lagrange(x.row(d).transpose());
  const int p = chebyshev.order();
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(x.cols(), p * slab_rows<Dim>(p));
  for_each_node<Dim>(p, [&](Index row, const std::array<int, Dim>& digits) {
    S.col(row) = axis[0].col(digits[0]);
    for (int d = 1; d < Dim; ++d) S.col(row).array() *= axis[d].col(digits[d]).array();
  });
  return S;
}

// Splits functions of the nodes of a box into parts that are even or odd in each coordinate, (f(x) +- f(x')) / sqrt 2
// with x' the mirror image of x: an orthogonal transform.
template <int Dim>
class Parities {
 public:
  explicit Parities(int order) {
    std::vector<std::array<int, Dim>> digits;
    std::vector<Index> row;
    for_each_node<Dim>(order, [&](Index at, const std::array<int, Dim>& of_node) {
      row.push_back(at);
      digits.push_back(of_node);
    });
    // Where a node and its mirror image are two, the even part takes the place of the first, the odd that of the other.
    const auto parity = [&](Index k) {
      unsigned odd = 0;
      for (int d = 0; d < Dim; ++d) odd |= (2 * digits[k][d] > order - 1 ? 1U : 0U) << d;
      return odd;
    };
    std::map<std::array<int, Dim>, Index> place;
    for (unsigned odd = 0; odd < (1U << Dim); ++odd) {
      begin_[odd] = std::ssize(node_);
      for (Index k = 0; k < std::ssize(row); ++k) {
        if (parity(k) != odd) continue;
        place[digits[k]] = std::ssize(node_);
        node_.push_back(row[k]);
      }
    }
    begin_.back() = std::ssize(node_);
    for (const auto& [at, k] : place)
      for (int d = 0; d < Dim; ++d) {
        std::array<int, Dim> image = at;
        image[d] = order - 1 - at[d];
        if (at[d] < image[d]) mirrored_[d].emplace_back(k, place.at(image));
      }
  }

  /// The nodes, as rows of BoxOperators::nodes(): those of the combination `odd` of odd axes from begin(odd) on.
  [[nodiscard]] const std::vector<Index>& nodes() const { return node_; }
  [[nodiscard]] Index begin(unsigned odd) const { return begin_[odd]; }
  [[nodiscard]] Index count(unsigned odd) const { return begin_[odd + 1] - begin_[odd]; }

  /// Transforms the columns of A, functions of nodes().
  void columns(Eigen::MatrixXd& A) const {
    const double half = std::sqrt(.5);
    for (Index j = 0; j < A.cols(); ++j)
      for (const auto& pairs : mirrored_)
        for (const auto& [first, second] : pairs) {
          const double a = A(first, j), b = A(second, j);
          A(first, j) = half * (a + b);
          A(second, j) = half * (a - b);
        }
  }

  /// Back: each step along an axis is its own inverse, and they commute.
  void merge(Eigen::MatrixXd& A) const { columns(A); }

  /// The same for its rows.
  void rows(Eigen::MatrixXd& A) const {
    const double half = std::sqrt(.5);
    for (const auto& pairs : mirrored_)
      for (const auto& [first, second] : pairs)
        for (Index i = 0; i < A.rows(); ++i) {
          const double a = A(i, first), b = A(i, second);
          A(i, first) = half * (a + b);
          A(i, second) = half * (a - b);
        }
  }

 private:
  std::vector<Index> node_;
  std::array<Index, (1U << Dim) + 1> begin_{};
  std::array<std::vector<std::pair<Index, Index>>, Dim> mirrored_{};
};

// A B with A padded.
Eigen::MatrixXd product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(A.rows(), B.cols());
  panel_product(A.data(), A.rows(), A.cols(), B.data(), B.rows(), B.cols(), C.data());
  return C;
}

struct BasisFunction {
  double singular_value;
  unsigned odd;
  Eigen::VectorXd values;  // at the nodes of this parity
  Eigen::VectorXd energy;  // mean square of its part in each box, over points and nodes
};

// Those of one parity. `Y`: far points, every `stride`-th of the boxes' test points, x functions at the nodes.
void add_functions(const Eigen::MatrixXd& Y, unsigned odd, Index stride, const Eigen::ArrayXd& points_in,
                   std::vector<BasisFunction>& functions) {
  Eigen::MatrixXd R = Y;
  if (Y.rows() > Y.cols())
    R = Eigen::HouseholderQR<Eigen::MatrixXd>(Y).matrixQR().topRows(Y.cols()).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(R, Eigen::ComputeFullV);
  const Eigen::MatrixXd part = Y * svd.matrixV();
  for (Index f = 0; f < svd.singularValues().size(); ++f) {
    Eigen::VectorXd energy = Eigen::VectorXd::Zero(points_in.size());
    for (Index j = 0; j < Y.rows(); ++j) energy[j * stride / test_points] += part(j, f) * part(j, f);
    energy.array() /= points_in;
    functions.push_back({svd.singularValues()[f], odd, svd.matrixV().col(f), std::move(energy)});
  }
}

// Leaves out the least ones as long as no box loses more than it may.
void leave_out_least(std::vector<BasisFunction>& functions, double most) {
  std::stable_sort(functions.begin(), functions.end(),
                   [](const BasisFunction& a, const BasisFunction& b) { return a.singular_value > b.singular_value; });
  Eigen::VectorXd lost = Eigen::VectorXd::Zero(functions.empty() ? 0 : functions.front().energy.size());
  while (!functions.empty()) {
    lost += functions.back().energy;
    if (lost.maxCoeff() > most) break;
    functions.pop_back();
  }
}

}  // namespace

template <int Dim>
BoxOperators<Dim>::BoxOperators(const Kernel& kernel, double half, double tolerance, int farthest, bool has_parent)
    : kernel_(kernel), half_(half), farthest_(farthest), chebyshev_(1) {
  const double limit = tolerance * scale() * (kernel.compact() ? compact_share : 1);
  negligible_ = kernel.order() == 0 ? negligible_share * limit : -1;
  Index codes = 1;
  for (int d = 0; d < Dim; ++d) codes *= farthest + 1;
  // The smallest order with which all is far, or the largest.
  for (int order = 3; order <= largest_orders[Dim - 1]; ++order) {
    chebyshev_ = Chebyshev(order);
    slab_ = slab_rows<Dim>(order);
    reach_.assign(codes, Reach::near);
    measure(limit);
    any_near_ = false;
    for (Index c = 0; c < codes; ++c)
      if (largest(offset(c)) >= 2 && reach_[c] == Reach::near) any_near_ = true;
    if (!any_near_) break;
  }
  if (has_parent || std::find(reach_.begin(), reach_.end(), Reach::far) != reach_.end()) find_basis(limit);
}

template <int Dim>
double BoxOperators<Dim>::scale() const {
  double largest = kernel_.has_scale() ? std::abs(kernel_.value(0)) : 0;
  for (const double boxes : {2., 4., 6.}) largest = std::max(largest, std::abs(kernel_.value(boxes * half_)));
  return largest;
}

template <int Dim>
Index BoxOperators<Dim>::code(const BoxOffset<Dim>& offset) const {
  Index code = 0;
  for (int d = Dim - 1; d >= 0; --d) code = code * (farthest_ + 1) + offset[d];
  return code;
}

template <int Dim>
BoxOffset<Dim> BoxOperators<Dim>::offset(Index code) const {
  BoxOffset<Dim> offset;
  for (int d = 0; d < Dim; ++d, code /= farthest_ + 1) offset[d] = static_cast<int>(code % (farthest_ + 1));
  return offset;
}

template <int Dim>
typename BoxOperators<Dim>::Reach BoxOperators<Dim>::reach(const BoxOffset<Dim>& offset) const {
  if (largest(offset) <= farthest_) return reach_[code(offset)];
  return is_negligible(offset) ? Reach::negligible : Reach::near;
}

// By phi at the shortest distance: kernels of order 0 decay.
template <int Dim>
bool BoxOperators<Dim>::is_negligible(const BoxOffset<Dim>& offset) const {
  double nearest2 = 0;
  for (const int o : offset) nearest2 += 4 * std::pow(std::max(0, o - 1), 2);
  return std::abs(kernel_.value(half_ * std::sqrt(nearest2))) <= negligible_;
}

// Points in units of half a box.
template <int Dim>
Eigen::MatrixXd BoxOperators<Dim>::kernel_matrix(const Points<Dim>& x, const Points<Dim>& y) const {
  Eigen::MatrixXd K(x.cols(), y.cols());
  Eigen::VectorXd r2(x.cols());
  for (Index j = 0; j < y.cols(); ++j) {
    squared_distances<Dim>(x.data(), x.cols(), y.col(j), r2.data());
    r2 *= half_ * half_;
    kernel_.values(r2.data(), x.cols(), K.col(j).data());
  }
  return K;
}

// Those of the padding lie at 0.
template <int Dim>
Points<Dim> BoxOperators<Dim>::nodes() const {
  Points<Dim> x = Points<Dim>::Zero(Dim, slab_ * chebyshev_.order());
  for_each_node<Dim>(chebyshev_.order(), [&](Index row, const std::array<int, Dim>& digits) {
    for (int d = 0; d < Dim; ++d) x(d, row) = chebyshev_.nodes()[digits[d]];
  });
  return x;
}

// By the error of interpolation in the box at the origin, the other point being anywhere in the other box.
template <int Dim>
void BoxOperators<Dim>::measure(double limit) {
  const Points<Dim> x = spread_points<Dim>(test_points);
  const Points<Dim> at_nodes = nodes();
  const Eigen::MatrixXd S = interpolation<Dim>(chebyshev_, x);
  for (Index c = 0; c < std::ssize(reach_); ++c) {
    const BoxOffset<Dim> o = offset(c);
    if (largest(o) < 2) continue;
    if (is_negligible(o)) {
      reach_[c] = Reach::negligible;
      continue;
    }
    Point<Dim> shift;
    for (int d = 0; d < Dim; ++d) shift[d] = 2 * o[d];
    const Points<Dim> y = x.colwise() + shift;
    const Eigen::MatrixXd error = S * kernel_matrix(at_nodes, y) - kernel_matrix(x, y);
    if (error.cwiseAbs().maxCoeff() <= largest_error * limit &&
        error.norm() <= interpolation_share * limit * std::sqrt(static_cast<double>(error.size())))
      reach_[c] = Reach::far;
  }
}

// Singular vectors of the kernel between the nodes and far points, for each combination of even and odd axes. A point
// and its mirror images see the same but for signs, so that those with coordinates >= 0 stand for all.
template <int Dim>
void BoxOperators<Dim>::find_basis(double limit) {
  const int p = chebyshev_.order();
  const Points<Dim> at_nodes = nodes();
  // What comes from farther away, through the parents, must fit in as well.
  std::vector<Points<Dim>> boxes;
  for (Index c = 0; c < std::ssize(reach_); ++c) {
    const BoxOffset<Dim> o = offset(c);
    if (largest(o) < 2 || reach_[c] == Reach::negligible) continue;
    for (const double times : {1., 2., 4., 8.}) {
      Points<Dim> y = spread_points<Dim>(test_points);
      for (int d = 0; d < Dim; ++d) y.row(d).array() += 2 * o[d];
      boxes.push_back(times * y);
    }
  }
  const Index candidates = std::ssize(boxes) * test_points;
  const Index stride = std::max<Index>(1, candidates / basis_samples);
  Points<Dim> far(Dim, candidates / stride + 1);
  Index at = 0;
  for (Index k = 0; k < candidates; k += stride) far.col(at++) = boxes[k / test_points].col(k % test_points);
  const Parities<Dim> parities(p);
  Eigen::MatrixXd K = kernel_matrix(at_nodes(Eigen::all, parities.nodes()), far.leftCols(at));
  parities.columns(K);
  std::vector<BasisFunction> functions;
  Eigen::VectorXd points_in = Eigen::VectorXd::Zero(std::ssize(boxes));
  for (Index k = 0; k < candidates; k += stride) points_in[k / test_points] += 1;
  for (unsigned odd = 0; odd < (1U << Dim); ++odd) {
    if (const Index rows = parities.count(odd); rows > 0)
      add_functions(K.middleRows(parities.begin(odd), rows).transpose(), odd, stride,
                    points_in.array().max(1) * std::pow(p, Dim), functions);
  }
  leave_out_least(functions, std::pow(truncation_share * limit, 2));
  rank_ = padded_rows(std::ssize(functions));
  odd_axes_.assign(rank_, 0);
  Eigen::MatrixXd split = Eigen::MatrixXd::Zero(std::ssize(parities.nodes()), rank_);
  for (Index f = 0; f < std::ssize(functions); ++f) {
    odd_axes_[f] = functions[f].odd;
    split.col(f).segment(parities.begin(functions[f].odd), functions[f].values.size()) = functions[f].values;
  }
  parities.merge(split);
  basis_ = Eigen::MatrixXd::Zero(at_nodes.cols(), rank_);
  basis_(parities.nodes(), Eigen::all) = split;
  transposed_ = basis_.transpose();
}

// C = U^T K U, with K split by the parities of both sides: a function of U has one parity.
template <int Dim>
void BoxOperators<Dim>::prepare(std::vector<Index> codes) {
  std::erase_if(codes, [&](Index code) { return translations_.contains(code); });
  if (codes.empty()) return;
  const Parities<Dim> parities(chebyshev_.order());
  const Index count = std::ssize(parities.nodes());
  const Points<Dim> at_nodes = nodes()(Eigen::all, parities.nodes());
  Eigen::MatrixXd U = basis_(parities.nodes(), Eigen::all);
  parities.columns(U);
  constexpr unsigned combinations = 1U << Dim;
  std::array<std::vector<Index>, combinations> functions;
  for (Index f = 0; f < rank_; ++f) functions[odd_axes_[f]].push_back(f);
  std::array<Eigen::MatrixXd, combinations> part, transposed;
  for (unsigned odd = 0; odd < combinations; ++odd) {
    part[odd] = U.middleRows(parities.begin(odd), parities.count(odd))(Eigen::all, functions[odd]);
    transposed[odd] = Eigen::MatrixXd::Zero(padded_rows(part[odd].cols()), part[odd].rows());
    transposed[odd].topRows(part[odd].cols()) = part[odd].transpose();
  }
  std::vector<Eigen::MatrixXd> matrices(codes.size());
  parallel_for(std::ssize(codes), 1, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) {
      const BoxOffset<Dim> o = offset(codes[k]);
      Points<Dim> source = at_nodes;  // at the origin; targets at the offset
      for (int d = 0; d < Dim; ++d) source.row(d).array() -= 2 * o[d];
      Eigen::MatrixXd K = Eigen::MatrixXd::Zero(padded_rows(count), count);
      K.topRows(count) = kernel_matrix(at_nodes, source);
      parities.columns(K);
      parities.rows(K);
      matrices[k].setZero(rank_, rank_);
      for (unsigned odd = 0; odd < combinations; ++odd) {
        const Eigen::MatrixXd of_sources = product(K.middleCols(parities.begin(odd), parities.count(odd)), part[odd]);
        for (unsigned other = 0; other < combinations; ++other) {
          const Eigen::MatrixXd rows = of_sources.middleRows(parities.begin(other), parities.count(other));
          matrices[k](functions[other], functions[odd]) = product(transposed[other], rows).topRows(part[other].cols());
        }
      }
    }
  });
  for (std::size_t k = 0; k < codes.size(); ++k) translations_[codes[k]] = std::move(matrices[k]);
}

template <int Dim>
Eigen::MatrixXd BoxOperators<Dim>::to_parent(const BoxOperators& child, unsigned corner) const {
  Points<Dim> x = .5 * child.nodes();
  for (int d = 0; d < Dim; ++d) x.row(d).array() += (corner >> d) % 2 != 0 ? .5 : -.5;
  const Eigen::MatrixXd S = interpolation<Dim>(chebyshev_, x);  // child's nodes x nodes
  return product(transposed_, S.transpose() * child.basis());
}

template class BoxOperators<1>;
template class BoxOperators<2>;
template class BoxOperators<3>;

}  // namespace csrbf
