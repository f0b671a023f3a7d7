#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/grid.hpp"

#include <cstdint>
#include <vector>

namespace csrbf::thesis {

/// An image that was made from known regions. Voxels have size 1, the first is centred at the origin.
struct Phantom {
  Volume<float> image;
  std::vector<std::uint8_t> truth;  ///< 1 in the object
};

/// 311 x 311 pixels: a body with lobes and two holes, 210 on 40, with edges blurred by 3 pixels (Figs. 7.1, 8.2).
Phantom holed_shape();

/// 446 x 446 pixels: a star of eleven rays, 210 on 40, with edges blurred by 1 pixel (Fig. 8.6).
Phantom star();

/// 249 x 249 pixels of log-compressed speckle; the object are two cavities (dark, as blood is).
Phantom speckled_cavities(unsigned seed);

/// The same in the form of Fig. 8.10: 40 lines of 249 samples along the beam, a cavity between a thin wall and a thick
/// one, and a dark region behind it.
Phantom speckled_wall(unsigned seed);

/// n^3 voxels with struts like those of trabecular bone, 210 on 40, blurred by 1 voxel: inside where `Trabeculae` is.
Phantom bone(Index n);

/// f = -(sin x cos y + sin y cos z + sin z cos x) - .35 in periods of n / 3 voxels: a gyroid with two derivatives.
class Trabeculae final : public Field<3> {
 public:
  explicit Trabeculae(Index n);
  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<3> bounds() const override;

 private:
  Index n_;
  double frequency_;
};

/// Adds white Gaussian noise of a variance such that 10 log10(variance of the image / variance of the noise) = snr.
void add_white_noise(Volume<float>& image, double snr, unsigned seed);

}  // namespace csrbf::thesis
