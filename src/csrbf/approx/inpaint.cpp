#include "csrbf/approx/inpaint.hpp"

#include "csrbf/approx/images/sparse_blocks.hpp"
#include "csrbf/core/interruption.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

namespace csrbf {
namespace {

constexpr const char* function = "inpaint";
// All chosen by hand. The rim of a hole, whose voxels are samples: large enough for the patches around missing voxels.
constexpr double rim_voxels = 8;     // width
constexpr double rim_depths = 2;     // the same in depths of the deepest hole; the larger one counts
constexpr double useful_share = .5;  // of the known voxels: with more of them in rims all known ones are samples

constexpr Index few = 100;    // samples up to which fit() chooses the method
constexpr double deep = 1.5;  // mean depth of missing voxels, in spacings of known ones, above which they form holes
constexpr Index least_trial_step = 16, most_trial_voxels = 1000;  // of known voxels, to test the fit on
constexpr double first_threshold = 4, last_threshold = 4.0 / 30;  // of blocks, in errors of the fit; see inpaint.md
constexpr double shift_depths = 4;  // how far holes are shifted to test kernels on them, in depths of the deepest one

using Mask = std::vector<unsigned char>;  // one entry per voxel

// City-block distance of every voxel to the nearest one with mask[i] == wanted, in the unit of the spacing. The
// distance is separable: the minimum along one axis after the other, there and back.
std::vector<float> distance_to(bool wanted, const Mask& mask, const Grid& grid) {
  std::vector<float> distance(mask.size());
  for (std::size_t i = 0; i < mask.size(); ++i)
    distance[i] = (mask[i] != 0) == wanted ? 0 : std::numeric_limits<float>::infinity();
  InterruptionPoint pause(1U << 10);
  Index stride = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Index size = grid.size[axis];
    const auto step = static_cast<float>(grid.spacing[static_cast<Index>(axis)]);
    for (Index line = 0; line < grid.voxels(); line += size * stride) {
      const auto relax = [&](Index to, Index from) {
        pause();
        float* target = distance.data() + line + to * stride;
        const float* source = distance.data() + line + from * stride;
        for (Index k = 0; k < stride; ++k) target[k] = std::min(target[k], source[k] + step);
      };
      for (Index i = 1; i < size; ++i) relax(i, i - 1);
      for (Index i = size - 2; i >= 0; --i) relax(i, i + 1);
    }
    stride *= size;
  }
  return distance;
}

// The axes of more than one voxel.
std::vector<int> long_axes(const Grid& grid) {
  std::vector<int> axes;
  for (int a = 0; a < 3; ++a)
    if (grid.size[a] > 1) axes.push_back(a);
  return axes;
}

double mean_spacing(const Grid& grid) {
  const std::vector<int> axes = long_axes(grid);
  double product = 1;
  for (const int a : axes) product *= grid.spacing[a];
  return axes.empty() ? 1 : std::pow(product, 1 / static_cast<double>(axes.size()));
}

// The known voxels that become samples, in ascending order.
std::vector<Index> sample_voxels(const Mask& missing, const Grid& grid, Index known) {
  const std::vector<float> to_known = distance_to(false, missing, grid);
  const double depth = *std::max_element(to_known.begin(), to_known.end());
  const auto rim = static_cast<float>(std::max(rim_voxels * mean_spacing(grid), rim_depths * depth));
  const std::vector<float> to_missing = distance_to(true, missing, grid);
  std::vector<Index> near, all;
  all.reserve(known);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    if (missing[i] != 0) continue;
    all.push_back(static_cast<Index>(i));
    if (to_missing[i] <= rim) near.push_back(static_cast<Index>(i));
  }
  return static_cast<double>(near.size()) < useful_share * static_cast<double>(known) ? near : all;
}

// Physical coordinates along the (long) axes of the image: distances are what they are in space.
template <int Dim>
Points<Dim> positions(const std::vector<Index>& voxels, const Grid& grid) {
  const std::vector<int> axes = long_axes(grid);
  Points<Dim> points = Points<Dim>::Zero(Dim, static_cast<Index>(voxels.size()));
  for (Index k = 0; k < points.cols(); ++k) {
    Index rest = voxels[k];
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const Index size = grid.size[axes[i]];
      points(static_cast<Index>(i), k) = grid.spacing[axes[i]] * static_cast<double>(rest % size);
      rest /= size;
    }
  }
  return points;
}

