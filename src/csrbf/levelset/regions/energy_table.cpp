#include "csrbf/levelset/regions/energy_table.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/simd.hpp"
#include "csrbf/levelset/regions/bin_probabilities.hpp"

namespace csrbf {
namespace {

constexpr Index table_grain = 1 << 16;  // voxels per task: a look-up is cheap

CSRBF_ALWAYS_INLINE void interpolate_table(const float* values, Index n, const float* __restrict table,
                                           const IntensityBins& bins, float* __restrict energies) {
  const auto lo = static_cast<float>(bins.center(0));
  const auto scale = static_cast<float>(1 / bins.width());
  const auto end = static_cast<float>(bins.count - 1);
  const auto last = static_cast<int>(std::max<Index>(0, bins.count - 2));
  for (Index i = 0; i < n; ++i) {
    float position = (values[i] - lo) * scale;
    position = position > 0 ? position : 0;
    position = position < end ? position : end;
    int k = static_cast<int>(position);
    k = k < last ? k : last;
    const float left = table[k];
    energies[i] = left + (position - static_cast<float>(k)) * (table[k + 1] - left);
  }
}

}  // namespace

std::vector<float> energy_table(const RegionModel& model, const IntensityBins& bins) {
  std::vector<float> table(bins.count);
  if (model.law == IntensityLaw::chan_vese) {
    for (Index k = 0; k < bins.count; ++k) {
      const double d = bins.center(k) - model.location;
      table[k] = static_cast<float>(d * d);
    }
    return table;
  }
  BinProbabilities p;
  bin_probabilities(model, bins, p);
  for (Index k = 0; k < bins.count; ++k)
    table[k] = static_cast<float>(-std::log(p.values[k] * static_cast<double>(bins.count)));
  return table;
}

double total_energy(const std::vector<float>& table, const Histogram& histogram) {
  require(table.size() == histogram.counts.size(), "total_energy", "table.size()", table.size(),
          "must be the number of bins");
  double sum = 0;
  for (std::size_t k = 0; k < table.size(); ++k) sum += histogram.counts[k] * static_cast<double>(table[k]);
  return sum;
}

void look_up_energies(std::span<const float> values, const std::vector<float>& table, const IntensityBins& bins,
                      std::span<float> energies) {
  require(bins.count >= 2 && std::ssize(table) == bins.count, "look_up_energies", "table.size()", table.size(),
          "must be the number of bins, and at least 2");
  require(values.size() == energies.size(), "look_up_energies", "energies.size()", energies.size(),
          "must be the number of values");
  parallel_for(std::ssize(values), table_grain, [&](Index begin, Index end) {
    simd<interpolate_table>(values.data() + begin, end - begin, table.data(), bins, energies.data() + begin);
  });
}

void look_up_energies(std::span<const std::uint8_t> indices, const std::vector<float>& table,
                      std::span<float> energies) {
  require(indices.size() == energies.size(), "look_up_energies", "energies.size()", energies.size(),
          "must be the number of voxels");
  // A table of every index: without a branch, and nothing is read beyond.
  std::array<float, 256> all{};
  std::copy_n(table.begin(), std::min(table.size(), all.size()), all.begin());
  parallel_for(std::ssize(indices), table_grain, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) energies[i] = all[indices[i]];
  });
}

}  // namespace csrbf
