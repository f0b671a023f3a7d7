#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"
#include "csrbf/levelset/lattice/lattice.hpp"

#include <memory>
#include <vector>

namespace csrbf {

/// Mean of |grad f| over the voxels at the contour; 0 without a contour.
template <int Dim>
double contour_slope(const Lattice<Dim>& lattice, const std::vector<float>& coefficients);

/// f / slope for the level set f of a lattice, in physical coordinates; slope > 0, as of contour_slope(), makes it
/// about the signed distance at its contour.
template <int Dim>
std::shared_ptr<const Field<Dim>> lattice_field(const Lattice<Dim>& lattice, const std::vector<float>& coefficients,
                                                const Grid& grid, double slope);

/// f_k - max of the others: positive where field k is the largest. Has the derivatives of the two that count.
template <int Dim>
class LargestField final : public Field<Dim> {
 public:
  using Fields = std::vector<std::shared_ptr<const Field<Dim>>>;

  /// At least two fields; k is the number of one of them.
  LargestField(Fields fields, std::size_t k) : fields_(std::move(fields)), k_(k) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return fields_[k_]->bounds(); }
  [[nodiscard]] double feature_size() const override { return fields_[k_]->feature_size(); }
  [[nodiscard]] const Fields& fields() const { return fields_; }
  [[nodiscard]] std::size_t number() const { return k_; }

 private:
  Fields fields_;
  std::size_t k_;
};

/// The level sets of a segmentation, about the signed distances at their contours: that of one set of coefficients, or
/// of several those that say by how much each is the largest.
template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> level_set_fields(const Lattice<Dim>& lattice,
                                                                const std::vector<std::vector<float>>& coefficients,
                                                                const Grid& grid);

}  // namespace csrbf
