#include "csrbf/levelset/track.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/levelset/image/signed_distance.hpp"
#include "csrbf/levelset/regions/region_labels.hpp"
#include "csrbf/levelset/segment_checks.hpp"

#include <Eigen/Geometry>

#include <utility>

namespace csrbf {
namespace {

constexpr const char* track_function = "track";
// Chosen by hand.
constexpr double barrier = 2;       // cost, in wrong voxels, of what moved farther than it may
constexpr double full_noise = 0.5;  // noise of a frame over its contrast from which the prior has its full weight
constexpr double one_sided = 0.5;   // weight of an expectation from one neighbour, which motion displaces

void check_options(const TrackOptions& options) {
  require(options.persistence >= 0 && options.persistence <= 100, track_function, "persistence", options.persistence,
          "must be 0 to 100");
  if (options.motion)
    require(*options.motion > 0, track_function, "motion", *options.motion,
            "must be positive, in voxels; infinity: no limit");
  if (options.prediction)
    require(*options.prediction >= 0 && *options.prediction <= 1, track_function, "prediction", *options.prediction,
            "must be 0 to 1");
  require(options.sweeps >= 1 && options.sweeps <= 100, track_function, "sweeps", options.sweeps, "must be 1 to 100");
  require(options.segment.prior.empty(), track_function, "prior size", options.segment.prior.size(),
          "the prior is made from frame to frame; leave it empty");
}

// One of the two labels has all voxels of the mask.
bool is_empty(const SegmentReport& report) {
  return report.regions[0].voxels == 0 || report.regions[1].voxels == 0;
}

// The energy of frames after one that was described so. Deviations of their own hold a contour back where both sides of
// it are inside, so that they count only where means hardly differ.
SegmentEnergy followed_energy(const SegmentReport& found) {
  const RegionReport &outside = found.regions[0], &inside = found.regions[1];
  const bool is_clear = std::abs(inside.mean - outside.mean) > std::max(inside.sd, outside.sd);
  const SegmentEnergy chosen = found.options.energy;
  return chosen == SegmentEnergy::chan_vese || is_clear ? SegmentEnergy::chan_vese : SegmentEnergy::gaussian;
}

// Gives the regions the labels of those before that they overlap most, the largest overlaps first.
template <int Dim>
void match_labels(const std::vector<std::uint8_t>& before, Segmentation<Dim>& now) {
  const std::size_t n = now.fields.size();
  struct Overlap {
    Index voxels;
    std::size_t from, to;
  };
  std::vector<Overlap> overlaps;
  for (std::size_t from = 0; from < n; ++from)
    for (std::size_t to = 0; to < n; ++to) overlaps.push_back({0, from, to});
  for (std::size_t i = 0; i < before.size(); ++i) ++overlaps[now.labels[i] * n + before[i]].voxels;
  std::stable_sort(overlaps.begin(), overlaps.end(),
                   [](const Overlap& a, const Overlap& b) { return a.voxels > b.voxels; });
  std::vector<std::size_t> renamed(n, n);
  std::vector<bool> taken(n, false);
  for (const Overlap& overlap : overlaps)
    if (renamed[overlap.from] == n && !taken[overlap.to]) {
      renamed[overlap.from] = overlap.to;
      taken[overlap.to] = true;
    }
  for (std::uint8_t& label : now.labels) label = static_cast<std::uint8_t>(renamed[label]);
  auto fields = now.fields;
  auto regions = now.report.regions;
  for (std::size_t k = 0; k < n; ++k) {
    fields[renamed[k]] = now.fields[k];
    regions[renamed[k]] = now.report.regions[k];
    regions[renamed[k]].label = static_cast<int>(renamed[k]);
  }
  now.fields = std::move(fields);
  now.report.regions = std::move(regions);
}

// Signed distance of every voxel centre to the contour f = 0 of a segmentation, positive inside: next to the contour
// f / |grad f|, elsewhere signed_distance().
template <int Dim>
std::vector<float> contour_distance(const Grid& grid, const std::vector<std::uint8_t>& labels,
                                    const Field<Dim>& field) {
  const auto edge = static_cast<float>(grid.spacing.template head<Dim>().minCoeff());
  std::vector<float> distance = signed_distance(grid, labels.data());

  // Next to the contour the level set is more exact than the voxels.
  std::vector<Index> close;
  for (std::size_t i = 0; i < distance.size(); ++i)
    if (std::abs(distance[i]) < edge) close.push_back(static_cast<Index>(i));
  Points<Dim> points(Dim, std::ssize(close));
  const auto to_physical = grid.to_physical<Dim>();
  for (Index k = 0; k < points.cols(); ++k) {
    Index rest = close[k];
    Point<Dim> voxel;
    for (Index a = 0; a < Dim; ++a) {
      voxel[a] = static_cast<double>(rest % grid.size[a]);
      rest /= grid.size[a];
    }
    points.col(k) = to_physical * voxel;
  }
  const Jet<Dim> jet = field.evaluate(points, Derivatives::gradient);
  const float farthest = 1.5F * edge;  // these voxels are at most an edge off; by hand, against small slopes
  for (Index k = 0; k < points.cols(); ++k) {
    const double slope = jet.gradient.col(k).norm();
    if (!(slope > 0)) continue;
    distance[close[k]] = std::clamp(static_cast<float>(jet.value[k] / slope), -farthest, farthest);
  }
  return distance;
}

// Carries labels and settings from frame to frame.
template <int Dim>
class Tracker {
 public:
  Tracker(Index frames, const FrameSource& read, const TrackOptions& options)
      : frames_(frames), read_(read), options_(options), states_(static_cast<std::size_t>(frames)) {
    report_.options = {options.segment, options.persistence, options.motion, options.prediction, options.sweeps};
    const SegmentOptions& base = options.segment;
    remembers_ = options.persistence > 0 && base.regions == 2 &&
                 (base.energy != SegmentEnergy::edge || static_cast<bool>(base.force));
    sweeps_ = remembers_ && frames > 1 ? options.sweeps : 1;
    if (!options.prediction) report_.options.prediction = sweeps_ == 1 ? 1 : 0;
  }

