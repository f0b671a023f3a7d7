#pragma once

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/levels/level_fit.hpp"

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

}  // namespace csrbf
