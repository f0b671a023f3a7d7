#pragma once

#include "csrbf/levelset/regions/region_model.hpp"

#include <vector>

namespace csrbf {

// Chosen by hand: from a sharp peak to an almost uniform law (generalised Gaussian) or an almost normal one (gamma).
inline constexpr double smallest_gaussian_shape = .2;
inline constexpr double largest_gaussian_shape = 20;
inline constexpr double smallest_gamma_shape = .05;
inline constexpr double largest_gamma_shape = 1e4;

/// The likeliest of `starts`, which must be of one law other than chan_vese, moved to a maximum of the likelihood
/// of the counts by its scale, its shape if the law has one, and its location if `moves`. At least as likely as every
/// start. Internal.
RegionModel likeliest_model(const Histogram& histogram, const std::vector<RegionModel>& starts, bool moves);

}  // namespace csrbf
