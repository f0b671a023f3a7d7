#include "csrbf/approx/basis/polynomial.hpp"

#include "csrbf/core/error.hpp"

#include <algorithm>
#include <numeric>

namespace csrbf {
namespace {

// Of so many monomials, whose powers follow each other.
std::vector<Index> nested_order(const int* powers, Index size, int dimension) {
  std::vector<Index> order(static_cast<std::size_t>(size));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index i, Index j) {
    for (int a = dimension - 1; a >= 0; --a)
      if (powers[dimension * i + a] != powers[dimension * j + a])
        return powers[dimension * i + a] > powers[dimension * j + a];
    return false;
  });
  return order;
}

}  // namespace

template <int Dim>
Polynomials<Dim>::Polynomials(int degree) : degree_(degree) {
  constexpr int largest = 20;  // chosen by hand: monomials are nearly dependent long before
  require(degree >= -1 && degree <= largest, "Polynomials", "degree", degree, "must be -1 (none), 0, ... or 20");
  if (degree < 0) return;
  exponents_.push_back({});
  steps_.push_back({-1, 0});
  // Each monomial of the next degree once: by a variable not before the last one of its parent.
  std::size_t first = 0;
  for (int d = 1; d <= degree; ++d) {
    const std::size_t end = exponents_.size();
    for (std::size_t parent = first; parent < end; ++parent) {
      for (int axis = d == 1 ? 0 : steps_[parent].axis; axis < Dim; ++axis) {
        exponents_.push_back(exponents_[parent]);
        ++exponents_.back()[axis];
        steps_.push_back({static_cast<Index>(parent), axis});
      }
    }
    first = end;
  }
}

Index monomial_count(int dimension, int degree) {
  if (degree < 0) return 0;
  Index size = 1;
  for (int a = 1; a <= dimension; ++a) size = size * (degree + a) / a;
  return size;
}

template <int Dim>
int Polynomials<Dim>::largest_degree(Index count) {
  int degree = -1;
  while (degree < 20 && size(degree + 1) <= count) ++degree;
  return degree;
}

template <int Dim>
void Polynomials<Dim>::rows(const PointsRef<Dim>& x, double* value, double* gradient, double* hessian) const {
  const Index n = x.cols();
  constexpr Index entries = symmetric_size<Dim>;
  for (std::size_t j = 0; j < steps_.size(); ++j) {
    const auto [parent, axis] = steps_[j];
    double* v = value + n * static_cast<Index>(j);
    double* g = gradient == nullptr ? nullptr : gradient + Dim * n * static_cast<Index>(j);
    double* H = hessian == nullptr ? nullptr : hessian + entries * n * static_cast<Index>(j);
    if (parent < 0) {
      std::fill(v, v + n, 1.0);
      if (g != nullptr) std::fill(g, g + Dim * n, 0.0);
      if (H != nullptr) std::fill(H, H + entries * n, 0.0);
      continue;
    }
    // Product rule for x[axis] times the parent.
    const double* v0 = value + n * parent;
    for (Index i = 0; i < n; ++i) v[i] = x(axis, i) * v0[i];
    if (g == nullptr) continue;
    const double* g0 = gradient + Dim * n * parent;
    for (Index i = 0; i < n; ++i) {
      for (int a = 0; a < Dim; ++a) g[Dim * i + a] = x(axis, i) * g0[Dim * i + a];
      g[Dim * i + axis] += v0[i];
    }
    if (H == nullptr) continue;
    const double* H0 = hessian + entries * n * parent;
    for (Index i = 0; i < n; ++i) {
      Index entry = entries * i;
      for (int a = 0; a < Dim; ++a) {
        for (int b = a; b < Dim; ++b, ++entry) {
          H[entry] = x(axis, i) * H0[entry];
          if (a == axis) H[entry] += g0[Dim * i + b];
          if (b == axis) H[entry] += g0[Dim * i + a];
        }
      }
    }
  }
}

template <int Dim>
std::vector<Index> nested_order(const Polynomials<Dim>& basis) {
  return basis.size() == 0 ? std::vector<Index>() : nested_order(basis.exponents(0).data(), basis.size(), Dim);
}

#define CSRBF_INSTANTIATE(Dim)     \
  template class Polynomials<Dim>; \
  template std::vector<Index> nested_order<Dim>(const Polynomials<Dim>&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
