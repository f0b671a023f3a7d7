#include "csrbf/approx/along_tracks.hpp"

#include "csrbf/core/dimensions.hpp"

namespace csrbf {
namespace {

constexpr double clearly_better = 0.99;  // of the mean error: elsewhere patches are safer and smoother

}  // namespace

template <int Dim>
std::optional<HeldOutError> better_along_tracks(const Samples<Dim>& samples, const PartitionOfUnityOptions& options) {
  const HeldOutSamples<Dim> held_out(samples);
  const HeldOutError patches = held_out.error(partition_of_unity(held_out.others(), options).fields());
  const HeldOutError tracks = held_out.error(moving_least_squares(held_out.others(), along_tracks));
  return tracks.mean < clearly_better * patches.mean ? std::optional(tracks) : std::nullopt;
}

#define CSRBF_INSTANTIATE(Dim) \
  template std::optional<HeldOutError> better_along_tracks<Dim>(const Samples<Dim>&, const PartitionOfUnityOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
