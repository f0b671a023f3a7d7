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

/// The energy that is minimised: that of regions whose intensities follow a law each (see IntensityLaw), or of a
/// contour on edges.
enum class SegmentEnergy {
  automatic,             ///< means or Gaussians and how they vary, by the shortest description; global contours
  chan_vese,             ///< two means
  gaussian,              ///< means and variances
  generalized_gaussian,  ///< also the shape: distinguishes textures of equal mean
  rayleigh,              ///< envelopes of ultrasound
  gamma,                 ///< the same, compounded; these three correct for the blur of speckle where they find it
  edge,                  ///< short contours where the gradient of the image is large; needs a start
};

enum class SegmentMode {
  global,  ///< parts of a region appear wherever they fit
  local,   ///< the contour moves from where it starts, step by step
};

enum class SegmentMethod {
  variational,        ///< descent of the energy on a lattice of CSRBF centres
  collocation,        ///< the scheme of the thesis, (8.25)-(8.28), corrected: two-means thresholding between nodes
  finite_difference,  ///< upwind differences on the voxels
};

/// How the mean of a region varies over the image.
enum class Shading {
  automatic,  ///< linear when that explains most of what two constants leave, else none
  none,
  linear,
  quadratic,
  smooth,      ///< a quadratic and the local mean of what it leaves; energy automatic only
  objects,     ///< each component of one region has a mean of its own; energy automatic only
  background,  ///< added to both regions, smooth; energy automatic only
};

/// Names on the command line and in Python: chan-vese, gaussian, ...; global, local; variational, ...; auto, none, ....
std::string_view name_of(SegmentEnergy energy);
std::string_view name_of(SegmentMode mode);
std::string_view name_of(SegmentMethod method);
std::string_view name_of(Shading shading);
/// The value of that name. Throws InvalidInput, listing the names, for other words.
SegmentEnergy segment_energy(std::string_view name);
SegmentMode segment_mode(std::string_view name);
SegmentMethod segment_method(std::string_view name);
Shading shading_named(std::string_view name);

/// The options of segment() without arrays and functions.
struct SegmentSettings {
  SegmentEnergy energy = SegmentEnergy::automatic;
  SegmentMode mode = SegmentMode::global;
  SegmentMethod method = SegmentMethod::variational;
  int regions = 2;  ///< 2 to 16; more than 2 in global mode of the variational method only
  /// Distance of the centres in voxels of the shortest edge, from 1 to half the longest side of the image, and at most
  /// 256 in the plane, 40 in space; automatic: 2 to 12, growing with the noise, with the energy
  /// `automatic` down to 1 where small objects ask for it; in speckle six times its grain.
  std::optional<double> center_spacing = {};
  /// Support radius in center spacings; automatic: 2.5, for collocation 4 as in the thesis.
  std::optional<double> support = {};
  std::string kernel = "wendland-c2";  ///< any compact kernel with a gradient; wendland-c4 for curvatures
  /// Weight of the length (area) of the contour relative to the contrast, in voxels: details whose radius is below it
  /// vanish. automatic: 0, as the centers smooth already; edge: 1.
  std::optional<double> smoothness = {};
  /// Half width in voxels of the box over which energies are averaged, eq. (8.32); automatic: 0, for
  /// generalized_gaussian 3 (in a volume 1) and up to three times that in speckle.
  std::optional<int> window = {};
  Shading shading = Shading::automatic;  ///< of chan_vese and gaussian in global mode
  double balloon = 0;                    ///< of edge: pressure in [-1, 1] towards growth (> 0) or shrinking
  /// Whether what the contour encloses counts as inside; automatic: in local mode, whose contour leaves dark spots
  /// behind.
  std::optional<bool> fill_holes = {};
  /// Probability that a seed has the label given, up to 1: then it keeps it. One that is not certain yields to
  /// intensities and contours that save more nats than log(p / (1 - p)), of n regions log(p (n - 1) / (1 - p)).
  double seed_confidence = 1;
  /// Value of voxels that are missing, which are ignored and get label 0, as those of NaN always are; of several
  /// components all have it. Unset: the least or the greatest value, where it is farther from all others than these are
  /// from one another, no end of a sensor's range (0, 1, 255, 1023, 4095, 16383), and of a block that reaches the
  /// border of the image, or a mark such as -9999 anywhere (find_missing_block()), or what frames the picture
  /// (find_image_frame(), two regions); with the energy `automatic`, no seeds, and regions in the rest. NaN: none but
  /// NaN.
  std::optional<double> missing = {};
  int iterations = 100;  ///< at most; each updates statistics and contour
};

