#include "csrbf/levelset/image/channel_contrast.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/decompositions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr Index enough = 1 << 18;  // voxels
constexpr int most_rounds = 20;    // by hand: classes stop changing after 3 to 8

// One column per voxel.
Eigen::MatrixXd samples_of(const Volume<float>& image, std::span<const std::uint8_t> mask) {
  const auto all = image.frame();
  const Index n = all.cols(), step = 1 + n / enough;
  Eigen::MatrixXd samples(all.rows(), n / step + 1);
  Index count = 0;
  for (Index i = 0; i < n; i += step)
    if ((mask.empty() || mask[i] != 0) && all.col(i).allFinite()) samples.col(count++) = all.col(i).cast<double>();
  samples.conservativeResize(Eigen::NoChange, count);
  return samples;
}

struct Classes {
  Eigen::VectorXd contrast;  // of their means
  double squares = std::numeric_limits<double>::infinity();
};

// The two classes of the projections of least variance: the threshold goes through the sorted ones.
Classes split(const Eigen::MatrixXd& samples, const Eigen::VectorXd& direction) {
  const Eigen::VectorXd f = samples.transpose() * direction;
  std::vector<std::pair<double, Index>> sorted;
  for (Index i = 0; i < f.size(); ++i) sorted.emplace_back(f[i], i);
  std::sort(sorted.begin(), sorted.end());
  const auto n = static_cast<double>(f.size());
  const double all = f.sum();
  double sum = 0, best = -1;
  std::size_t cut = 0;
  for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
    sum += sorted[i].first;
    if (sorted[i].first == sorted[i + 1].first) continue;
    const double below = static_cast<double>(i + 1);
    const double between = std::pow(sum * n - all * below, 2) / (below * (n - below));
    if (between > best) {
      best = between;
      cut = i + 1;
    }
  }
  if (cut == 0) return {direction};
  Eigen::VectorXd low = Eigen::VectorXd::Zero(samples.rows()), high = low;
  for (std::size_t i = 0; i < sorted.size(); ++i) (i < cut ? low : high) += samples.col(sorted[i].second);
  const auto below = static_cast<double>(cut);
  // What the means leave of the squares.
  const double left = samples.squaredNorm() - low.squaredNorm() / below - high.squaredNorm() / (n - below);
  return {high / (n - below) - low / below, left};
}

}  // namespace

Volume<float> root_channels(Volume<float> image, std::span<const std::uint8_t> mask) {
  const Index channels = image.components;
  float most = 0;
  for (Index i = 0; i < std::ssize(image.values); ++i) {
    if ((!mask.empty() && mask[i / channels] == 0) || !std::isfinite(image.values[i])) continue;
    if (image.values[i] < 0) return image;
    most = std::max(most, image.values[i]);
  }
  parallel_for(std::ssize(image.values), 1 << 14, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) image.values[i] = std::sqrt(most * std::max(0.0F, image.values[i]));
  });
  return image;
}

std::vector<double> channel_contrast(const Volume<float>& image, std::span<const std::uint8_t> mask) {
  const Index channels = image.components;
  Eigen::MatrixXd samples = samples_of(image, mask);
  Classes best{Eigen::VectorXd::Ones(channels)};
  if (samples.cols() >= 2) {
    samples.colwise() -= samples.rowwise().mean().eval();
    const Eigen::MatrixXd moments = samples * samples.transpose();
    const Eigen::MatrixXd axes = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(moments).eigenvectors();
    for (Index a = channels; a-- > 0;) {
      Classes now{axes.col(a)};
      for (int round = 0; round < most_rounds; ++round) {
        const double last = now.squares;
        now = split(samples, now.contrast);
        if (now.squares < best.squares) best = now;
        if (!(now.squares < last)) break;
      }
    }
  }
  if (best.contrast.norm() > 0) best.contrast.normalize();
  if (best.contrast.sum() < 0) best.contrast = -best.contrast;
  return {best.contrast.begin(), best.contrast.end()};
}

Volume<float> weigh_channels(const Volume<float>& image, const std::vector<double>& weights) {
  VolumeLayout layout = image;
  layout.components = 1;
  layout.type = SampleType::float32;
  Volume<float> result(layout);
  const Index channels = image.components;
  parallel_for(std::ssize(result.values), 1 << 14, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      double sum = 0;
      for (Index c = 0; c < channels; ++c) sum += weights[c] * static_cast<double>(image.values[i * channels + c]);
      result.values[i] = static_cast<float>(sum);
    }
  });
  return result;
}

}  // namespace csrbf
