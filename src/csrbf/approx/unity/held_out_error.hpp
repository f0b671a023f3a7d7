#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/approx/unity/local_fit.hpp"

namespace csrbf {

/// Errors of a fit at samples that it was not fitted to.
struct HeldOutError {
  double mean = 0;  ///< absolute, of all components
  double rmse = 0;
};

/// Holds out some thousand samples spread over all, at most a tenth of them. Unlike leaving samples out of single
/// patches this measures the blend of patches, which for small ones is much better than each of them. The weights of
/// samples must have the mean 1. Costs a fit of the patches around the held-out samples.
template <int Dim>
class HeldOutSamples {
 public:
  explicit HeldOutSamples(const Samples<Dim>& samples);

  [[nodiscard]] HeldOutError error(const LocalOptions& options) const;

  /// Of any fit to the other samples, with one field per component.
  [[nodiscard]] HeldOutError error(const std::vector<std::shared_ptr<const Field<Dim>>>& fields) const;
  [[nodiscard]] const Samples<Dim>& others() const { return kept_; }

 private:
  Samples<Dim> kept_, held_out_;
};

}  // namespace csrbf
