#include "csrbf/levelset/regions/force_source.hpp"

namespace csrbf {

double ForceSource::force_with_prior(int k, double scale, std::span<float> to) const {
  const double others = force(k, scale, to) / scale;
  for (std::size_t i = 0; i < prior_.size(); ++i) to[i] += prior_[i];
  return others;
}

}  // namespace csrbf
