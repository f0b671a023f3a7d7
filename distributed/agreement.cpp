#include "agreement.hpp"

#include "command_line.hpp"
#include "process/interrupt.hpp"

#include "csrbf/core/error.hpp"

#include <algorithm>
#include <array>
#include <new>
#include <stdexcept>
#include <string>

namespace csrbf::distributed {
namespace {

// What determines exit code and message.
enum Kind { usage, invalid_input, io, solver, cancelled, no_memory, other };

template <class Type>
bool is(const std::exception& error) {
  return dynamic_cast<const Type*>(&error) != nullptr;
}

Kind kind_of(const std::exception& error) {
  if (is<app::UsageError>(error)) return usage;
  if (is<InvalidInput>(error)) return invalid_input;
  if (is<IoError>(error)) return io;
  if (is<SolverFailure>(error)) return solver;
  if (is<Cancelled>(error)) return cancelled;
  return is<std::bad_alloc>(error) ? no_memory : other;
}

std::exception_ptr make_error(int kind, const std::string& message) {
  switch (kind) {
    case usage:
      return std::make_exception_ptr(app::UsageError(message));
    case invalid_input:
      return std::make_exception_ptr(InvalidInput(message));
    case io:
      return std::make_exception_ptr(IoError(message));
    case solver:
      return std::make_exception_ptr(SolverFailure(message));
    case cancelled:
      return std::make_exception_ptr(Cancelled());
    case no_memory:
      return std::make_exception_ptr(std::bad_alloc());
    default:
      return std::make_exception_ptr(std::runtime_error(message));
  }
}

}  // namespace

Agreement::Agreement(MPI_Comm comm) : comm_(comm) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &size_);
}

bool Agreement::agree(std::exception_ptr mine) {
  std::array<int, 2> state{mine ? size_ - rank_ : 0, app::interrupt_signal()};
  MPI_Allreduce(MPI_IN_PLACE, state.data(), 2, MPI_INT, MPI_MAX, comm_);
  if (state[0] > 0) fail_together(size_ - state[0], mine);
  if (state[1] > 0) app::interrupt_by(state[1]);
  return state[1] > 0;
}

void Agreement::go_on(std::exception_ptr mine) {
  if (agree(std::move(mine))) throw Cancelled();
}

void Agreement::fail_together(int root, const std::exception_ptr& mine) {
  int kind = other;
  std::string message;
  if (rank_ == root) {
    try {
      std::rethrow_exception(mine);
    } catch (const std::exception& error) {
      kind = kind_of(error);
      message = error.what();
    } catch (...) {
      message = "unknown error";
    }
  }
  int length = static_cast<int>(message.size());
  MPI_Bcast(&kind, 1, MPI_INT, root, comm_);
  MPI_Bcast(&length, 1, MPI_INT, root, comm_);
  message.resize(length);
  MPI_Bcast(message.data(), length, MPI_CHAR, root, comm_);
  agreed_ = make_error(kind, message);
  std::rethrow_exception(agreed_);
}

}  // namespace csrbf::distributed
