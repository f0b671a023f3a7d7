#include "csrbf/approx/moving/along_tracks.hpp"

#include "csrbf/approx/unity/local_variance.hpp"

#include <algorithm>
#include <limits>

namespace csrbf {
namespace {

constexpr Index fewest = 24;      // held-out samples that tell the size of errors; chosen by hand
constexpr double largest = 1e12;  // ratio of variances: the errors of patches may be 0

template <int Dim>
HeldOutSamples<Dim> hold_out(const Samples<Dim>& samples) {
  return HeldOutSamples<Dim>(samples.weights.size() > 0 ? normalize_weights(samples) : samples);
}

// Errors at held-out samples, in a common unit.
template <int Dim>
struct HeldOutErrors {
  Points<Dim> points;
  Eigen::MatrixXd patches, tracks;  // samples x components
  double unit = 1;

  HeldOutErrors(const Samples<Dim>& samples, const LocalOptions& options) {
    const HeldOutSamples<Dim> held_out = hold_out(samples);
    points = held_out.held_out().points;
    if (points.cols() < fewest) return;
    patches = held_out.errors(options);
    tracks = held_out.errors(moving_least_squares(held_out.others(), along_tracks));
    unit = std::max(patches.cwiseAbs().maxCoeff(), tracks.cwiseAbs().maxCoeff());
    if (!(unit > 0)) unit = 1;
    patches /= unit;
    tracks /= unit;
  }

  [[nodiscard]] bool empty() const { return patches.size() == 0; }

  // Local mean squares of every second error at the points of the others.
  [[nodiscard]] Eigen::ArrayXXd squares_of_others(const Eigen::MatrixXd& errors) const {
    Eigen::ArrayXXd result(errors.rows(), errors.cols());
    for (Index first : {0, 1}) {
      const auto from = Eigen::seq(first, Eigen::last, 2), to = Eigen::seq(1 - first, Eigen::last, 2);
      const Points<Dim> at = points(Eigen::all, to);
      const auto fields = local_means<Dim>(points(Eigen::all, from), errors(from, Eigen::all).cwiseAbs2().transpose());
      for (Index c = 0; c < errors.cols(); ++c)
        result(to, c) = fields[static_cast<std::size_t>(c)]->evaluate(at).value.array();
    }
    return result;
  }

  // Local mean squares at the points.
  [[nodiscard]] Eigen::ArrayXXd squares(const Eigen::MatrixXd& errors) const {
    const auto fields = local_means<Dim>(points, errors.cwiseAbs2().transpose());
    Eigen::ArrayXXd result(errors.rows(), errors.cols());
    for (Index c = 0; c < errors.cols(); ++c)
      result.col(c) = fields[static_cast<std::size_t>(c)]->evaluate(points).value.array();
    return result;
  }

  // Local mean squares over those of the patches, half of their logarithm: so few errors with long tails tell no more.
  [[nodiscard]] std::vector<std::shared_ptr<const Field<Dim>>> ratios(const Eigen::MatrixXd& errors) const {
    const Eigen::ArrayXXd v = squares(patches),
                          ratio = (v > 0).select(squares(errors) / v, largest).min(largest).sqrt();
    return local_means<Dim>(points, ratio.transpose());
  }
};

}  // namespace

template <int Dim>
std::optional<TrackShare<Dim>> better_along_tracks(const Samples<Dim>& samples, const LocalOptions& patches) {
  constexpr double clearly_better = 0.97;  // ratio of root mean square errors; chosen by hand
  const HeldOutErrors<Dim> errors(samples, patches);
  if (errors.empty()) return std::nullopt;
  const auto share = [](const Eigen::ArrayXXd& v, const Eigen::ArrayXXd& w) -> Eigen::MatrixXd {
    return (v > 0).select(v.square() / (v.square() + w.square()), 0);
  };
  const auto blend = [&](const Eigen::MatrixXd& s) -> Eigen::MatrixXd {
    return errors.patches + s.cwiseProduct(errors.tracks - errors.patches);
  };
  // Judged with shares that do not know the error.
  const Eigen::MatrixXd both =
      blend(share(errors.squares_of_others(errors.patches), errors.squares_of_others(errors.tracks)));
  const Eigen::MatrixXd shares = share(errors.squares(errors.patches), errors.squares(errors.tracks));
  const HeldOutError before(errors.patches), after(both);
  if (!(after.rmse < clearly_better * before.rmse && after.mean < before.mean)) return std::nullopt;
  return TrackShare<Dim>{local_means<Dim>(errors.points, shares.transpose()), errors.ratios(both),
                         errors.unit * after.rmse};
}

template <int Dim>
double held_out_along_tracks(const Samples<Dim>& samples, const MovingLeastSquaresOptions& options) {
  const HeldOutSamples<Dim> held_out = hold_out(samples);
  if (held_out.held_out().size() < fewest) return std::numeric_limits<double>::quiet_NaN();
  return HeldOutError(held_out.errors(moving_least_squares(held_out.others(), options))).rmse;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                \
  template std::optional<TrackShare<Dim>> better_along_tracks<Dim>(const Samples<Dim>&, const LocalOptions&); \
  template double held_out_along_tracks<Dim>(const Samples<Dim>&, const MovingLeastSquaresOptions&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
