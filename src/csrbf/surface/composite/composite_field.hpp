#pragma once

#include "csrbf/surface/composite/patches.hpp"
#include "csrbf/surface/winding/winding_number.hpp"

namespace csrbf {

/// The composite implicit surface: close to a signed distance near the data, with the right sign everywhere.
///
/// Fine patches decide near the data. Where they do not reach, contradict each other, or contradict a winding number
/// that is certain (far from their own samples, where they only extrapolate), the nearest of them and then coarser
/// patches take over and close holes smoothly, but only where the winding number of the samples is undecided; elsewhere
/// the winding number itself gives the sign. Of open surfaces, whose winding number w is not 1/2 on the surface, it is
/// the difference from what it is there that counts (winding_level), as in Poisson reconstruction: so they are
/// continued. All transitions are C2, so value, gradient and Hessian are continuous.
class CompositeField final : public Field<3> {
 public:
  /// Works in unit coordinates y = (x - origin) / scale.
  struct Data {
    Point<3> origin = Point<3>::Zero();
    double scale = 1;
    std::vector<Patches> levels;  ///< finest first
    WindingNumber winding;
    double winding_level = 0;  ///< u = 2w - 1 on the surface: 0 where it is closed, -1 on a sheet without inside
    double far_value = 0;      ///< |f| far from the data, unit coordinates: far_spacings times the mean of the
                               ///< spacing over the surface
    double feature_size = 0;   ///< size of the smallest features, unit coordinates
    bool noisy = false;        ///< whether the samples are beside the surface, not on it
    Box<3> bounds;             ///< of the data, in the user's coordinates
  };

  /// About where the patches end. Chosen by hand.
  static constexpr double far_spacings = 3;

  explicit CompositeField(Data data) : data_(std::move(data)) {}

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<3> bounds() const override { return data_.bounds; }
  [[nodiscard]] double feature_size() const override { return data_.scale * data_.feature_size; }
  [[nodiscard]] double least_persistence() const override;
  /// Centres of the finest patches.
  [[nodiscard]] Points<3> seeds() const override;

  [[nodiscard]] const Data& data() const { return data_; }
  void set_noisy(bool noisy) { data_.noisy = noisy; }

 private:
  Data data_;
};

}  // namespace csrbf
