#include "csrbf/approx/inpaint.hpp"

#include "csrbf/approx/images/grid_spline.hpp"
#include "csrbf/approx/images/hole_boxes.hpp"
#include "csrbf/approx/images/image_part.hpp"
#include "csrbf/approx/images/sparse_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

namespace csrbf {
namespace {

constexpr const char* inpaint_function = "inpaint";

constexpr Index few = 100;                                        // samples up to which fit() chooses the method
constexpr double first_threshold = 4, last_threshold = 4.0 / 30;  // of blocks, in errors of the fit; see inpaint.md

constexpr Index most_in_plane = 50000, most_in_space = 8000;  // unknown voxels of a spline on the grid
// Error of a spline over the spread of the values below which an image is smooth. In space a fit takes seconds a hole.
template <int Dim>
constexpr double smooth = Dim == 3 ? 0.02 : 0.1;

// On images a single system of all samples is hardly better, but far slower.
FitOptions with_method(const FitOptions& options, Index samples) {
  FitOptions used = options;
  const bool is_free = options.method == "auto" && options.kernel == "auto";
  if (is_free && options.tolerance == 0 && options.centers == 0 && samples > few) used.method = "partition-of-unity";
  return used;
}

// What fills a part: a fit or a spline on the grid, and the blocks that refine it.
struct Plan {
  FitOptions fit;
  std::optional<double> tension = {};  // of the spline
  Index width = 0;                     // of the blocks; 0: none
  double plate = 0;                    // share of a thin plate in the mean with what all this says
  std::vector<double> errors = {};     // before the blocks, root mean squares of the components; of a trial
};

// The values of a component with those of the unknown voxels refined; `error`: theirs.
void refine(Eigen::Ref<Eigen::VectorXd> values, const VoxelMask& unknown, const Grid& grid, Index width, double error) {
  std::array<Index, 3> size{1, 1, 1};
  std::size_t axis = 0;
  for (const int a : long_axes(grid)) size[axis++] = grid.size[a];
  double mean = 0;  // of the unknown ones: what is far away does not matter
  for (Index i = 0; i < values.size(); ++i) mean += unknown[i] != 0 ? values[i] : 0;
  mean /= static_cast<double>(unknown.size() - std::count(unknown.begin(), unknown.end(), 0));
  std::vector<float> scaled(unknown.size());
  for (Index i = 0; i < values.size(); ++i) scaled[i] = static_cast<float>((values[i] - mean) / error);
  refine_by_sparse_blocks(scaled, unknown, size,
                          {.width = width,
                           .step = axis == 3 ? width / 2 : width / 4,
                           .first_threshold = first_threshold,
                           .last_threshold = last_threshold});
  for (Index i = 0; i < values.size(); ++i)
    if (unknown[i] != 0) values[i] = mean + error * static_cast<double>(scaled[i]);
}

// The components of a part, one column each, whose `unknown` voxels the plan fills by all others.
template <int Dim, class Scalar>
Eigen::MatrixXd filled_at_once(const ImagePart<Scalar>& part, const VoxelMask& unknown, const Plan& plan, bool in_rims,
                               FitReport& report) {
  const Index known = std::count(unknown.begin(), unknown.end(), 0);
  const std::vector<Index> wanted = marked(unknown);
  std::vector<Index> samples;
  if (in_rims) samples = sample_voxels(unknown, part.grid, known);
  for (Index i = 0; i < std::ssize(unknown) && !in_rims; ++i)
    if (unknown[i] == 0) samples.push_back(i);
  Eigen::MatrixXd values = part.frame.middleRows(part.first, part.count).transpose().template cast<double>();
  if (plan.tension) {
    fill_by_grid_spline(part.grid, unknown, *plan.tension, values);
    report = {};
    report.method = "grid-spline";
    report.samples = report.samples_fitted = std::ssize(samples);
    report.centers = std::ssize(wanted);
    return values;
  }
  const Fit<Dim> fitted = fit(samples_at<Dim>(samples, part), plan.fit);
  const Points<Dim> points = voxel_positions<Dim>(wanted, part.grid);
  for (Index c = 0; c < part.count; ++c) values(wanted, c) = fitted.components[c]->evaluate(points).value;
  report = fitted.report;
  return values;
}

// The same hole by hole where there are several in space, for a fit to the rims of all would fill what is between them,
// too. Only holes with a voxel in `wanted` are filled.
template <int Dim, class Scalar>
Eigen::MatrixXd filled(const ImagePart<Scalar>& part, const VoxelMask& unknown, const VoxelMask& wanted,
                       const Plan& plan, FitReport& report) {
  const std::vector<HoleBox> boxes = Dim == 3 ? hole_boxes(unknown, part.grid) : std::vector<HoleBox>();
  // In space there is more between rims than in them, and it would be filled, too.
  if (boxes.empty()) return filled_at_once<Dim>(part, unknown, plan, Dim < 3, report);
  Eigen::MatrixXd values = part.frame.middleRows(part.first, part.count).transpose().template cast<double>();
  Plan here = plan;
  here.fit.progress = {};
  report = {};
  Index samples = 0, centers = 0, done = 0;
  for (const HoleBox& box : boxes) {
    csrbf::report(plan.fit.progress, "fill", static_cast<double>(done++) / static_cast<double>(boxes.size()));
    if (std::none_of(box.hole.begin(), box.hole.end(), [&](Index i) { return wanted[i] != 0; })) continue;
    const Grid grid = box.grid(part.grid);
    const std::vector<Index> voxels = box.voxels(part.grid);
    typename Volume<Scalar>::Values frame = part.frame(Eigen::all, voxels);
    const ImagePart<Scalar> some{{frame.data(), frame.rows(), frame.cols()}, part.first, part.count, grid, {}};
    VoxelMask missing(voxels.size());
    for (std::size_t i = 0; i < voxels.size(); ++i) missing[i] = unknown[voxels[i]];
    FitReport its;
    const Eigen::MatrixXd found = filled_at_once<Dim>(some, missing, here, false, its);
    std::size_t next = 0;
    for (std::size_t i = 0; i < voxels.size() && next < box.hole.size(); ++i) {
      if (voxels[i] != box.hole[next]) continue;
      values.row(voxels[i]) = found.row(static_cast<Index>(i));
      ++next;
    }
    samples += its.samples;
    centers += its.centers;
    if (its.samples > report.samples) report = std::move(its);
  }
  report.samples = report.samples_fitted = samples;
  report.centers = centers;
  return values;
}

// Fills hidden voxels and compares them with what they are: to choose kernel or spline, and the blocks.
template <int Dim, class Scalar>
class Trial {
 public:
  Trial(const ImagePart<Scalar>& part, const FitOptions& options) : part_(part), best_{options} {
    const Index known = part.frame.cols() - part.missing_voxels();
    hidden_mask_ = some_holes(trial_holes(part.missing, part.grid, known), part.grid);
    hidden_ = marked(hidden_mask_);
    has_holes_ = !hidden_.empty();
    if (!has_holes_) {
      hidden_mask_ = trial_voxels(sample_voxels(part.missing, part.grid, known), part.missing.size());
      hidden_ = marked(hidden_mask_);
    }
    unknown_ = part.missing;
    for (const Index i : hidden_) unknown_[i] = 1;
    truth_ = part.frame(Eigen::seqN(part.first, part.count), hidden_).transpose().template cast<double>();
    const std::vector<float> depth = distance_to(false, unknown_, part.grid);
    depth_ = static_cast<double>(*std::max_element(depth.begin(), depth.end())) / mean_spacing(part.grid);
  }

