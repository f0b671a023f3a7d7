#pragma once

#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/partition/large_partition.hpp"
#include "csrbf/levelset/partition/partition.hpp"
#include "csrbf/levelset/regions/force_noise.hpp"
#include "csrbf/levelset/regions/region_model.hpp"
#include "csrbf/levelset/seeded/divide_by_seeds.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <vector>

namespace csrbf {

/// The shape of the means of a shading; none for `automatic`. And back.
std::optional<MeanShape> shape_of(Shading shading);
Shading shading_of(MeanShape shape);
/// The law of intensities of an energy of regions.
IntensityLaw law_of(SegmentEnergy energy);

/// Nats per voxel edge of a contour.
inline constexpr double contour_length = 1.5;
/// Voxels from which a search takes longer than all else; it took 40 s for 256^3.
inline constexpr Index most_chosen_voxels = 1 << 23;

/// Whether the energy is chosen by the description length: it is `automatic`, and what else is given has a meaning
/// there.
bool chooses_model(const SegmentOptions& given);

/// Whether segment() finds labels of single voxels and a level set on blocks of these (find_large_partition()): two
/// regions, the energy `automatic`, and more voxels than the choice among models can take.
bool is_large(const SegmentOptions& given, Index voxels);

/// The options of find_large_partition(), and the settings that it chose.
LargePartitionOptions large_options(const Grid& grid, const SegmentSettings& settings, const Progress& progress);
template <int Dim>
void use_large(const LargePartition<Dim>& found, SegmentSettings& used);

/// A warning where two regions describe an image in more nats than one.
inline constexpr const char* nothing_found =
    "one region would describe the image as shortly: what was found may be noise; mark some of it by seeds, or give "
    "another energy, a mask, or a blurred image";

/// A warning for each pair of labels that divide_by_seeds() found alike; false where there is none.
bool warn_of_alike(const AlikeLabels& alike, std::vector<std::string>& warnings);

/// A warning for each region without voxels.
void warn_of_empty(const std::vector<RegionReport>& regions, std::vector<std::string>& warnings);

/// Whether the energy of a contour that moves from its start is to be chosen: it is `automatic`, and nothing else that
/// is given belongs to one of them.
bool chooses_local_energy(const SegmentOptions& given, Index voxels);

/// Whether a contour of regions moves from where the options say.
bool follows_start(const SegmentOptions& given);

/// The price of partitions of `values`, which on another scale have as many levels as those of the image.
PartitionPrice partition_price(std::span<const float> values, std::span<const float> image, const Grid& grid,
                               std::span<const std::uint8_t> mask);

/// Whether the means of a descent may vary, and whether its intensities may be those of speckle.
bool can_be_shaded(const SegmentSettings& used);
bool may_be_speckle(const SegmentSettings& used);

/// Whether the labels are those of least price by the law of the energy: two regions, and nothing given that has a
/// meaning for level sets alone.
bool follows_law(const SegmentOptions& given, Index voxels);

/// More than two regions are described by means alone: to give their energy is then to choose it, without light unless
/// the shading is given, and the labels are those of least price; of 1000 to 262,144 voxels.
SegmentOptions with_choice_of_means(const SegmentOptions& given, Index voxels);

/// In the words of the report.
SegmentEnergy energy_of(const PartitionModel& model);
std::vector<EnergyPrice> price_list(const std::vector<ModelPrice>& prices);

/// The half width of the boxes over which the energy is averaged, where it is not given.
int choose_window(const SegmentOptions& given, const ForceNoise& noise, int dimension);

/// The settings with values in place of `automatic`, but for the center spacing, the window and the shading. Throws
/// InvalidInput for a shading that images of this size cannot have.
SegmentSettings choose_settings(const SegmentOptions& given, Index voxels);

/// What segment() refuses: these throw InvalidInput. First the options as such, then the image and what of the options
/// depends on it.
void check_segment_options(const SegmentOptions& options);
template <int Dim>
void check_segment_image(const Volume<float>& image, const SegmentOptions& options);

/// The values of an image with zeros in place of NaN and infinity, which must be outside the mask; empty when all are
/// finite.
std::vector<float> finite_values(const Volume<float>& image, const std::vector<std::uint8_t>& mask);

/// The values inside the mask must not all be equal.
void check_contrast(std::span<const float> values, const std::vector<std::uint8_t>& mask);

}  // namespace csrbf
