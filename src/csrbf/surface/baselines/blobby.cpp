#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/core/small_matrices.hpp"
#include "csrbf/linalg/decompositions.hpp"
#include "csrbf/spatial/farthest_points.hpp"
#include "csrbf/surface/baselines/baselines.hpp"

#include <unsupported/Eigen/LevenbergMarquardt>

#include <numbers>
#include <numeric>

namespace csrbf::baselines {
namespace {

// Chosen by hand; Muraki (1991) gives the form of the energy.
constexpr Index default_blobs = 100;                           // time grows faster than their number
constexpr Index samples_per_blob = 12, fewest_samples = 1000;  // that the blobs are fitted to
constexpr double normal_weight = 0.02;          // of the squared errors of the normals relative to those of the values
constexpr double default_volume_weight = 1e-5;  // of the squared volume of the blobs, which keeps them from growing
constexpr double target_energy = 1e-5;          // below, no further blob is split
constexpr double least_value = 4e-4;            // of a blob, 1 being the threshold: samples with less are ignored
constexpr double split_offset = 1;              // of the halves of a blob, in standard deviations of its samples
constexpr Index active_blobs = 5;               // optimised at a time; more: slower steps, better minima
constexpr int most_evaluations = 20;            // of the energy in one optimisation
constexpr double sweep_growth = 1.4;            // of the number of blobs between two sweeps over all of them
constexpr Index parameters = 5;                 // of a blob: centre, log a, log b

// b exp(-a |x - center|^2).
struct Blob {
  Point<3> center = Point<3>::Zero();
  double a = 1, b = 1;

  [[nodiscard]] double volume() const { return b * std::pow(a, -1.5); }
  [[nodiscard]] double value(const Point<3>& x) const { return b * std::exp(-a * (x - center).squaredNorm()); }
};

Eigen::Vector<double, parameters> pack(const Blob& blob) {
  Eigen::Vector<double, parameters> x;
  x << blob.center, std::log(blob.a), std::log(blob.b);
  return x;
}

Blob unpack(const Eigen::Ref<const Eigen::VectorXd>& x) {
  return {x.head<3>(), std::exp(x[3]), std::exp(x[4])};
}

// Value, then gradient. The columns of J, if requested, are their derivatives with respect to the parameters.
Eigen::Vector4d evaluate(const Blob& blob, const Point<3>& x, Eigen::Matrix<double, 4, parameters>* J = nullptr) {
  const Point<3> d = x - blob.center;
  const double r2 = d.squaredNorm(), B = blob.value(x);
  Eigen::Vector4d f;
  f << B, -2 * blob.a * B * d;
  if (J == nullptr) return f;
  J->block<1, 3>(0, 0) = -f.tail<3>().transpose();
  J->block<3, 3>(1, 0) = 2 * blob.a * B * (Eigen::Matrix3d::Identity() - 2 * blob.a * d * d.transpose());
  J->col(3) << -blob.a * r2 * B, -2 * blob.a * B * (1 - blob.a * r2) * d;
  J->col(4) = f;
  return f;
}

double length(const Eigen::Vector4d& f) {
  return std::max(f.tail<3>().norm(), std::numeric_limits<double>::min());
}

// The errors of value and normal at a sample with normal n, where the sum has the value and gradient f.
Eigen::Vector4d errors_of(const Eigen::Vector4d& f, const Point<3>& n) {
  Eigen::Vector4d e;
  e << f[0], std::sqrt(normal_weight) * (n + f.tail<3>() / length(f));
  return e;
}

struct BlobSamples {
  Points<3> points, normals;

  [[nodiscard]] BlobSamples part(const std::vector<Index>& ids) const {
    return {points(Eigen::all, ids), normals(Eigen::all, ids)};
  }
};

// The energy as a sum of squares, for the solver: errors at some samples and the total volume, as functions of the
// parameters of some blobs. The contributions of the others are constant.
struct Errors : Eigen::DenseFunctor<double> {
  BlobSamples samples;
  Eigen::Matrix4Xd rest;
  double rest_volume;
  double volume_weight;

  Errors(BlobSamples s, Eigen::Matrix4Xd other, double other_volume, double weight, std::size_t blobs)
      : DenseFunctor<double>(static_cast<int>(parameters) * static_cast<int>(blobs),
                             4 * static_cast<int>(s.points.cols()) + 1),
        samples(std::move(s)),
        rest(std::move(other)),
        rest_volume(other_volume),
        volume_weight(weight) {}

  [[nodiscard]] std::vector<Blob> blobs_of(const InputType& x) const {
    std::vector<Blob> blobs;
    for (Index k = 0; k < x.size(); k += parameters) blobs.push_back(unpack(x.segment(k, parameters)));
    return blobs;
  }

