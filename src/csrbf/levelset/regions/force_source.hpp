#pragma once

#include <cstdint>
#include <span>

namespace csrbf {

/// What each voxel costs in one region instead of the others, from statistics that follow the labels.
class ForceSource {
 public:
  /// `prior` as in SegmentOptions; it must outlive this.
  explicit ForceSource(int regions, std::span<const float> prior = {}) : regions_(regions), prior_(prior) {}
  ForceSource(const ForceSource&) = delete;
  ForceSource& operator=(const ForceSource&) = delete;
  virtual ~ForceSource() = default;

  [[nodiscard]] int regions() const { return regions_; }

  /// Saves the statistics and estimates those of the regions with these labels.
  virtual void fit(std::span<const std::uint8_t> labels) = 0;

  /// Restores the statistics that the last fit() saved.
  virtual void undo() = 0;

  /// Writes (cost of region k - least cost of the others) / scale for each voxel; 0 outside the mask. Returns the sum
  /// of the least costs of the others, not divided by the scale.
  virtual double force(int k, double scale, std::span<float> force) const = 0;

  /// force() and the prior, whose unit is the scale; returns the sum over `scale`.
  double force_with_prior(int k, double scale, std::span<float> to) const {
    const double others = force(k, scale, to) / scale;
    for (std::size_t i = 0; i < prior_.size(); ++i) to[i] += prior_[i];
    return others;
  }

 private:
  int regions_;
  std::span<const float> prior_;
};

}  // namespace csrbf
