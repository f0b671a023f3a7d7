#pragma once

#include "csrbf/core/types.hpp"

#include <cmath>

namespace csrbf {

/// The k-th of a sequence of points that fill the unit cube evenly: multiples of the powers of 1 / r modulo 1, r^(Dim +
/// 1) = r + 1 (Roberts 2018).
template <int Dim>
Point<Dim> spread_point(Index k) {
  double root = 1;
  for (int step = 0; step < 30; ++step) root = std::pow(1 + root, 1.0 / (Dim + 1));
  Point<Dim> x;
  double power = 1;
  for (Index a = 0; a < Dim; ++a) {
    power /= root;
    const double at = 0.5 + power * static_cast<double>(k + 1);
    x[a] = at - std::floor(at);
  }
  return x;
}

}  // namespace csrbf
