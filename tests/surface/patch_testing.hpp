#pragma once

#include "csrbf/surface/composite/patch_fitter.hpp"
#include "surface/surface_testing.hpp"

// Patches fitted alone.
namespace csrbf {

// The local model at a point inside its support: the weight of a single patch divides out.
inline double value(const FittedPatch& fitted, const Point<3>& x) {
  Patches patches;
  for (const FittedPiece& piece : fitted.pieces) patches.add(piece.patch, piece.centers, piece.alpha);
  patches.build();
  PatchSums sums;
  patches.accumulate(x, Derivatives::none, sums);
  EXPECT_GT(sums.W[0][0], 0);
  return sums.S[0][0] / sums.W[0][0];
}

inline std::vector<Index> nearest(const KdTree<3>& tree, const Point<3>& x, Index k) {
  std::vector<Index> ids(k);
  std::vector<double> d2(ids.size());
  ids.resize(tree.nearest(x, k, ids.data(), d2.data()));
  return ids;
}

inline FittedPatch fit_around(const OrientedPoints& cloud, const Point<3>& x, const CompositeOptions& options) {
  const KdTree<3> tree(cloud.points);
  PatchFitter fitter(cloud, tree, options);
  const std::vector<Index> ids = nearest(tree, x, options.leaf_size);
  return fitter.fit(ids.data(), static_cast<Index>(ids.size()));
}

inline CompositeOptions quadric_only(Index leaf_size) {
  CompositeOptions options;
  options.leaf_size = leaf_size;
  options.centers_per_patch = 0;
  return options;
}

}  // namespace csrbf
