#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/approx/transform/value_transform.hpp"

namespace csrbf {

/// The scale on which the values are likeliest as a smooth function and noise, all with the same covariance at every
/// place: by the restricted likelihood of some of the samples, with the Jacobian of the scale (Box and Cox 1964).
/// `none` unless another one is much likelier, and samples left out are predicted as well from there, by errors no
/// larger and better deviations, at small values as at large ones; and for values of which some are negative, that are
/// all of a size, or that hardly differ from what those around them tell. One value per sample; weights do not count.
Transform choose_transform(const SampleView& samples, const std::vector<Index>& order);

}  // namespace csrbf
