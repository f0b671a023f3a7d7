#pragma once

#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/linalg/decompositions.hpp"

namespace csrbf {

template <int Dim>
inline constexpr double unit_ball_volume = Dim == 1   ? 2
                                           : Dim == 2 ? 3.14159265358979
                                                      : 4.18879020478639;

/// What errors the local functions of a partition of unity are expected to have away from their samples: in one to
/// three dimensions.
template <int Dim>
class PatchErrors {
 public:
  /// `fit` must outlive it.
  explicit PatchErrors(const PartitionOfUnityFit<Dim>& fit);

  /// A cell of the partition of unity, and its local function.
  struct Patch {
    Index cell = 0;
    Point<Dim> center;
    double radius = 0;
    Eigen::VectorXd error;              ///< mean square, by component
    Points<Dim> q;                      ///< its samples in its coordinates
    Eigen::MatrixXd rows;               ///< of the monomials at them
    Eigen::LDLT<Eigen::MatrixXd> gram;  ///< of their columns
    Eigen::LDLT<Eigen::MatrixXd> radial;
    typename Cover<Dim>::Search search;
  };
  /// Where a patch is, whose mean square leave-one-out error is `error`.
  void enter(Index cell, const Eigen::VectorXd& error, Patch& patch) const;
  /// How it magnifies errors of its samples, for error(): O(n^3) for n samples.
  void prepare(Patch& patch) const;

  /// The least that error() may be: as the distance of samples grows. Of a patch that need not be prepared.
  [[nodiscard]] Eigen::VectorXd least_error(double distance, double spacing, const Patch& patch) const;

  /// The mean square error that the local function may have at x, by its own account: of degree p, it grows like the
  /// distance of samples to the power p + 1, and as errors of the samples are magnified. `distance`: of the nearest
  /// sample; `spacing`: of the samples about x.
  [[nodiscard]] Eigen::VectorXd error(const Point<Dim>& x, double distance, double spacing, const Patch& patch) const;

  /// Distance of x to the nearest sample; `reach`: an estimate of it.
  [[nodiscard]] double nearest(const Point<Dim>& x, double reach, typename Cover<Dim>::Search& search) const;
  /// Radius of a ball that holds n of the samples found about its middle, all of which are at usual distances. In one
  /// dimension these are told from gaps between them; in more, a ball hardly ever holds a gap and many samples.
  [[nodiscard]] double usual_reach(Index n, const typename Cover<Dim>::Search& search) const;
  /// Distance of samples about x, as in a patch.
  [[nodiscard]] double spacing_at(const Point<Dim>& x, Patch& patch) const;

  [[nodiscard]] Index unknowns() const { return unknowns_; }  ///< of a local function
  [[nodiscard]] bool interpolates() const { return interpolates_; }
  /// Samples, or unknowns, in an empty ball that is a gap if they were evenly spread.
  [[nodiscard]] double expected() const;
  /// Radius of an empty ball that is a gap, in radii of a patch: 1 and more for those of a few samples.
  [[nodiscard]] double gap() const { return gap_; }
  [[nodiscard]] double spacing() const { return spacing_; }  ///< of samples, or of unknowns, in the same unit

 private:
  [[nodiscard]] double growth(double distance, double spacing, const Patch& patch) const;
  [[nodiscard]] Eigen::VectorXd radial(const Point<Dim>& q, const Patch& patch) const;
  [[nodiscard]] double magnified(const Point<Dim>& q, const Patch& patch) const;

  const PartitionOfUnityFit<Dim>& fit_;
  const Cover<Dim>& cover_;
  Polynomials<Dim> basis_;
  Index samples_, unknowns_;
  bool interpolates_;  // with radial functions at all samples of a patch
  double gap_, spacing_;
};

}  // namespace csrbf
