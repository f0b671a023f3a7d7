#pragma once

#include "csrbf/levelset/regions/intensity_histogram.hpp"

#include <optional>

namespace csrbf {

/// How the intensities of a region are distributed.
enum class IntensityLaw { chan_vese, gaussian, generalized_gaussian, rayleigh, gamma };

/// A law and its parameters:
///
/// | law | density of x, t = (x - location) / scale | energy of a voxel |
/// |---|---|---|
/// | chan_vese | none | (x - location)^2, eq. (8.31) |
/// | gaussian | exp(-t^2/2) / (sqrt(2 pi) scale) | -log density |
/// | generalized_gaussian | b exp(-abs(t)^b) / (2 scale Gamma(1/b)), b = shape | -log density, eq. (8.32) |
/// | rayleigh | t exp(-t^2/2) / scale for t > 0 | -log density |
/// | gamma | t^(k-1) exp(-t) / (scale Gamma(k)) for t > 0, k = shape | -log density |
struct RegionModel {
  IntensityLaw law = IntensityLaw::chan_vese;
  double location = 0;
  double scale = 1;
  double shape = 2;
};

struct RegionModelOptions {
  /// Keeps the location: 0 for the zero-mean signals of radio frequency; the black level for rayleigh and gamma, whose
  /// default is histogram.bins.lo, as regions of one image share it. The others estimate it.
  std::optional<double> location = {};
  /// A model of the same law that the result must not be less likely than, such as that of the last iteration: then an
  /// energy that is minimised over models and regions in turns never increases.
  std::optional<RegionModel> start = {};
};

/// The model of greatest likelihood for the counts of the histogram: of the shares of all bins, not of densities at
/// their centres, so that bins may be wider than a peak, and values beyond the end bins count as that. For chan_vese
/// the mean. Shapes are kept in [.2, 20] (generalized_gaussian) and [.05, 1e4] (gamma), scales such that the mean
/// absolute deviation (gamma: the standard deviation) is at least a quarter (half) of a bin: a constant region has a
/// finite likelihood. For shapes below 1 several locations can be locally best; the search starts from mean, median,
/// mode and `start`, whichever is likeliest. An empty histogram gives `start`, without it a law that spreads over the
/// whole range. O(bins) for each of about ten steps, 0.1 ms for 256 bins.
RegionModel fit_region_model(IntensityLaw law, const Histogram& histogram, const RegionModelOptions& options = {});

/// Shape b of the generalised Gaussian of mean 0 with E x^2 / (E abs(x))^2 = Gamma(1/b) Gamma(3/b) / Gamma(2/b)^2 =
/// `ratio`; kept in [.2, 20].
double shape_of_moment_ratio(double ratio);

}  // namespace csrbf