  // Whether there is enough to choose by.
  [[nodiscard]] bool is_possible() const {
    return !hidden_.empty() && std::count(unknown_.begin(), unknown_.end(), 0) > few;
  }
  [[nodiscard]] bool has_holes() const { return has_holes_; }
  [[nodiscard]] const Plan& best() const { return best_; }

  // The share of a thin plate in a mean with the best plan, whose errors cancel in part: what suits the hidden voxels,
  // and one more hole that would say a half.
  void choose_mean() {
    if (plate_.size() == 0 || (best_.tension == 0.0 && best_.width == 0)) return;
    const Eigen::MatrixXd off = refined_ - truth_, step = plate_ - refined_;
    const double trials = std::max(1.0, static_cast<double>(hidden_.size()) / std::pow(2 * depth_ - 1, Dim));
    const double squares = step.squaredNorm();
    if (!(squares > 0)) return;
    const double share = -off.cwiseProduct(step).sum() / squares;  // of the least squares
    best_.plate = std::clamp((trials * share + 0.5) / (trials + 1), 0.0, 1.0);
  }

  // Splines on the grid from thin plates, which follow slopes, to membranes, which overshoot nowhere, while that helps.
  void try_splines() {
    // In space holes that are apart are systems of their own.
    const Index unknowns = Dim == 3 ? largest_hole(unknown_, part_.grid) : std::ssize(marked(unknown_));
    if (unknowns > (Dim == 2 ? most_in_plane : most_in_space)) return;
    for (const double c : {0.0, 4.0, 100.0}) {
      Plan plan = best_;
      plan.tension = c / (depth_ * depth_);
      if (!consider(plan)) break;
    }
  }

  // A smooth image: then fits of high degree may be far better than splines.
  [[nodiscard]] bool is_smooth() const {
    const Eigen::MatrixXd off = truth_.rowwise() - truth_.colwise().mean();
    return least_ < smooth<Dim> * smooth<Dim> * off.squaredNorm();
  }

