#pragma once

#include "agreement.hpp"

#include "csrbf/linalg/sparse_factor.hpp"

namespace csrbf::distributed {

/// Matrices below this order are factorised by every rank on its own, which takes less time than sharing the work.
/// Chosen by hand.
constexpr Index fewest_shared_unknowns = 2000;

/// A Cholesky factor by MUMPS, distributed over the ranks. All of them pass the same matrix and get the same solution,
/// which rank 0 collects. `agreement` must outlive it.
std::unique_ptr<SparseFactor> make_mumps_factor(MPI_Comm comm, Agreement& agreement);

}  // namespace csrbf::distributed
