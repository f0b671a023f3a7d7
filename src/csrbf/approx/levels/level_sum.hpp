#pragma once

#include "csrbf/approx/basis/expansion.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// A sum of expansions: each level corrects those before it (thesis eq. 2.19).
template <int Dim>
class LevelSum : public Field<Dim> {
 public:
  explicit LevelSum(std::vector<std::shared_ptr<const Expansion<Dim>>> levels, const Box<Dim>& bounds = {})
      : levels_(std::move(levels)), bounds_(bounds) {
    if (!bounds_.empty()) return;
    for (const auto& level : levels_) bounds_.add(level->bounds());
  }

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return bounds_; }
  /// The smallest support of all levels.
  [[nodiscard]] double feature_size() const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override;

  /// The sum of those of the levels.
  [[nodiscard]] std::optional<Enclosure> enclose(const Box<Dim>& box) const override;

  [[nodiscard]] const std::vector<std::shared_ptr<const Expansion<Dim>>>& levels() const { return levels_; }

 private:
  std::vector<std::shared_ptr<const Expansion<Dim>>> levels_;
  Box<Dim> bounds_;
};

/// What one level did. Errors are those of the sum of all levels so far, at the samples (merged duplicates count once).
struct LevelReport {
  Index centers = 0;  ///< those whose coefficients are 0 are not kept in the model
  double smallest_support = 0;
  double largest_support = 0;
  double lambda0 = 0;    ///< regularisation; 0: interpolation
  double rmse = 0;       ///< weighted root mean square over samples and components
  double max_error = 0;  ///< largest error of a component at any sample
};

/// A model and a report of its levels.
template <int Dim>
struct LevelFit {
  std::vector<std::shared_ptr<const LevelSum<Dim>>> fields;  ///< one per component
  std::vector<LevelReport> levels;
  Index merged_duplicates = 0;
  bool converged = true;  ///< whether the tolerance, if one was given, holds at every sample

  [[nodiscard]] const LevelReport& last() const { return levels.back(); }
  /// One field per component.
  [[nodiscard]] std::vector<std::shared_ptr<const Field<Dim>>> model() const { return {fields.begin(), fields.end()}; }
};

}  // namespace csrbf