  TrackReport run(const std::function<void(Index, TrackedFrame<Dim>&&)>& take) {
    for (int sweep = 0; sweep < sweeps_; ++sweep) {
      for (Index k = 0; k < frames_; ++k) {
        const Index t = sweep % 2 == 0 ? k : frames_ - 1 - k;
        done_ = static_cast<double>(sweep * frames_ + k);
        TrackedFrame<Dim> tracked = visit(t, sweep);
        if (sweep + 1 == sweeps_) take(t, std::move(tracked));
      }
    }
    return std::move(report_);
  }

 private:
  // A frame as found so far.
  struct State {
    std::vector<std::uint8_t> labels;
    std::vector<std::shared_ptr<const Field<Dim>>> fields;
    double noise = 0, spacing = 1;  // of the frame, over its contrast; of the centres, in voxels
  };

  State& state(Index t) { return states_[t]; }
  std::vector<float> distance(Index t) { return contour_distance(grid_, state(t).labels, *state(t).fields[0]); }

  // Of noisy frames with memory, which smooths, too: noise alone would ask for centres farther apart than what is small
  // or thin bears. None where noise is weak. Chosen on discs and bars of 3 to 44 voxels in noise of 10 to 160 %.
  std::optional<double> spacing_in_noise(Index last) {
    constexpr double weak = 0.2, share = 0.5, least = 2, largest = 4, small = 4;  // of the contrast; the depth; voxels
    const std::vector<float> d = distance(last);
    const double edge = grid_.spacing.template head<Dim>().minCoeff();
    const double depth = static_cast<double>(*std::max_element(d.begin(), d.end())) / edge;
    if (state(last).noise < weak && depth > small) return std::nullopt;
    return std::clamp(share * depth, least, largest);
  }

  // Of a local contour all is chosen for each frame anew. Of others the first frame says what model they have: what
  // else a frame shows does not change it.
  [[nodiscard]] SegmentOptions segment_options(bool is_first) const {
    SegmentOptions options = options_.segment;
    if (is_first) return options;
    if (chooses_model(options) && options.regions == 2) {
      options.energy = report_.options.segment.energy;
      // As general as such an energy allows.
      if (options.shading == Shading::smooth) options.shading = Shading::quadratic;
      if (options.shading == Shading::objects || options.shading == Shading::background)
        options.shading = Shading::none;
    }
    options.seed.clear();
    options.start.clear();
    options.seeds.clear();
    options.seed_confidences.clear();
    return options;
  }

