#pragma once

#include "csrbf/core/error.hpp"
#include "csrbf/levelset/regions/force_source.hpp"
#include "csrbf/levelset/segment_options.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace csrbf {

/// The force of the caller, which depends on the labels of the last fit().
class CallerForces final : public ForceSource {
 public:
  explicit CallerForces(const SegmentOptions& options) : ForceSource(2, options.prior), options_(options) {}

  void fit(std::span<const std::uint8_t> labels) override {
    saved_ = std::exchange(labels_, {labels.begin(), labels.end()});
  }
  void undo() override { labels_ = saved_; }
  double force(int /*k*/, double scale, std::span<float> force) const override {
    options_.force(labels_.data(), force.data());
    double outside = 0;  // the smaller cost of each voxel is 0
    for (std::size_t i = 0; i < force.size(); ++i) {
      require(std::isfinite(force[i]), "segment", "force", force[i], "the function must write finite numbers");
      force[i] = options_.mask.empty() || options_.mask[i] != 0 ? static_cast<float>(force[i] / scale) : 0.0F;
      outside += std::max(0.0, -static_cast<double>(force[i]) * scale);
    }
    return outside;
  }

 private:
  const SegmentOptions& options_;
  std::vector<std::uint8_t> labels_, saved_;
};

}  // namespace csrbf
