#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"

#include <memory>
#include <string>
#include <vector>

namespace csrbf {

struct MovingLeastSquaresOptions {
  std::string kernel = "wendland-c4";  ///< the weight function, compactly supported
  int degree = 1;                      ///< of the local polynomials, 0 to 5; 0 is Shepard's method
  double support = 1.5;  ///< radius of the weight of a sample, in distances to its `neighbors`-th neighbour; above 0
  Index neighbors = 0;   ///< 0: twice the number of monomials, at least 2 Dim; with tracks 24
  bool tracks = false;   ///< whether weights follow the tracks on which samples lie; needs degree 1
};

/// Moving least squares (Lancaster and Salkauskas 1981; thesis eqs. 1.6-1.9): f(p) is the value at p of the polynomial
/// g that minimises sum_i w_i phi(|p - p_i| / h_i) (g(p_i) - s_i)^2. Every sample has its own radius h_i, so that f is
/// smooth where the sampling density varies. Polynomials of the degree are reproduced. Gradients and Hessians are those
/// of f, not of the local polynomials.
///
/// With tracks, such as those of soundings from a ship, the weights are
/// w_i phi(|d| / h_i) (|d|_i^2 / h_i^2 + eps^2)^(-5/2), d = p - p_i. The metric |.|_i stretches distances across the
/// track of the sample by five. Then f nearly interpolates, because weights are nearly infinite at the samples, and
/// between two neighbours on a track it is nearly linear, whatever the other tracks. Slopes v are penalised by 1e-4
/// h_i^2 |v|^2 per weight, because the samples nearest to a point often lie on a line.
///
/// If the samples around p do not determine a polynomial of the degree, a lower degree is used. If there is no sample
/// around p, f is the value of the nearest one, with zero derivatives: it is not continuous there, but defined
/// everywhere. Each point costs a dense solve, O(k Q^2) for k samples around it and Q monomials.
///
/// Returns one field per component; they share the samples. Duplicates are merged; samples of weight 0 are ignored.
/// Throws InvalidInput for invalid samples, degree < 0 or > 5 (with tracks other than 1), support <= 0, negative
/// neighbors, and kernels without compact support or without the two derivatives that a Hessian needs.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> moving_least_squares(const Samples<Dim>& samples,
                                                                    const MovingLeastSquaresOptions& options = {});

}  // namespace csrbf
