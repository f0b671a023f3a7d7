#pragma once

#include <mpi.h>

#include <exception>
#include <utility>

namespace csrbf::distributed {

/// Lets ranks that do the same steps fail and stop together: before every exchange they share their status.
class Agreement {
 public:
  explicit Agreement(MPI_Comm comm);

  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int size() const { return size_; }

  /// Collective. Throws the failure of the lowest rank that has one on all ranks, as an error of its kind with its
  /// message. Returns whether any rank was asked to stop; from then on all of them are.
  bool agree(std::exception_ptr mine = nullptr);

  /// agree(), with Cancelled when a rank was asked to stop.
  void go_on(std::exception_ptr mine = nullptr);

  /// Whether `error` is what agree() threw.
  [[nodiscard]] bool is_agreed(const std::exception_ptr& error) const { return error == agreed_; }

 private:
  [[noreturn]] void fail_together(int root, const std::exception_ptr& mine);

  MPI_Comm comm_;
  int rank_ = 0, size_ = 1;
  std::exception_ptr agreed_;
};

}  // namespace csrbf::distributed
