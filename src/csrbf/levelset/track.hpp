#pragma once

#include "csrbf/levelset/segment.hpp"

namespace csrbf {

struct TrackOptions {
  /// Of every frame. Its seed, seeds and start are those of the first one. What is automatic is chosen for each
  /// frame; but in global mode the energy `automatic` only chooses for the first one whether further ones follow
  /// means or, where these hardly differ, means and deviations.
  SegmentOptions segment = {};

  /// Weight of the contour expected from other frames: the cost, in units of a wrong voxel, of voxels on the other side
  /// of it. Rises linearly with their distance from the expected contour, to full weight at one center spacing; and
  /// with the square of the noise of the frame, to full weight at half of the contrast: clear frames are followed
  /// as they are, noisy ones smoothed over time. 0: every frame by itself, except for its start. Two regions, any
  /// energy but edge.
  double persistence = 1;

  /// How far the contour may move from one frame to the next beyond what is expected, in voxels of the shortest edge:
  /// nothing farther away appears or vanishes. Automatic: half the depth of the deepest voxel inside, and at
  /// least six voxels, or where it is less the depth. Not used when persistence is 0.
  std::optional<double> motion = {};

  /// Where the first sweep expects the contour: 0 where it was in the frame before, 1 moved on as far as it had moved
  /// there. Automatic: 1 when there is one sweep, else 0, as motion from a lost frame misleads.
  std::optional<double> prediction = {};

  /// Sweeps through the sequence, 1 to 100. 1: forward only, as while frames come in; the contour lags behind motion.
  /// From 2 on: the first sweep only carries the contour along (within `motion`), further ones, back and forth, expect
  /// each frame halfway between its two neighbours.
  int sweeps = 2;

  Progress progress = {};  ///< stages of segment(), over all frames
};

template <int Dim>
struct TrackedFrame {
  Segmentation<Dim> segmentation;
  std::vector<RegionMeasure> regions;  ///< all but 0
};

/// As in TrackOptions, with the values used in place of `automatic`.
struct TrackSettings {
  SegmentSettings segment = {};
  double persistence = 1;
  std::optional<double> motion = {};
  std::optional<double> prediction = {};
  int sweeps = 2;
};

/// What was done, and with which settings.
struct TrackReport {
  TrackSettings options;
  std::vector<std::string> warnings;
};

template <int Dim>
struct Tracking {
  std::vector<TrackedFrame<Dim>> frames;
  TrackReport report;
};

/// One frame of a sequence; called for each frame once per sweep, in the order of the sweep.
using FrameSource = std::function<Volume<float>(Index frame)>;

/// Tracks a segmentation through the frames of a sequence (thesis, perspectives of chapter 8): the first frame is that
/// of segment(); each further one starts from the labels before it and from a prior, the signed distance to the contour
/// where it is expected. The same region stays inside: it is the one that covers what was inside before.
///
/// A frame in which nothing is left inside, or nothing outside, keeps the contour before it, with a warning. More than
/// two regions have no prior: each frame is segmented by itself and its labels are matched to the regions of the frame
/// before by their overlap.
///
/// Volumes and areas are those of the continuous level sets, as image_contour() measures them.
///
/// Throws InvalidInput for options out of their ranges, frames of different size and what segment() refuses, naming
/// the frame; Cancelled.
template <int Dim>
Tracking<Dim> track(const Volume<float>& sequence, const TrackOptions& options = {});

/// The same, one frame after the other: `read` gives each frame as a volume of one frame, `take` gets each result when
/// it is final. Holds no image but one, and the labels of all frames (from 2 sweeps on).
template <int Dim>
TrackReport track(Index frames, const FrameSource& read, const TrackOptions& options,
                  const std::function<void(Index frame, TrackedFrame<Dim>&& tracked)>& take);

}  // namespace csrbf