// Components of one frame with the same missing voxels.
template <class Scalar>
struct Part {
  Eigen::Map<typename Volume<Scalar>::Values> frame;  // components x voxels
  Index first, count;                                 // components
  const Grid& grid;
  Mask missing;

  [[nodiscard]] Index missing_voxels() const {
    return static_cast<Index>(missing.size()) - std::count(missing.begin(), missing.end(), 0);
  }
};

// On images a single system of all samples is hardly better, but far slower.
FitOptions with_method(const FitOptions& options, Index samples) {
  FitOptions used = options;
  const bool is_free = options.method == "auto" && options.kernel == "auto";
  if (is_free && options.tolerance == 0 && options.centers == 0 && samples > few) used.method = "partition-of-unity";
  return used;
}

template <int Dim, class Scalar>
Samples<Dim> samples_at(const std::vector<Index>& voxels, const Part<Scalar>& part) {
  return {positions<Dim>(voxels, part.grid),
          part.frame(Eigen::seqN(part.first, part.count), voxels).transpose().template cast<double>(),
          {}};
}

std::vector<Index> marked(const Mask& mask) {
  std::vector<Index> voxels;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i] != 0) voxels.push_back(static_cast<Index>(i));
  return voxels;
}

// The missing voxels shifted along an axis, where they land on known ones.
Mask shifted(const Mask& missing, const Grid& grid, int axis, Index by) {
  Mask result(missing.size(), 0);
  Index stride = 1;
  for (int a = 0; a < axis; ++a) stride *= grid.size[a];
  const Index size = grid.size[axis];
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const Index to = static_cast<Index>(i) / stride % size + by;
    const std::size_t target = i + static_cast<std::size_t>(by * stride);
    if (missing[i] != 0 && to >= 0 && to < size && missing[target] == 0) result[target] = 1;
  }
  return result;
}

// Holes of the same shape among the known voxels, to test kernels on; empty when the missing voxels are scattered.
Mask trial_holes(const Mask& missing, const Grid& grid, Index known) {
  const std::vector<float> depth = distance_to(false, missing, grid);
  const double sum = std::accumulate(depth.begin(), depth.end(), 0.0);
  const auto voxels = static_cast<double>(missing.size());
  const std::vector<int> axes = long_axes(grid);
  const double spacing = mean_spacing(grid) * std::pow(voxels / static_cast<double>(known),
                                                       1 / static_cast<double>(std::max<std::size_t>(1, axes.size())));
  Mask best;
  if (!(sum > deep * spacing * (voxels - static_cast<double>(known)))) return best;
  const double distance = shift_depths * *std::max_element(depth.begin(), depth.end());
  std::ptrdiff_t most = 0;
  for (const int axis : axes)
    for (const double sign : {1.0, -1.0}) {
      Mask trial = shifted(missing, grid, axis, static_cast<Index>(std::lround(sign * distance / grid.spacing[axis])));
      const auto count = std::count(trial.begin(), trial.end(), 1);
      if (count <= most) continue;
      most = count;
      best = std::move(trial);
    }
  return best;
}

// Some of the known voxels near missing ones: one of each run of `step`, not always at the same place in it.
Mask trial_voxels(const std::vector<Index>& known, std::size_t voxels) {
  Mask hidden(voxels, 0);
  const Index n = std::ssize(known), step = std::max(least_trial_step, n / most_trial_voxels);
  for (Index run = 0; run + step <= n; run += step) hidden[known[run + run / step * 7919 % step]] = 1;
  return hidden;
}

// How a fit is refined.
struct BlockChoice {
  Index width = 0;                  // of the blocks; 0: not at all
  std::vector<double> errors = {};  // of the fit, root mean squares of the components
};

