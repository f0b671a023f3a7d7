#pragma once

#include "csrbf/levelset/segment.hpp"

namespace csrbf {

struct TrackOptions {
  /// Options of every frame; its seed, seeds and start are for the first one. Automatic values are chosen anew for each
  /// frame. One exception: in global mode the energy `automatic` chooses a model for the first frame only; later frames
  /// follow means, or means and standard deviations if the means of the first frame hardly differ. `prior` must be
  /// empty.
  SegmentOptions segment = {};

  /// How much a frame relies on its neighbours, 0 to 100: the cost of a voxel on the wrong side of the expected
  /// contour, in units of the mean cost of a voxel in the wrong region. 0: each frame on its own, except for its start.
  ///
  /// The weight rises linearly with the distance from the expected contour and is full at one centre spacing. It also
  /// rises with the square of the noise of the frame and is full when the noise is half the contrast: clear frames are
  /// followed as they are, noisy ones are smoothed over time. For two regions and any energy but `edge`.
  double persistence = 1;

  /// How far the contour may move from one frame to the next beyond what is expected, in voxels of the shortest edge;
  /// above 0, infinity for no limit. Nothing farther away appears or vanishes. Automatic: half the depth of the deepest
  /// voxel inside, but at least six voxels, or the whole depth if that is less. Not used if persistence is 0.
  std::optional<double> motion = {};

  /// Where the first sweep expects the contour, 0 to 1. 0: where it was in the previous frame; 1: moved on by as much
  /// as it moved to that frame. Automatic: 1 with one sweep, else 0, because the motion of a lost frame misleads.
  std::optional<double> prediction = {};

  /// Sweeps through the sequence, 1 to 100. 1: forwards only, for frames that arrive one by one; the contour lags
  /// behind the motion. 2 or more: the first sweep only carries the contour along (within `motion`); later ones,
  /// alternately backwards and forwards, expect each frame halfway between its two neighbours.
  int sweeps = 2;

  Progress progress = {};  ///< stages of segment(), for all frames together
};

template <int Dim>
struct TrackedFrame {
  Segmentation<Dim> segmentation;
  std::vector<RegionMeasure> regions;  ///< all except 0
};

/// As TrackOptions, with the values chosen in place of automatic ones.
struct TrackSettings {
  SegmentSettings segment = {};
  double persistence = 1;
  std::optional<double> motion = {};
  std::optional<double> prediction = {};
  int sweeps = 2;
};

/// What track() did, and with which settings.
struct TrackReport {
  TrackSettings options;
  std::vector<std::string> warnings;
};

template <int Dim>
struct Tracking {
  std::vector<TrackedFrame<Dim>> frames;
  TrackReport report;
};

/// Returns a frame of a sequence. Called once per frame and sweep, in the order of the sweep.
using FrameSource = std::function<Volume<float>(Index frame)>;

/// Segments the frames of a sequence one after the other (thesis, perspectives of chapter 8). The first frame is
/// segmented by segment(). Each later one starts from the labels before it, with a prior: the signed distance to the
/// expected contour. The region that covers the former inside stays inside. Frames have one value per voxel.
///
/// A frame in which nothing is left inside, or nothing outside, keeps the previous contour, with a warning. More than
/// two regions have no prior: each frame is segmented on its own, and its labels are matched to those of the previous
/// frame by overlap.
///
/// Volumes and areas are those of the continuous level sets, as measured by image_contour().
///
/// Throws InvalidInput for options out of range, a sequence without frames, frames of different size or with several
/// components, and whatever segment() refuses, naming the frame; Cancelled.
template <int Dim>
Tracking<Dim> track(const Volume<float>& sequence, const TrackOptions& options = {});

/// The same with one frame at a time: `read` returns a frame as a volume with one frame, `take` gets each result once
/// it is final. Keeps one image only and, with two or more sweeps, the labels of all frames.
template <int Dim>
TrackReport track(Index frames, const FrameSource& read, const TrackOptions& options,
                  const std::function<void(Index frame, TrackedFrame<Dim>&& tracked)>& take);

}  // namespace csrbf