/// Given the labels of all voxels (1 inside, 0 outside), writes the cost of each voxel inside minus its cost outside:
/// negative where it belongs inside. A level set f follows f_t = -force delta(f).
using ForceUpdate = std::function<void(const unsigned char* labels, float* force)>;

/// Settings, with the arrays and functions of one image.
struct SegmentOptions : SegmentSettings {
  /// Where the segmentation starts: 1 in what is inside (the seed), 0 elsewhere; one entry per voxel, or none. In
  /// global mode it only says which region is inside: the one that the seed covers more of. In local mode its core
  /// stays inside, of each part the voxels at least half as far from its border as the deepest.
  std::vector<std::uint8_t> seed = {};
  /// Labels of two regions that the statistics start from, such as those of the previous frame; one per voxel, or none.
  std::vector<std::uint8_t> start = {};
  /// Voxels whose region is known: 1 + its label, 0 elsewhere; one per voxel, at least one of every region, or none.
  /// See seed_confidence. More than two regions: with the energy `automatic`, and up to 8 million voxels. In local mode
  /// and with other energies, which take costs in units of the mean cost of a voxel in the wrong region, that of a seed
  /// is at most 10, and in local mode no background is needed and the contour starts at those inside unless there is a
  /// `seed` or `start`.
  std::vector<std::uint8_t> seeds = {};
  /// Probabilities of single seeds, instead of seed_confidence: one per voxel, or none.
  std::vector<float> seed_confidences = {};
  /// Added to the cost of a voxel inside, in units of the mean cost of a voxel in the wrong region. One per voxel, or
  /// none; for two regions.
  std::vector<float> prior = {};
  /// 0 in voxels that are ignored and get label 0; one entry per voxel, or none.
  std::vector<std::uint8_t> mask = {};
  /// Replaces `energy`: given labels, writes the cost of each voxel inside minus that outside, in any unit.
  ForceUpdate force = {};
  Progress progress = {};
};

/// What a model of the regions costs: the length in nats of the shortest description of the image that was found with
/// it, over that of the model chosen. Of a model that starts badly only the best start counts. Negative: not credible,
/// as the voxels that it takes to be independent are not, or its means hardly vary.
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

/// What was done, and with which settings.
struct SegmentReport {
  SegmentSettings options;  ///< with the values used in place of `automatic`
  int iterations = 0;
  bool converged = false;  ///< labels had stopped changing
  /// After each step, per voxel, in units of the mean cost of a voxel in the wrong region. Never increases with the
  /// variational method. In speckle the last steps follow its own law.
  std::vector<double> energy;
  std::vector<RegionReport> regions;
  Index components = 0;  ///< connected parts (by faces) of all regions but 0
  double noise = 0;      ///< standard deviation of the noise of the energies over their contrast
  /// Set when the noise of the image changes with intensity and the energy is `automatic`: its deviation where the
  /// image is bright over that where it is dark.
  std::optional<double> noise_growth = {};
  /// Set when it varies over the place instead: its largest deviation over the least.
  std::optional<double> uneven_noise = {};
  /// Set when the noise is blurred and the energy is `automatic`: voxels that one independent value covers.
  std::optional<double> grain = {};
  /// Set when the image is speckle: the power of the amplitudes that it shows; about 0: their logarithms.
  std::optional<double> speckle = {};
  /// Set when more than two regions are classes of the image after a Gaussian: its deviation, in voxels of the shortest
  /// edge.
  std::optional<double> blur = {};
  /// Set when the image has impulses, dead and hot voxels, and the energy is `automatic`: their share.
  std::optional<double> impulses = {};
  /// Set when voxels in the mask are missing: their share. options.missing has the value of a block that was found.
  std::optional<double> missing = {};
  /// Set when two regions are textures: the share of the variance of labels 0 and 1 that neighbouring voxels tell.
  std::optional<std::array<double, 2>> textures = {};
  std::vector<EnergyPrice> prices;  ///< of the energy `automatic`: one for each model
  std::vector<double> channels;     ///< of an image with components: the weights of their sum, which was segmented
  std::vector<std::string> warnings;
};

template <int Dim>
struct Segmentation {
  std::vector<std::uint8_t> labels;  ///< x fastest; 0 = outside
  /// The level set of region 1 (two regions), or one of each region: f > 0 inside it, about the signed distance close
  /// to its boundary, in physical coordinates of the grid.
  std::vector<std::shared_ptr<const Field<Dim>>> fields;
  SegmentReport report;
};

}  // namespace csrbf
