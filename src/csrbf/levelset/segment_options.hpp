#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// What segment() minimises: an energy of regions, each with its own distribution of intensities, or of a contour along
/// edges.
enum class SegmentEnergy {
  automatic,             ///< the model that describes the image shortest, see segment(); else chan_vese
  chan_vese,             ///< regions differ in mean intensity
  gaussian,              ///< in mean and variance
  generalized_gaussian,  ///< also in the shape of the distribution: separates textures of equal mean
  rayleigh,              ///< speckle: the envelope of ultrasound
  gamma,                 ///< the same, compounded; these three allow for the blur of speckle where they find it
  edge,                  ///< a short contour along large gradients of the image; needs a start, always in local mode
};

enum class SegmentMode {
  global,  ///< parts of a region appear wherever they fit
  local,   ///< the contour moves step by step from a start
};

enum class SegmentMethod {
  variational,        ///< descent of the energy on a lattice of CSRBF centres
  collocation,        ///< the scheme of the thesis, (8.25)-(8.28), with its errata; see collocate()
  finite_difference,  ///< upwind differences on the voxels; see finite_difference()
};

/// How the mean of a region varies over the image.
enum class Shading {
  automatic,  ///< linear if that explains most of what two constant means leave, else none
  none,
  linear,
  quadratic,
  smooth,      ///< a quadratic plus a local mean of the rest; only with the energy `automatic`
  objects,     ///< a mean of its own for each component of one region; only with the energy `automatic`
  background,  ///< a smooth function added to both regions; only with the energy `automatic`
};

/// The names used on the command line and in Python, such as chan-vese, local, finite-difference; auto for automatic.
std::string_view name_of(SegmentEnergy energy);
std::string_view name_of(SegmentMode mode);
std::string_view name_of(SegmentMethod method);
std::string_view name_of(Shading shading);
/// The value with this name. Throws InvalidInput, with the list of names, if there is none.
SegmentEnergy segment_energy(std::string_view name);
SegmentMode segment_mode(std::string_view name);
SegmentMethod segment_method(std::string_view name);
Shading shading_named(std::string_view name);

/// The options of segment(), without those that are arrays or functions.
struct SegmentSettings {
  SegmentEnergy energy = SegmentEnergy::automatic;
  SegmentMode mode = SegmentMode::global;
  SegmentMethod method = SegmentMethod::variational;
  int regions = 2;  ///< 2 to 16; more than 2 need global mode and the method variational
  /// Distance between centres, in voxels of the shortest edge: from 1 to half the longest side of the image, at most
  /// 256 in 2D and 40 in 3D. Automatic: 2 to 12, more in stronger noise; with the energy `automatic` down to 1 if there
  /// are small objects; six times the grain of speckle.
  std::optional<double> center_spacing = {};
  /// Support radius of the centres, in centre spacings. Automatic: 2.5; for collocation 4, as in the thesis.
  std::optional<double> support = {};
  std::string kernel = "wendland-c2";  ///< any compact kernel with a gradient; wendland-c4 if curvatures are needed
  /// Weight of the contour length (3D: area) relative to the contrast, in voxels: details with a smaller radius vanish.
  /// At least 0. Automatic: 0, because the centres already smooth; for `edge` 1.
  std::optional<double> smoothness = {};
  /// Half width of the box over which energies are averaged, eq. (8.32), in voxels, 0 to 1000. Automatic: 0; for
  /// generalized_gaussian 3 (3D: 1), up to three times that in speckle.
  std::optional<int> window = {};
  Shading shading = Shading::automatic;  ///< with the energies automatic, chan_vese and gaussian, in global mode
  double balloon = 0;                    ///< of `edge`: pressure from -1 (shrink) to 1 (grow)
  /// Whether holes that the contour encloses count as inside. Automatic: in local mode only, whose contour leaves dark
  /// spots behind. If true, needs two regions and the method variational.
  std::optional<bool> fill_holes = {};
  /// Probability that a seed has the right label, above 0 and at most 1. At 1 a seed keeps its label. Below 1 it
  /// changes if intensities and contour then save more than log(p / (1 - p)) nats; with n regions,
  /// log(p (n - 1) / (1 - p)).
  double seed_confidence = 1;
  /// Value of missing voxels: they are ignored and get label 0, as NaN always does. With several components, a voxel is
  /// missing if all have the value. NaN: no value but NaN.
  ///
  /// Unset: a value is looked for in global mode with the energy `automatic`, without seed or seeds, up to 8 million
  /// voxels, in images of one component. It is the least or the greatest value, if that is farther from all others than
  /// these are from one another and fills a block that reaches the border of the image; or a mark such as -9999
  /// anywhere. The ends of common ranges (0, 1, 255, 1023, 4095, 16383) do not count. A frame around the picture is
  /// missing too: padding, rotated or stitched images, round apertures. What is found is left out only if the rest
  /// still has regions, as many as were asked for, and a warning says so.
  std::optional<double> missing = {};
  int iterations = 100;  ///< at most; each one updates statistics and contour
};