  TrackedFrame<Dim> visit(Index t, int sweep) {
    const Volume<float> image = read_(t);
    const bool is_first = sweep == 0 && t == 0;
    if (is_first)
      grid_ = image.grid;
    else
      require(image.grid.size == grid_.size, track_function, "size of frame " + std::to_string(t),
              size_text(image.grid), "must be that of the first frame, " + size_text(grid_));
    const Index last = sweep == 0 ? t - 1 : t;  // whose labels are known
    SegmentOptions options = segment_options(is_first);
    options.progress = progress();
    if (last >= 0 && options.regions == 2) {
      const std::vector<std::uint8_t>& labels = state(last).labels;
      const bool has_inside = std::find(labels.begin(), labels.end(), 1) != labels.end();
      const bool moves = options.mode == SegmentMode::local || options.energy == SegmentEnergy::edge;
      // Where a local contour was is where it starts, not what it must keep.
      if (has_inside && (remembers_ || moves)) options.start = labels;
      if (has_inside && (!moves || options.energy == SegmentEnergy::edge)) options.seed = labels;
      if (remembers_) {
        if (has_inside && !moves && !options.center_spacing) options.center_spacing = spacing_in_noise(last);
        options.prior = prior(t, sweep, last);
      }
    }
    TrackedFrame<Dim> tracked;
    try {
      if (image.components == 1) (void)finite_values(image, options.mask);
      tracked.segmentation = segment<Dim>(image, options);
    } catch (const InvalidInput& error) {
      if (frames_ == 1) throw;
      throw InvalidInput("track: frame " + std::to_string(t) + ": " + error.what());
    }
    settle(t, sweep, image, tracked.segmentation);
    state(t) = {tracked.segmentation.labels, tracked.segmentation.fields, tracked.segmentation.report.noise,
                *tracked.segmentation.report.options.center_spacing};
    if (sweeps_ == 1 && t > 1) state(t - 2) = {};
    if (sweep + 1 == sweeps_) tracked.regions = measure_segmentation(tracked.segmentation, grid_);
    return tracked;
  }

  // Keeps what the first frame chose, and the region.
  void settle(Index t, int sweep, const Volume<float>& image, Segmentation<Dim>& found) {
    if (sweep == 0 && t == 0) {
      SegmentSettings& used = report_.options.segment;
      used = found.report.options;
      if (chooses_model(options_.segment) && used.regions == 2) used.energy = followed_energy(found.report);
    } else if (options_.segment.regions > 2) {
      match_labels(state(t - 1).labels, found);
    } else if (is_empty(found.report)) {
      const Index from = sweep == 0 ? t - 1 : t;
      found.labels = state(from).labels;
      found.fields = state(from).fields;
      remeasure(image, found);
      if (sweep == 0)
        report_.warnings.push_back("frame " + std::to_string(t) + ": nothing can be told apart; the contour of frame " +
                                   std::to_string(from) + " is kept");
    }
    for (const std::string& warning : found.report.warnings)
      if (sweep + 1 == sweeps_) report_.warnings.push_back("frame " + std::to_string(t) + ": " + warning);
  }

  void remeasure(const Volume<float>& image, Segmentation<Dim>& found) const {
    const std::vector<std::uint8_t>& mask = options_.segment.mask;
    found.report.regions = measure_regions(found.labels, image.values, grid_, mask, options_.segment.regions);
    found.report.components = count_components(found.labels, grid_);
  }

  // Halfway between the neighbours of a frame. At the ends where its one neighbour is: measured, to go on as the frames
  // before it moved adds half to the roughness of volumes.
  std::vector<float> between(Index t) {
    if (t == 0) return distance(1);
    std::vector<float> d = distance(t - 1);
    if (t + 1 == frames_) return d;
    const std::vector<float> after = distance(t + 1);
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = 0.5F * (d[i] + after[i]);
    return d;
  }

