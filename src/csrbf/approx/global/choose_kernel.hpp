#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/kernels/kernel.hpp"
#include "csrbf/linalg/ridge.hpp"

#include <optional>
#include <string>
#include <vector>

namespace csrbf {

struct ChooseKernelOptions {
  std::vector<std::string> names = {};                          ///< candidates; empty: see choose_kernel()
  double parameter = std::numeric_limits<double>::quiet_NaN();  ///< of every candidate; NaN: its default
  double support = 0;                   ///< > 0: given; 0: chosen for every candidate that has a scale
  double largest_support = 0;           ///< upper end of the choice; 0: twice the diagonal of the data
  std::optional<double> smoothing = 0;  ///< lambda for samples of mean weight 1; empty: chosen with every support
  LambdaCriterion criterion = LambdaCriterion::leave_one_out;  ///< by which lambda is chosen
  int degree = -2;              ///< of the polynomial; -2: order - 1 of the kernel, at least 0
  Index patch = 600;            ///< number of samples beyond which neighbourhoods represent all; chosen by hand
  Index smoothing_patch = 250;  ///< the same when lambda is chosen, which takes an eigenvalue decomposition
};

struct KernelChoice {
  Kernel kernel;
  double support = 1;        ///< for a kernel without a scale: the half extent of the data
  double smoothing = 0;      ///< given or chosen
  double leave_one_out = 0;  ///< root mean square error, each component in units of its standard deviation
};

/// The degree that -2 stands for.
int default_degree(const Kernel& kernel);

/// The kernel and support with the smallest leave-one-out error (Rippa 1999) of the interpolant, or the smoothed
/// interpolant, over a logarithmic range of supports from the spacing of the samples to their extent, refined by golden
/// section. Systems that rounding makes indefinite get the smallest lambda that works (see SaddleOptions), and their
/// leave-one-out errors show whether it does harm: so the choice is safe in the flat limit.
///
/// Candidates by default: gaussian, inverse-multiquadric, multiquadric, matern-c2, matern-c6, linear, thin-plate,
/// cubic, quintic, without those whose polynomial has more than half as many coefficients as there are samples.
///
/// More samples than `patch` are represented by three neighbourhoods of that many samples. Solves about 100 dense
/// systems of at most `patch` unknowns. Samples must be distinct points with positive weights (see merge_duplicates).
///
/// Throws InvalidInput for unknown names, kernels that are not positive definite in the dimension, and invalid samples.
template <int Dim>
KernelChoice choose_kernel(const Samples<Dim>& samples, const ChooseKernelOptions& options = {});

}  // namespace csrbf