  // Leaving out single voxels favours smooth kernels and high degrees, which overshoot in holes of textured images. So
  // holes of the same shape among the known voxels decide between those and rough kernels about a mean.
  void try_kernels(const std::vector<std::string>& kernels) {
    const FitOptions given = best_.fit;
    for (const std::string& kernel : kernels) {
      Plan plan{given};
      plan.fit.kernel = kernel;
      if (kernels.size() > 1 && kernel != "auto") plan.fit.degree = given.degree.value_or(0);
      consider(plan);
    }
  }

  // The blocks with the smallest error; none where it is smaller without.
  void choose_blocks(const std::optional<int>& wanted) {
    const bool exact = best_.errors.empty() || std::any_of(best_.errors.begin(), best_.errors.end(),
                                                           [](double e) { return !(e > 0) || !std::isfinite(e); });
    if (exact) return;
    if (wanted) {
      best_.width = *wanted;
      return;
    }
    const bool is_deep = depth_ > 8;
    double least = static_cast<double>(part_.count);
    for (Index width = 8; width <= (!has_holes_ ? 8 : is_deep ? 32 : 16); width *= 2) {
      double sum = 0;
      Eigen::MatrixXd found = truth_;
      for (Index c = 0; c < part_.count; ++c) {
        found.col(c) = refined_at(width, c);
        sum += (found.col(c) - truth_.col(c)).squaredNorm() / static_cast<double>(hidden_.size()) /
               std::pow(best_.errors[c], 2);
      }
      if (sum >= least) continue;
      least = sum;
      best_.width = width;
      refined_ = found;
    }
  }

 private:
  // Whether the plan is the best one so far.
  bool consider(const Plan& plan) {
    FitReport report;
    Eigen::MatrixXd values = filled<Dim>(part_, unknown_, hidden_mask_, plan, report);
    const Eigen::RowVectorXd squares = (values(hidden_, Eigen::all) - truth_).colwise().squaredNorm();
    if (!(squares.sum() < least_)) return false;
    least_ = squares.sum();
    best_ = plan;
    best_.errors.clear();
    for (const double sum : squares) best_.errors.push_back(std::sqrt(sum / static_cast<double>(hidden_.size())));
    values_ = std::move(values);
    refined_ = values_(hidden_, Eigen::all);
    if (plan.tension == 0.0) plate_ = refined_;
    return true;
  }

  // Values of the hidden voxels after blocks of that width.
  [[nodiscard]] Eigen::VectorXd refined_at(Index width, Index c) const {
    VoxelMask unknown = grown(hidden_mask_, part_.grid, width);
    for (std::size_t i = 0; i < unknown.size(); ++i) unknown[i] &= unknown_[i];
    Eigen::VectorXd values = values_.col(c);
    refine(values, unknown, part_.grid, width, best_.errors[c]);
    return values(hidden_);
  }

