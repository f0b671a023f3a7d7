#pragma once

#include "csrbf/levelset/regions/region_model.hpp"

#include <vector>

namespace csrbf {

/// Energy of a voxel in each bin, bounded and finite: (x - location)^2 at the bin centres x, or minus the logarithm of
/// the mean density over the bin, in units of 1 / (hi - lo): it does not change when the intensities become a I + b.
/// One voxel in a million is taken to have any intensity, whence energies are at most 14.
std::vector<float> energy_table(const RegionModel& model, const IntensityBins& bins);

/// Sum of the energies of all voxels of a region, each by its bin; what fit_region_model minimises.
double total_energy(const std::vector<float>& table, const Histogram& histogram);

/// energies[i] = table at values[i], linear between the bin centres and constant beyond the outer ones. For two regions
/// give the difference of their tables. O(n), parallel. Throws InvalidInput when sizes differ, or for a single bin.
void look_up_energies(std::span<const float> values, const std::vector<float>& table, const IntensityBins& bins,
                      std::span<float> energies);

/// energies[i] = table[indices[i]] for the indices of bin_indices: as total_energy counts, and faster. O(n), parallel.
/// Throws InvalidInput when the sizes differ. Indices beyond the table have energy 0.
void look_up_energies(std::span<const std::uint8_t> indices, const std::vector<float>& table,
                      std::span<float> energies);

}  // namespace csrbf
