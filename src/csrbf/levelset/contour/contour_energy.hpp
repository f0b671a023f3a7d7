#pragma once

#include "csrbf/levelset/lattice/lattice.hpp"

#include <vector>

namespace csrbf {

/// Energy of a contour, for a level set f on a lattice (sums over voxels of volume V, in units of the shortest edge):
///
///     E(alpha) = sum V force H_eps(f) + length sum V weight H_eps'(f) |grad f|
///              + anchor / 2 (sum V (f - target)^2 + ridge |alpha|^2),    target = -force / 2, at most 1 in size
///
/// force is the cost of a voxel inside minus its cost outside, about -1 and 1 where the choice is clear. H_eps rises
/// from 0 at -eps to 1 at eps with two continuous derivatives, so the second sum is the length of the contour (2D) or
/// the area of the surface (3D). The third sum keeps f near what each voxel favours by itself: it lets new parts appear
/// anywhere, bounds f, and is a least-squares problem of its own, whose solution is the start. The smaller eps, the
/// more closely the contour follows the voxels next to it, and their noise.
struct ContourEnergy {
  const float* force = nullptr;    ///< one per voxel, x fastest
  double length = 0;               ///< >= 0
  double eps = 0.25;               ///< > 0, in values of f
  double anchor = 1;               ///< >= 0
  const float* weights = nullptr;  ///< of the length, one per voxel; null: 1
};

/// E and, unless null, its derivatives by the coefficients; arrays of lattice.array_size().
template <int Dim>
double contour_energy(const Lattice<Dim>& lattice, const ContourEnergy& energy, const float* coefficients,
                      float* derivatives);

/// Solves the least-squares part of E, starting from `coefficients`, with at most `iterations` conjugate gradient
/// steps.
template <int Dim>
void fit_target(const Lattice<Dim>& lattice, const ContourEnergy& energy, int iterations,
                std::vector<float>& coefficients);

/// Minimises E by the spectral projected gradient method over |alpha| <= 2 (1 with a length) with back-tracking: no
/// step raises it. Stops after `iterations` evaluations of the derivatives, or when a step lowers it by less than
/// `tolerance` times the decrease so far. Appends the energy at the start and after each step to `energies`; returns
/// the evaluations used.
template <int Dim>
int minimize_contour_energy(const Lattice<Dim>& lattice, const ContourEnergy& energy, int iterations, double tolerance,
                            std::vector<float>& coefficients, std::vector<double>& energies);

/// Brings each voxel to the side of the contour that its force favours: lowers sum (min(|target|, margin) - s f)^2 over
/// the voxels where that is positive, s = 1 or -1 the sign of the target, by at most `iterations` evaluations of a
/// convex function. For images without noise, where the voxels close to the contour are as reliable as all others but
/// count little in E. Returns the evaluations used.
template <int Dim>
int separate_voxels(const Lattice<Dim>& lattice, const float* force, double margin, int iterations,
                    std::vector<float>& coefficients);

/// Root mean square of f - target over the voxels where |f| >= `least`; 0 when there are none.
template <int Dim>
double target_residual(const Lattice<Dim>& lattice, const ContourEnergy& energy, const std::vector<float>& coefficients,
                       double least);

/// Writes 1 where f > 0 and 0 elsewhere, for every voxel; returns the number of labels that changed.
template <int Dim>
Index update_labels(const Lattice<Dim>& lattice, const std::vector<float>& coefficients, unsigned char* labels);

/// Writes the number of the level set whose f is largest, the first of equal ones, for every voxel.
template <int Dim>
void update_labels(const Lattice<Dim>& lattice, const std::vector<const float*>& coefficients,
                   std::vector<std::uint8_t>& labels);

}  // namespace csrbf