  const ImagePart<Scalar>& part_;
  bool has_holes_ = false;
  double depth_ = 0;  // of the deepest hole, in voxels
  std::vector<Index> hidden_;
  VoxelMask hidden_mask_, unknown_;  // the hidden voxels; with the missing ones
  Eigen::MatrixXd truth_;            // of the hidden voxels
  Plan best_;
  Eigen::MatrixXd values_;           // by the best plan without blocks
  Eigen::MatrixXd refined_, plate_;  // of the hidden voxels, by the best plan and by a thin plate
  double least_ = std::numeric_limits<double>::infinity();
};

template <int Dim, class Scalar>
Plan choose_plan(const ImagePart<Scalar>& part, const InpaintOptions& options) {
  const Index known = part.frame.cols() - part.missing_voxels();
  FitOptions fit = with_method(options, std::ssize(sample_voxels(part.missing, part.grid, known)));
  if (const std::optional<InpaintPlan>& given = options.plan) {
    require(given->blocks == 0 || std::ssize(given->errors) == part.count, inpaint_function, "errors of the plan",
            given->errors.size(), "there must be one for each component that blocks refine");
    fit.kernel = given->kernel;
    fit.degree = given->degree;
    return {fit, given->tension, given->blocks, given->thin_plate, given->errors};
  }
  const bool is_open = fit.method == "partition-of-unity" && fit.kernel == "auto";
  // Who asks for a method, smoothing or a degree gets the function itself.
  const bool is_free = Dim > 1 && is_open && options.method == "auto" && !fit.smoothing && !fit.degree;
  const bool may_refine = Dim > 1 && (options.blocks ? *options.blocks > 0 : is_free);
  if (!is_open && !may_refine) return {fit};
  Trial<Dim, Scalar> trial(part, fit);
  if (!trial.is_possible()) return {fit};
  if (is_free) trial.try_splines();
  if (!trial.has_holes()) {
    const bool by_spline = Dim == 3 && trial.best().tension && !trial.is_smooth();  // much faster
    if (may_refine && !by_spline) trial.try_kernels({fit.kernel});
  } else if (is_open && (!trial.best().tension || trial.is_smooth())) {
    trial.try_kernels({"auto", "wendland-c2", "wendland-c0"});
  } else if (may_refine && !is_open) {
    trial.try_kernels({fit.kernel});
  }
  if (may_refine) trial.choose_blocks(options.blocks);
  if (is_free && may_refine) trial.choose_mean();
  return trial.best();
}

template <int Dim, class Scalar>
InpaintReport fill(ImagePart<Scalar>& part, const InpaintOptions& options) {
  const Plan plan = choose_plan<Dim>(part, options);
  InpaintReport report;
  Eigen::MatrixXd values = filled<Dim>(part, part.missing, part.missing, plan, report.fit);
  report.plan = {plan.fit.kernel, plan.fit.degree, plan.tension, plan.width, plan.plate, plan.errors};
  if (plan.tension && !plan.errors.empty()) report.fit.cross_validation_rmse = plan.errors[0];
  for (Index c = 0; c < part.count; ++c)
    if (plan.width > 0) refine(values.col(c), part.missing, part.grid, plan.width, plan.errors[c]);
  if (plan.plate > 0) {
    FitReport ignored;
    const Eigen::MatrixXd plate = filled<Dim>(part, part.missing, part.missing, {plan.fit, 0.0}, ignored);
    values = (1 - plan.plate) * values + plan.plate * plate;
  }
  for (Index c = 0; c < part.count; ++c) {
    for (const Index i : marked(part.missing)) part.frame(part.first + c, i) = static_cast<Scalar>(values(i, c));
  }
  return report;
}

template <class Scalar>
InpaintReport fill(ImagePart<Scalar>& part, const InpaintOptions& options) {
  const std::size_t axes = long_axes(part.grid).size();
  if (axes <= 1) return fill<1>(part, options);
  return axes == 2 ? fill<2>(part, options) : fill<3>(part, options);
}

// Components with the same missing voxels are one part, so that they share a fit.
template <class Scalar>
std::vector<ImagePart<Scalar>> parts_of(Volume<Scalar>& image, Index t, const unsigned char* missing) {
  const auto frame = image.frame(t);
  const auto mask_of = [&](Index c) {
    VoxelMask mask(static_cast<std::size_t>(frame.cols()));
    for (Index i = 0; i < frame.cols(); ++i) mask[i] = missing[i] != 0 || !std::isfinite(frame(c, i)) ? 1 : 0;
    return mask;
  };
  std::vector<ImagePart<Scalar>> parts;
  for (Index c = 0; c < image.components; ++c) {
    VoxelMask mask = mask_of(c);
    if (!parts.empty() && parts.back().missing == mask)
      ++parts.back().count;
    else
      parts.push_back({frame, c, 1, image.grid, std::move(mask)});
  }
  return parts;
}

void check_image(const VolumeLayout& image, Index values, Index missing) {
  require(values == image.values_per_frame() * image.frames, inpaint_function, "values of the image", values,
          "one per component, voxel and frame is needed");
  require(missing == image.grid.voxels() || missing == image.grid.voxels() * image.frames, inpaint_function,
          "entries of the mask", missing,
          "there must be one per voxel (" + std::to_string(image.grid.voxels()) + ") or per voxel of every frame");
  require(image.grid.spacing.allFinite() && image.grid.spacing.minCoeff() > 0, inpaint_function, "spacing",
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
    require(*options.blocks == 0 || (*options.blocks >= 4 && *options.blocks <= 64), inpaint_function, "blocks",
            *options.blocks, "must be 0 (none) or a width of 4 to 64 voxels");
  check_image(image, static_cast<Index>(image.values.size()), static_cast<Index>(missing.size()));
  InpaintReport report;
  const bool same_mask = static_cast<Index>(missing.size()) == image.grid.voxels();
  for (Index t = 0; t < image.frames; ++t) {
    InpaintOptions frame_options = options;
    frame_options.scale_axes = false;
    frame_options.progress = of_frame(options.progress, t, image.frames);
    for (ImagePart<Scalar>& part : parts_of(image, t, missing.data() + (same_mask ? 0 : t * image.grid.voxels()))) {
      const Index unknown = part.missing_voxels();
      const Index known = part.frame.cols() - unknown;
      require(known > 0, inpaint_function, "known voxels", 0, "frame " + std::to_string(t + 1) + " has no known value");
      if (unknown > 0) {
        InpaintReport filled = fill(part, frame_options);
        if (report.missing == 0) {
          report.fit = std::move(filled.fit);
          report.plan = std::move(filled.plan);
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
