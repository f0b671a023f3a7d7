#pragma once

namespace csrbf {

/// Derivative of log Gamma for x > 0, to about 1e-14 (1 + |result|).
double digamma(double x);

/// Shares of the gamma distribution of shape s below and above z: the regularised incomplete gamma functions.
struct GammaShares {
  double below = 0;
  double above = 1;
};

/// For s > 0; nothing lies below z <= 0. About 1e-14 relative in the smaller share, for s up to 1e4 about 1e-11.
GammaShares gamma_shares(double s, double z);

}  // namespace csrbf
