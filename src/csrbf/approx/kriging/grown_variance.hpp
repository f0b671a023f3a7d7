#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <memory>
#include <mutex>
#include <utility>

namespace csrbf {

/// Where samples are, and how far the nearest one is: by a tree that is built at the first question. Thread safe.
template <int Dim>
class SamplePlaces {
 public:
  /// In an order in which neighbours are close to each other the tree is fastest.
  explicit SamplePlaces(Points<Dim> points) : points_(std::move(points)) {}

  [[nodiscard]] const Points<Dim>& points() const { return points_; }
  [[nodiscard]] double distance(const Point<Dim>& x) const;

 private:
  Points<Dim> points_;
  mutable std::once_flag once_;
  mutable std::unique_ptr<const KdTree<Dim>> tree_;
};

/// By how much a variance grows with the distance to the nearest sample: as a power of it, from where it is usual.
struct GrowthWithDistance {
  double amount = 1, exponent = 0;

  /// At a distance in distances of samples: amount distance^exponent, at least 1; 1 close to samples, with a smooth
  /// step between.
  [[nodiscard]] double factor(double distance) const;
};

/// A variance times a factor that grows with the distance to the nearest sample over the distance of samples there, a
/// field too. O(log n) a point besides the fields. Derivatives are not provided: they are NaN.
template <int Dim>
class GrownVariance : public Field<Dim> {
 public:
  using Part = std::shared_ptr<const Field<Dim>>;
  GrownVariance(Part variance, Part spacing, std::shared_ptr<const SamplePlaces<Dim>> places, GrowthWithDistance growth)
      : variance_(std::move(variance)), spacing_(std::move(spacing)), places_(std::move(places)), growth_(growth) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<Dim>& x) const override {
    return spacing_->evaluation_order(x);
  }
  [[nodiscard]] Box<Dim> bounds() const override { return variance_->bounds(); }

  [[nodiscard]] const Field<Dim>& variance() const { return *variance_; }
  [[nodiscard]] const Field<Dim>& spacing() const { return *spacing_; }
  [[nodiscard]] const SamplePlaces<Dim>& places() const { return *places_; }
  [[nodiscard]] GrowthWithDistance growth() const { return growth_; }

 private:
  Part variance_, spacing_;
  std::shared_ptr<const SamplePlaces<Dim>> places_;
  GrowthWithDistance growth_;
};

}  // namespace csrbf