// The values of a component with those of the unknown voxels refined; `error`: theirs.
void refine(Eigen::VectorXd& values, const Mask& unknown, const Grid& grid, Index width, double error) {
  std::array<Index, 3> size{1, 1, 1};
  std::size_t axis = 0;
  for (const int a : long_axes(grid)) size[axis++] = grid.size[a];
  double mean = 0;  // of the unknown ones: what is far away does not matter
  for (Index i = 0; i < values.size(); ++i) mean += unknown[i] != 0 ? values[i] : 0;
  mean /= static_cast<double>(unknown.size() - std::count(unknown.begin(), unknown.end(), 0));
  std::vector<float> scaled(unknown.size());
  for (Index i = 0; i < values.size(); ++i) scaled[i] = static_cast<float>((values[i] - mean) / error);
  refine_by_sparse_blocks(
      scaled, unknown, size,
      {.width = width, .step = width / 4, .first_threshold = first_threshold, .last_threshold = last_threshold});
  for (Index i = 0; i < values.size(); ++i)
    if (unknown[i] != 0) values[i] = mean + error * static_cast<double>(scaled[i]);
}

// Marks the voxels within `reach` voxels of those of a mask along every axis.
Mask grown(Mask mask, const Grid& grid, Index reach) {
  Index stride = 1;
  for (const int a : {0, 1, 2}) {
    const Index size = grid.size[a];
    const Mask before = mask;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (before[i] == 0) continue;
      const Index at = static_cast<Index>(i) / stride % size;
      for (Index to = std::max<Index>(0, at - reach); to <= std::min(size - 1, at + reach); ++to)
        mask[i + static_cast<std::size_t>((to - at) * stride)] = 1;
    }
    stride *= size;
  }
  return mask;
}

// Fits to what is known without some hidden voxels, and the errors there: they choose the kernel, and whether and by
// which blocks the fit is refined.
template <int Dim, class Scalar>
class Trial {
 public:
  Trial(const Part<Scalar>& part, const FitOptions& options) : part_(part), options_(options) {
    const Index known = part.frame.cols() - part.missing_voxels();
    Mask hidden = trial_holes(part.missing, part.grid, known);
    holes_ = std::find(hidden.begin(), hidden.end(), 1) != hidden.end();
    if (!holes_) hidden = trial_voxels(sample_voxels(part.missing, part.grid, known), part.missing.size());
    hidden_ = marked(hidden);
    unknown_ = part.missing;
    for (const Index i : hidden_) unknown_[i] = 1;
    known_ = std::count(unknown_.begin(), unknown_.end(), 0);
    hidden_mask_ = std::move(hidden);
  }

  // Nothing to choose by: too little is known.
  [[nodiscard]] bool is_possible() const { return !hidden_.empty() && known_ > few; }
  [[nodiscard]] bool has_holes() const { return holes_; }

  // Leaving out single voxels favours smooth kernels and high degrees, which overshoot in holes of textured images. So
  // holes of the same shape among the known voxels decide between those and rough kernels about a mean.
  FitOptions choose_kernel(const std::vector<const char*>& kernels) {
    const Samples<Dim> truth = samples_at<Dim>(hidden_, part_);
    const Samples<Dim> samples = samples_at<Dim>(sample_voxels(unknown_, part_.grid, known_), part_);
    FitOptions best = options_;
    double smallest = std::numeric_limits<double>::infinity();
    for (const char* kernel : kernels) {
      FitOptions trial = options_;
      trial.kernel = kernel;
      if (kernels.size() > 1 && trial.kernel != "auto") trial.degree = options_.degree.value_or(0);
      Fit<Dim> fitted = fit(samples, trial);
      std::vector<double> errors;
      double sum = 0;
      for (Index c = 0; c < part_.count; ++c) {
        const double squares = (fitted.components[c]->evaluate(truth.points).value - truth.values.col(c)).squaredNorm();
        errors.push_back(std::sqrt(squares / static_cast<double>(hidden_.size())));
        sum += squares;
      }
      if (!(sum < smallest)) continue;
      smallest = sum;
      best = trial;
      errors_ = std::move(errors);
      fitted_ = std::move(fitted);
    }
    return best;
  }

