#pragma once

#include "csrbf/approx/local_fit.hpp"
#include "csrbf/approx/samples.hpp"

namespace csrbf {

/// How a partition of unity predicts samples that it was not fitted to.
struct HeldOutError {
  double mean = 0;  ///< absolute, of all components
  double rmse = 0;
};

/// Holds back some thousand samples spread over all, at most a tenth of them. Unlike leaving samples out of single
/// patches this judges the blend of patches, which for small ones is much better than they are. The weights of samples
/// must have the mean 1. Costs a fit of the patches around the samples held back.
template <int Dim>
class HeldOutSamples {
 public:
  explicit HeldOutSamples(const Samples<Dim>& samples);

  [[nodiscard]] HeldOutError error(const LocalOptions& options) const;

 private:
  Samples<Dim> kept_, held_out_;
};

}  // namespace csrbf
