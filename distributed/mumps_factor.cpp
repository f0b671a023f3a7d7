#include "mumps_factor.hpp"

#include "csrbf/core/error.hpp"

#include <dmumps_c.h>

#include <exception>
#include <string>
#include <vector>

namespace csrbf::distributed {
namespace {

enum Job { initialize = -1, finish = -2, analyze = 1, factor = 2, solve_system = 3 };

// Indices of the controls in the manual of MUMPS, which count from 1.
constexpr int error_stream = 1, diagnostic_stream = 2, global_stream = 3, print_level = 4, workspace_increase = 14,
              sequential_root = 13;
constexpr int out_of_workspace_a = -8, out_of_workspace_b = -9;
constexpr int not_positive = -40, singular = -10;
constexpr int bad_pivots = 12;

class MumpsFactor : public SparseFactor {
 public:
  MumpsFactor(MPI_Comm comm, Agreement& agreement) : comm_(comm), agreement_(agreement) {
    mumps_.par = 1;
    mumps_.sym = 1;
    mumps_.comm_fortran = static_cast<MUMPS_INT>(MPI_Comm_c2f(comm));
    run(initialize);
    for (const int stream : {error_stream, diagnostic_stream, global_stream}) control(stream) = -1;
    control(print_level) = 0;
    control(sequential_root) = 1;  // else pivots of the root front are not checked
  }
  MumpsFactor(const MumpsFactor&) = delete;
  MumpsFactor& operator=(const MumpsFactor&) = delete;
  // All ranks take part; one that fails on its own leaves the memory to the operating system.
  ~MumpsFactor() override {
    if (std::uncaught_exceptions() == 0) run(finish);
  }

  bool factorize(const Eigen::SparseMatrix<double>& N, bool known) override {
    agreement_.go_on();
    order_ = N.rows();
    if (agreement_.rank() == 0) take(N);
    if (!known) {
      run(analyze);
      check("analysis");
    }
    run(factor);
    while (status() == out_of_workspace_a || status() == out_of_workspace_b) {
      control(workspace_increase) *= 2;  // per cent
      run(factor);
    }
    if (status() == not_positive || status() == singular) return false;
    check("factorisation");
    return mumps_.infog[bad_pivots - 1] == 0;
  }

  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& b) const override {
    agreement_.go_on();
    Eigen::MatrixXd x = b;
    for (Index j = 0; j < x.cols(); ++j) {
      mumps_.rhs = x.col(j).data();
      run(solve_system);
      check("solution");
      MPI_Bcast(x.col(j).data(), static_cast<int>(order_), MPI_DOUBLE, 0, comm_);
    }
    return x;
  }

 private:
  void run(Job job) const {
    mumps_.job = job;
    dmumps_c(&mumps_);
  }
  [[nodiscard]] MUMPS_INT& control(int number) { return mumps_.icntl[number - 1]; }
  [[nodiscard]] int status() const { return mumps_.infog[0]; }

  void check(const char* step) const {
    if (status() >= 0) return;
    throw SolverFailure("MUMPS: " + std::string(step) + " failed with code " + std::to_string(status()) + " (" +
                        std::to_string(mumps_.infog[1]) + ")");
  }

  // The lower triangle as triplets with indices from 1.
  void take(const Eigen::SparseMatrix<double>& N) {
    rows_.clear();
    columns_.clear();
    values_.clear();
    for (Index j = 0; j < N.outerSize(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(N, j); entry; ++entry) {
        if (entry.row() < j) continue;
        rows_.push_back(static_cast<MUMPS_INT>(entry.row() + 1));
        columns_.push_back(static_cast<MUMPS_INT>(j + 1));
        values_.push_back(entry.value());
      }
    mumps_.n = static_cast<MUMPS_INT>(order_);
    mumps_.nnz = static_cast<MUMPS_INT8>(values_.size());
    mumps_.irn = rows_.data();
    mumps_.jcn = columns_.data();
    mumps_.a = values_.data();
  }

  MPI_Comm comm_;
  Agreement& agreement_;
  Index order_ = 0;
  mutable DMUMPS_STRUC_C mumps_{};
  std::vector<MUMPS_INT> rows_, columns_;
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<SparseFactor> make_mumps_factor(MPI_Comm comm, Agreement& agreement) {
  return std::make_unique<MumpsFactor>(comm, agreement);
}

}  // namespace csrbf::distributed
