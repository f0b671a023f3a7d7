#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/surface/prepare/prepare.hpp"

namespace csrbf::baselines {

/// Which offsets of the samples are included.
enum class Offsets { none, inside, both };

/// Values of a signed distance: 0 at `count` farthest points of a cloud (0: all), kappa at offsets by kappa inwards,
/// and -kappa outwards; kappa is half the distance to the nearest other sample kept, and halved until no sample of the
/// cloud is closer to the offset than 0.7 kappa, so that offsets stay on their side of the surface.
Samples<3> off_surface_samples(const PreparedCloud& cloud, Index count, Offsets offsets);

}  // namespace csrbf::baselines