  int operator()(const InputType& x, ValueType& errors) const {
    const std::vector<Blob> blobs = blobs_of(x);
    for (Index i = 0; i < rest.cols(); ++i) {
      Eigen::Vector4d f = rest.col(i);
      for (const Blob& blob : blobs) f += evaluate(blob, samples.points.col(i));
      errors.segment<4>(4 * i) = errors_of(f, samples.normals.col(i));
    }
    double volume = rest_volume;
    for (const Blob& blob : blobs) volume += blob.volume();
    errors[4 * rest.cols()] = volume_weight * volume;
    return 0;
  }

  int df(const InputType& x, JacobianType& J) const {
    const std::vector<Blob> blobs = blobs_of(x);
    Eigen::Matrix<double, 4, Eigen::Dynamic> D(4, inputs());
    Eigen::Matrix<double, 4, parameters> part;
    for (Index i = 0; i < rest.cols(); ++i) {
      Eigen::Vector4d f = rest.col(i);
      for (std::size_t k = 0; k < blobs.size(); ++k) {
        f += evaluate(blobs[k], samples.points.col(i), &part);
        D.middleCols<parameters>(static_cast<Index>(k) * parameters) = part;
      }
      const Point<3> direction = f.tail<3>() / length(f);
      const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - direction * direction.transpose();
      J.row(4 * i) = D.row(0);
      J.middleRows<3>(4 * i + 1) = std::sqrt(normal_weight) / length(f) * across * D.bottomRows<3>();
    }
    auto last = J.row(4 * rest.cols());
    last.setZero();
    for (std::size_t k = 0; k < blobs.size(); ++k) {
      last[static_cast<Index>(k) * parameters + 3] = -1.5 * volume_weight * blobs[k].volume();
      last[static_cast<Index>(k) * parameters + 4] = volume_weight * blobs[k].volume();
    }
    return 0;
  }
};

// The blobs, and the value and gradient of their sum minus the threshold at the samples.
class BlobFitter {
 public:
  // One blob at the centroid of the samples.
  BlobFitter(BlobSamples samples, double volume_weight) : samples_(std::move(samples)), volume_weight_(volume_weight) {
    Blob first;
    first.center = samples_.points.rowwise().mean();
    first.a = static_cast<double>(count()) / (samples_.points.colwise() - first.center).squaredNorm();
    first.b = std::numbers::e;  // so that a^(-1/2) is its radius
    sums_.setZero(4, count());
    sums_.row(0).setConstant(-1);
    blobs_.push_back(first);
    add(first, 1);
    improve({0});
  }

  [[nodiscard]] const std::vector<Blob>& blobs() const { return blobs_; }

  [[nodiscard]] double energy() const {
    double sum = 0;
    for (Index i = 0; i < count(); ++i) sum += errors_of(sums_.col(i), samples_.normals.col(i)).squaredNorm();
    return sum / static_cast<double>(count()) + volume_weight_ * std::pow(volume(), 2);
  }

  // Splits the blob whose samples (those where it is the largest) have the largest sum of errors, along their longest
  // axis.
  void split() {
    const std::vector<Index> own = worst_samples();
    Points<3> around = samples_.points(Eigen::all, own);
    around.colwise() -= Point<3>(around.rowwise().mean());
    const Eigen::Matrix3d covariance = around * around.transpose() / static_cast<double>(own.size());
    const SymmetricEigen axes = symmetric_eigen(covariance);
    const Point<3> step = split_offset * std::sqrt(std::max(0.0, axes.values[2])) * axes.vectors.col(2);
    const Index worst = owner(own.front());
    Blob half = blobs_[worst];
    half.b /= 2;
    Blob other = half;
    half.center += step;
    other.center -= step;
    replace(worst, half);
    blobs_.push_back(other);
    add(other, 1);
    improve(nearest(worst));
  }

  // Optimises every blob together with those nearest to it.
  void sweep() {
    for (Index k = 0; k < static_cast<Index>(blobs_.size()); ++k) improve(nearest(k));
  }

 private:
  [[nodiscard]] Index count() const { return samples_.points.cols(); }

  void add(const Blob& blob, double sign) {
    for (Index i = 0; i < count(); ++i) sums_.col(i) += sign * evaluate(blob, samples_.points.col(i));
  }

  void replace(Index k, const Blob& by) {
    Blob& blob = blobs_[k];
    add(blob, -1);
    blob = by;
    add(blob, 1);
  }

  [[nodiscard]] double volume() const {
    return std::accumulate(blobs_.begin(), blobs_.end(), 0.0, [](double v, const Blob& b) { return v + b.volume(); });
  }

  // The blob with the largest value at a sample.
  [[nodiscard]] Index owner(Index i) const {
    const auto most = std::max_element(blobs_.begin(), blobs_.end(), [&](const Blob& p, const Blob& q) {
      return p.value(samples_.points.col(i)) < q.value(samples_.points.col(i));
    });
    return most - blobs_.begin();
  }