  // What it costs to be inside where the contour is not expected.
  std::vector<float> prior(Index t, int sweep, Index last) {
    std::vector<float> d = sweep == 0 ? distance(last) : between(t);
    const double prediction = *report_.options.prediction;
    if (sweep == 0 && prediction > 0 && last > 0) {
      const std::vector<float> before = distance(last - 1);
      const auto further = static_cast<float>(prediction);
      for (std::size_t i = 0; i < d.size(); ++i) d[i] += further * (d[i] - before[i]);
    }
    const double edge = grid_.spacing.template head<Dim>().minCoeff();
    const double unit = state(last).spacing * edge;
    if (!report_.options.motion) {
      constexpr double least = 6, share = 0.5;  // voxels, or the depth; of the depth: TrackOptions::motion
      const double depth = static_cast<double>(*std::max_element(d.begin(), d.end()));
      report_.options.motion = std::max(share * depth / edge, std::min(least, depth / edge));
    }
    // When more sweeps follow, the first one leaves the frames to themselves: what it would remember are lags.
    double weight = sweep == 0 && sweeps_ > 1 ? 0 : options_.persistence;
    // As the variance of where a frame says that the contour is.
    weight *= std::min(1.0, std::pow(state(last).noise / full_noise, 2));
    if (sweep > 0 && (t == 0 || t + 1 == frames_)) weight *= one_sided;
    const double reach = *report_.options.motion * edge;
    for (float& value : d) {
      const double along = static_cast<double>(value) / unit, far = std::abs(static_cast<double>(value)) - reach;
      const double cost =
          weight * std::clamp(along, -1.0, 1.0) + std::copysign(barrier * std::clamp(far / unit, 0.0, 1.0), along);
      value = static_cast<float>(-cost);
    }
    return d;
  }

  [[nodiscard]] Progress progress() const {
    if (!options_.progress) return {};
    return [this](std::string_view stage, double fraction) {
      return options_.progress(stage, (done_ + fraction) / static_cast<double>(sweeps_ * frames_));
    };
  }

  Index frames_;
  const FrameSource& read_;
  const TrackOptions& options_;
  TrackReport report_;  // its options hold what was chosen
  Grid grid_;
  std::vector<State> states_;
  bool remembers_ = false;
  int sweeps_ = 1;
  double done_ = 0;  // frames, over all sweeps
};

}  // namespace

template <int Dim>
TrackReport track(Index frames, const FrameSource& read, const TrackOptions& options,
                  const std::function<void(Index, TrackedFrame<Dim>&&)>& take) {
  require(frames > 0, track_function, "frames", frames, "there must be a frame");
  check_options(options);
  const FrameSource checked = [&](Index t) {
    Volume<float> image = read(t);
    require(image.components == 1, track_function, "components", image.components,
            "frames must have one value per voxel: convert colours to grey");
    return image;
  };
  return Tracker<Dim>(frames, checked, options).run(take);
}

template <int Dim>
Tracking<Dim> track(const Volume<float>& sequence, const TrackOptions& options) {
  require(std::ssize(sequence.values) == sequence.values_per_frame() * sequence.frames, track_function,
          "number of values", sequence.values.size(), "must be that of the voxels of all frames");
  Tracking<Dim> tracking;
  tracking.frames.resize(std::max<Index>(sequence.frames, 0));
  const FrameSource read = [&](Index t) {
    VolumeLayout layout = sequence;
    layout.frames = 1;
    Volume<float> image(layout);
    std::copy_n(sequence.values.begin() + t * sequence.values_per_frame(), image.values.size(), image.values.begin());
    return image;
  };
  tracking.report = track<Dim>(sequence.frames, read, options,
                               [&](Index t, TrackedFrame<Dim>&& frame) { tracking.frames[t] = std::move(frame); });
  return tracking;
}

#define CSRBF_INSTANTIATE(Dim)                                                    \
  template Tracking<Dim> track<Dim>(const Volume<float>&, const TrackOptions&);   \
  template TrackReport track<Dim>(Index, const FrameSource&, const TrackOptions&, \
                                  const std::function<void(Index, TrackedFrame<Dim> &&)>&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