  // The blocks with the smallest error; none where the fit by itself is better.
  BlockChoice choose_blocks(const std::optional<int>& wanted) {
    const bool exact = errors_.empty() || std::any_of(errors_.begin(), errors_.end(),
                                                      [](double e) { return !(e > 0) || !std::isfinite(e); });
    if (exact) return {};
    if (wanted) return {*wanted, errors_};
    const std::vector<float> depth = distance_to(false, unknown_, part_.grid);
    const double deepest = static_cast<double>(*std::max_element(depth.begin(), depth.end()));
    const bool is_deep = deepest > 8 * mean_spacing(part_.grid);
    double least = static_cast<double>(part_.count);
    BlockChoice best;
    for (Index width = 8; width <= (!holes_ ? 8 : is_deep ? 32 : 16); width *= 2) {
      double sum = 0;
      for (Index c = 0; c < part_.count; ++c) sum += error_with(width, c);
      if (sum >= least) continue;
      least = sum;
      best = {width, errors_};
    }
    return best;
  }

 private:
  // Mean square at the hidden voxels after blocks of that width, over that of the fit.
  double error_with(Index width, Index c) const {
    Mask unknown = grown(hidden_mask_, part_.grid, width);
    for (std::size_t i = 0; i < unknown.size(); ++i) unknown[i] &= unknown_[i];
    Eigen::VectorXd values = part_.frame.row(part_.first + c).transpose().template cast<double>();
    const std::vector<Index> wanted = marked(unknown_);
    values(wanted) = fitted_.components[c]->evaluate(positions<Dim>(wanted, part_.grid)).value;
    refine(values, unknown, part_.grid, width, errors_[c]);
    double sum = 0;
    for (const Index i : hidden_) sum += std::pow(values[i] - static_cast<double>(part_.frame(part_.first + c, i)), 2);
    return sum / static_cast<double>(hidden_.size()) / std::pow(errors_[c], 2);
  }

  const Part<Scalar>& part_;
  const FitOptions& options_;
  bool holes_ = false;
  Index known_ = 0;  // of the trial
  std::vector<Index> hidden_;
  Mask hidden_mask_, unknown_;  // the hidden voxels; with the missing ones
  Fit<Dim> fitted_;
  std::vector<double> errors_;  // at the hidden voxels, of each component
};

template <int Dim, class Scalar>
InpaintReport fill(Part<Scalar>& part, const InpaintOptions& options) {
  const std::vector<Index> known = sample_voxels(part.missing, part.grid, part.frame.cols() - part.missing_voxels());
  Samples<Dim> samples = samples_at<Dim>(known, part);
  FitOptions used = with_method(options, samples.size());
  const bool is_open = used.method == "partition-of-unity" && used.kernel == "auto";
  // Who asks for a method, smoothing or a degree gets the function itself.
  const bool is_free = is_open && options.method == "auto" && !used.smoothing && !used.degree;
  const bool may_refine = Dim > 1 && (options.blocks ? *options.blocks > 0 : is_free);
  BlockChoice blocks;
  if (is_open || may_refine)
    if (Trial<Dim, Scalar> trial(part, used); trial.is_possible() && (trial.has_holes() || may_refine)) {
      const bool several = is_open && trial.has_holes();
      used = trial.choose_kernel(several ? std::vector<const char*>{"auto", "wendland-c2", "wendland-c0"}
                                         : std::vector<const char*>{used.kernel.c_str()});
      if (may_refine) blocks = trial.choose_blocks(options.blocks);
    }
  const Fit<Dim> fitted = fit(samples, used);
  samples = {};

  const std::vector<Index> wanted = marked(part.missing);
  const Points<Dim> points = positions<Dim>(wanted, part.grid);
  for (Index c = 0; c < part.count; ++c) {
    Eigen::VectorXd found = fitted.components[c]->evaluate(points).value;
    if (blocks.width > 0) {
      Eigen::VectorXd values = part.frame.row(part.first + c).transpose().template cast<double>();
      values(wanted) = found;
      refine(values, part.missing, part.grid, blocks.width, blocks.errors[c]);
      found = values(wanted);
    }
    for (Index k = 0; k < found.size(); ++k) part.frame(part.first + c, wanted[k]) = static_cast<Scalar>(found[k]);
  }
  return {.blocks = blocks.width, .fit = fitted.report};
}