  // The samples of the blob whose errors are largest.
  [[nodiscard]] std::vector<Index> worst_samples() const {
    std::vector<std::vector<Index>> own(blobs_.size());
    Eigen::VectorXd error = Eigen::VectorXd::Zero(static_cast<Index>(blobs_.size()));
    for (Index i = 0; i < count(); ++i) {
      const Index k = owner(i);
      own[k].push_back(i);
      error[k] += errors_of(sums_.col(i), samples_.normals.col(i)).squaredNorm();
    }
    Index worst = 0;
    error.maxCoeff(&worst);
    return own[worst];
  }

  [[nodiscard]] std::vector<Index> nearest(Index k) const {
    std::vector<Index> near(blobs_.size());
    std::iota(near.begin(), near.end(), Index{0});
    const Point<3> at = blobs_[k].center;
    const auto distance = [&](Index j) { return (blobs_[j].center - at).squaredNorm(); };
    std::sort(near.begin(), near.end(), [&](Index i, Index j) { return distance(i) < distance(j); });
    near.resize(std::min<std::size_t>(active_blobs, near.size()));
    return near;
  }

  // Minimises the energy over the parameters of some blobs at the samples that they reach; reverted if the total energy
  // has not fallen.
  void improve(const std::vector<Index>& active) {
    std::vector<Index> ids;
    for (Index i = 0; i < count(); ++i)
      if (std::any_of(active.begin(), active.end(),
                      [&](Index k) { return blobs_[k].value(samples_.points.col(i)) > least_value; }))
        ids.push_back(i);
    const double before = energy();
    const std::vector<Blob> old_blobs = blobs_;
    const Eigen::Matrix4Xd old_sums = sums_;
    Eigen::VectorXd x(parameters * static_cast<Index>(active.size()));
    for (std::size_t k = 0; k < active.size(); ++k) {
      Blob& blob = blobs_[active[k]];
      x.segment<parameters>(static_cast<Index>(k) * parameters) = pack(blob);
      add(blob, -1);
      blob.b = 0;
    }
    Errors errors(samples_.part(ids), sums_(Eigen::all, ids), volume(),
                  std::sqrt(volume_weight_ * static_cast<double>(count())), active.size());
    Eigen::LevenbergMarquardt<Errors> solver(errors);
    solver.setMaxfev(most_evaluations);
    solver.minimize(x);
    for (std::size_t k = 0; k < active.size(); ++k)
      replace(active[k], unpack(x.segment<parameters>(static_cast<Index>(k) * parameters)));
    if (energy() <= before) return;
    blobs_ = old_blobs;
    sums_ = old_sums;
  }

  BlobSamples samples_;
  double volume_weight_;
  std::vector<Blob> blobs_;
  Eigen::Matrix4Xd sums_;
};

MethodFit finish(const std::vector<Blob>& blobs, const Box<3>& bounds, double smoothing) {
  const auto M = static_cast<Index>(blobs.size());
  Points<3> centers(3, M);
  Eigen::VectorXd lengths(M), coefficients(M);
  for (Index k = 0; k < M; ++k) {
    const Blob& blob = blobs[k];
    centers.col(k) = blob.center;
    lengths[k] = 1 / std::sqrt(blob.a);
    coefficients[k] = blob.b;
  }
  const auto basis = std::make_shared<const RadialBasis<3>>(Kernel("gaussian", 3), centers, lengths);
  const PolynomialTail<3> threshold{0, Point<3>::Zero(), 1, Eigen::VectorXd::Constant(1, -1.0)};
  return {std::make_shared<const Expansion<3>>(basis, coefficients, threshold, bounds), M, smoothing};
}

}  // namespace

MethodFit blobby(const PreparedCloud& cloud, const MethodOptions& options) {
  const Index budget = options.centers > 0 ? options.centers : default_blobs;
  const Index count = std::min(cloud.cloud.size(), std::max(fewest_samples, samples_per_blob * budget));
  const std::vector<Index> kept = farthest_points<3>(cloud.cloud.points, count).indices;
  const double smoothing = options.smoothing.value_or(default_volume_weight);
  BlobFitter fitter({cloud.cloud.points(Eigen::all, kept), cloud.cloud.normals(Eigen::all, kept)}, smoothing);
  double next_sweep = sweep_growth;
  for (Index size = 2; size <= budget && fitter.energy() > target_energy; ++size) {
    report(options.progress, "fit", static_cast<double>(size) / static_cast<double>(budget));
    fitter.split();
    if (static_cast<double>(size) < next_sweep && size < budget) continue;
    fitter.sweep();
    next_sweep = sweep_growth * static_cast<double>(size);
  }
  return finish(fitter.blobs(), bounding_box<3>(cloud.cloud.points), smoothing);
}

}  // namespace csrbf::baselines