/// Gets the labels of all voxels (1 inside, 0 outside) and writes the force of each voxel: its cost inside minus its
/// cost outside, negative if it belongs inside. A level set f follows f_t = -force delta(f).
using ForceUpdate = std::function<void(const unsigned char* labels, float* force)>;

/// The settings, and what belongs to one image. Arrays have one entry per voxel, x fastest, or are empty.
struct SegmentOptions : SegmentSettings {
  /// Where the segmentation starts: not 0 inside, 0 elsewhere. In global mode it only decides which region gets label
  /// 1: the one that the seed covers more of. In local mode the core of the seed stays inside: in each of its connected
  /// parts, the voxels at least half as deep as the deepest one. For two regions.
  std::vector<std::uint8_t> seed = {};
  /// Labels of two regions that the statistics start from, such as those of the previous frame.
  std::vector<std::uint8_t> start = {};
  /// Voxels whose region is known: 1 + its label; 0 elsewhere. Mark at least one voxel of every region. See
  /// seed_confidence. Need the method variational and an energy of regions; more than two regions need the energy
  /// `automatic`, no window or smoothness, and at most 8 million voxels. In global mode they replace `seed`.
  ///
  /// In local mode and with other energies than `automatic`, costs are in units of the mean cost of a voxel in the
  /// wrong region, and a seed costs at most 10. In local mode the background may be left out, and the contour starts at
  /// the seeds inside unless there is a `seed` or `start`.
  std::vector<std::uint8_t> seeds = {};
  /// A confidence from 0 to 1 for each seed, instead of seed_confidence.
  std::vector<float> seed_confidences = {};
  /// Added to the cost of a voxel inside, in units of the mean cost of a voxel in the wrong region. For two regions.
  std::vector<float> prior = {};
  /// 0 in voxels to ignore, which get label 0.
  std::vector<std::uint8_t> mask = {};
  /// Replaces `energy`; in any unit.
  ForceUpdate force = {};
  Progress progress = {};
};

/// How well a model of the regions describes the image: the length of the shortest description found with it, minus
/// that of the model chosen, in nats. Negative: shorter, but ruled out, because neighbouring voxels depend on each
/// other where the model takes them to be independent, or because its means hardly vary.
struct EnergyPrice {
  SegmentEnergy energy;
  Shading shading;
  double nats = 0;
};

/// Statistics of one region.
struct RegionReport {
  int label = 0;
  Index voxels = 0;
  double volume = 0;  ///< in the unit of the spacing, squared or cubed
  double mean = 0;
  double sd = 0;
};

/// What segment() did, and with which settings.
struct SegmentReport {
  SegmentSettings options;  ///< with the values chosen in place of automatic ones
  int iterations = 0;
  bool converged = false;  ///< whether the labels had stopped changing
  /// Energy per voxel after each step, in units of the mean cost of a voxel in the wrong region. It never increases
  /// with the method variational. In speckle the last steps minimise the energy of speckle.
  std::vector<double> energy;
  std::vector<RegionReport> regions;
  Index components = 0;  ///< connected components (by faces) of all regions but 0
  double noise = 0;      ///< standard deviation of the noise over the contrast of the regions
  /// Set if the noise depends on the intensity (energy `automatic`): its standard deviation where the image is bright
  /// over that where it is dark.
  std::optional<double> noise_growth = {};
  /// Set if the noise varies over the image: its largest standard deviation over the smallest.
  std::optional<double> uneven_noise = {};
  /// Set if the noise is correlated (energy `automatic`): the number of voxels that one independent value covers.
  std::optional<double> grain = {};
  /// Set if the image is speckle: the power of the amplitude that it shows; about 0 for the logarithm.
  std::optional<double> speckle = {};
  /// Set if more than two regions are classes of the blurred image: standard deviation of the Gaussian, in voxels of
  /// the shortest edge.
  std::optional<double> blur = {};
  /// Set if the image has dead or hot voxels (energy `automatic`): their share.
  std::optional<double> impulses = {};
  /// Set if voxels inside the mask are missing: their share. options.missing has the value of a block that was found.
  std::optional<double> missing = {};
  /// Set if two regions are textures: the share of the variance that neighbours predict, for labels 0 and 1.
  std::optional<std::array<double, 2>> textures = {};
  std::vector<EnergyPrice> prices;  ///< with the energy `automatic`: one for each model
  std::vector<double> channels;     ///< for several components: the weights of the sum that was segmented
  std::vector<std::string> warnings;
};

template <int Dim>
struct Segmentation {
  std::vector<std::uint8_t> labels;  ///< one per voxel, x fastest; 0: outside
  /// The level set of region 1 (two regions), or one for each region: f > 0 inside, close to the signed distance near
  /// the boundary, in the physical coordinates of the grid.
  std::vector<std::shared_ptr<const Field<Dim>>> fields;
  SegmentReport report;
};

}  // namespace csrbf