template <class Scalar>
InpaintReport fill(Part<Scalar>& part, const InpaintOptions& options) {
  const std::size_t axes = long_axes(part.grid).size();
  if (axes <= 1) return fill<1>(part, options);
  return axes == 2 ? fill<2>(part, options) : fill<3>(part, options);
}

// Components with the same missing voxels are one part, so that they share a fit.
template <class Scalar>
std::vector<Part<Scalar>> parts_of(Volume<Scalar>& image, Index t, const unsigned char* missing) {
  const auto frame = image.frame(t);
  const auto mask_of = [&](Index c) {
    Mask mask(static_cast<std::size_t>(frame.cols()));
    for (Index i = 0; i < frame.cols(); ++i) mask[i] = missing[i] != 0 || !std::isfinite(frame(c, i)) ? 1 : 0;
    return mask;
  };
  std::vector<Part<Scalar>> parts;
  for (Index c = 0; c < image.components; ++c) {
    Mask mask = mask_of(c);
    if (!parts.empty() && parts.back().missing == mask)
      ++parts.back().count;
    else
      parts.push_back({frame, c, 1, image.grid, std::move(mask)});
  }
  return parts;
}

void check(const VolumeLayout& image, Index values, Index missing) {
  require(values == image.values_per_frame() * image.frames, function, "values of the image", values,
          "one per component, voxel and frame is needed");
  require(missing == image.grid.voxels() || missing == image.grid.voxels() * image.frames, function,
          "entries of the mask", missing,
          "there must be one per voxel (" + std::to_string(image.grid.voxels()) + ") or per voxel of every frame");
  require(image.grid.spacing.allFinite() && image.grid.spacing.minCoeff() > 0, function, "spacing",
          image.grid.spacing.transpose(), "must be positive");
}

Progress of_frame(const Progress& progress, Index t, Index frames) {
  if (!progress || frames == 1) return progress;
  return [&progress, t, frames](std::string_view stage, double fraction) {
    return progress(stage, (static_cast<double>(t) + fraction) / static_cast<double>(frames));
  };
}

}  // namespace

template <class Scalar>
InpaintReport inpaint(Volume<Scalar>& image, const std::vector<unsigned char>& missing, const InpaintOptions& options) {
  if (options.blocks)
    require(*options.blocks == 0 || (*options.blocks >= 4 && *options.blocks <= 64), function, "blocks",
            *options.blocks, "must be 0 (none) or a width of 4 to 64 voxels");
  check(image, static_cast<Index>(image.values.size()), static_cast<Index>(missing.size()));
  InpaintReport report;
  const bool same_mask = static_cast<Index>(missing.size()) == image.grid.voxels();
  for (Index t = 0; t < image.frames; ++t) {
    InpaintOptions frame_options = options;
    frame_options.scale_axes = false;
    frame_options.progress = of_frame(options.progress, t, image.frames);
    for (Part<Scalar>& part : parts_of(image, t, missing.data() + (same_mask ? 0 : t * image.grid.voxels()))) {
      const Index unknown = part.missing_voxels();
      const Index known = part.frame.cols() - unknown;
      require(known > 0, function, "known voxels", 0, "frame " + std::to_string(t + 1) + " has no known value");
      if (unknown > 0) {
        InpaintReport filled = fill(part, frame_options);
        if (report.missing == 0) {
          report.fit = std::move(filled.fit);
          report.blocks = filled.blocks;
        }
      }
      report.missing += unknown * part.count;
      report.known += known * part.count;
    }
  }
  return report;
}

template InpaintReport inpaint(Volume<float>&, const std::vector<unsigned char>&, const InpaintOptions&);
template InpaintReport inpaint(Volume<double>&, const std::vector<unsigned char>&, const InpaintOptions&);

}  // namespace csrbf
