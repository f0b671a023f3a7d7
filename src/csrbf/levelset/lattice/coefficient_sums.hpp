#pragma once

#include "csrbf/core/parallel.hpp"
#include "csrbf/core/parallel_sum.hpp"

#include <cstddef>
#include <vector>

namespace csrbf {

inline constexpr Index coefficients_per_thread = 1 << 15;  // 128 kB of floats: far more work than starting a task

/// Sum of term(i), i < n.
template <class Term>
double sum_of(std::size_t n, const Term& term) {
  return parallel_sum(static_cast<Index>(n), coefficients_per_thread, [&](Index begin, Index end) {
    double sum = 0;
    for (Index i = begin; i < end; ++i) sum += term(i);
    return sum;
  });
}

inline double dot(const std::vector<float>& a, const std::vector<float>& b) {
  return sum_of(a.size(), [&](std::size_t i) { return static_cast<double>(a[i]) * static_cast<double>(b[i]); });
}

/// Calls body(i) for each i < n.
template <class Body>
void for_all(std::size_t n, const Body& body) {
  parallel_for(static_cast<Index>(n), coefficients_per_thread, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) body(i);
  });
}

}  // namespace csrbf
