#include "csrbf/approx/moving/along_tracks.hpp"

namespace csrbf {

template <int Dim>
std::optional<HeldOutError> better_along_tracks(const Samples<Dim>& samples, const LocalOptions& patches) {
  // Ratio of mean errors below which tracks are preferred to patches, which are safer and smoother. Chosen by hand.
  constexpr double clearly_better = 0.99;
  const HeldOutSamples<Dim> held_out(samples.weights.size() > 0 ? normalize_weights(samples) : samples);
  const HeldOutError usual = held_out.error(patches);
  const HeldOutError tracks = held_out.error(moving_least_squares(held_out.others(), along_tracks));
  return tracks.mean < clearly_better * usual.mean ? std::optional(tracks) : std::nullopt;
}

#define CSRBF_INSTANTIATE(Dim) \
  template std::optional<HeldOutError> better_along_tracks<Dim>(const Samples<Dim>&, const LocalOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
