#pragma once

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/surface/normals/neighbor_table.hpp"

namespace csrbf {

/// What correct_normals() found and did.
struct NormalCorrection {
  double error = 0;        ///< median error, in radians, of the normals that were corrected; 0 if none were
  Index corrected = 0;     ///< normals that were replaced by better estimates
  Index turned = 0;        ///< normals that pointed against all their neighbours, or most where normals have errors
  bool some_left = false;  ///< some have errors, but were left to the fit
};

/// Treats given normals as data with an error of their own, which is measured where they are: independent errors make
/// the normals of neighbours differ, and differ from the normals that the positions have there, while curvature turns
/// both alike and creases leave most neighbours alike. Per run of some hundred samples in Morton order, the lower
/// quartile of these differences gives the standard deviation of the given normals, s, to 10 % if they are Gaussian,
/// and the rest of their distance from the normals of the positions that of the latter, t. Where few samples make
/// curvature look like errors, s is at most what the chords to the nearest neighbours show: exact normals are
/// perpendicular to them in the mean of both ends. Normals with s below 5 degrees (9 where most others are exact), or
/// well below t, stay as they are, to the last bit; and so do those with s below 20 degrees (40 where most others are)
/// whose positions have noise that makes slopes of .8 s or more, for the fit averages independent errors over
/// patches as wide as that noise asks for, better than corrected ones, which are alike nearby. The others become n +
/// (mean of the given ones relative to n) weighted by precision, where n is the normal of the positions; or, where that
/// is farther from the given one than s and t explain, as on creases, the mean of those neighbours that agree with it.
///
/// Fewer than 128 samples stay as they are. A normal that points against its neighbours is turned; where normals have
/// errors, against most of them. Points in Morton order, unit normals. O(n) where all normals agree, else the cost
/// of estimate_normals() for the runs in question.
NormalCorrection correct_normals(const Points<3>& points, const KdTree<3>& tree, const NeighborTable& near,
                                 Points<3>& normals);

}  // namespace csrbf
