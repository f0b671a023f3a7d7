#pragma once

#include "csrbf/core/interruption.hpp"
#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>

namespace csrbf::python {

namespace py = pybind11;

/// A C-contiguous array of float64; it is not copied, other arrays are converted.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// An (n, d) array as the d x n matrix with the same memory.
inline Eigen::Map<const Eigen::MatrixXd> columns(const Array& array, const char* name) {
  if (array.ndim() != 2) throw InvalidInput(std::string(name) + ": must be a two-dimensional array, one point a row");
  return {array.data(), array.shape(1), array.shape(0)};
}

/// As columns(), for points of known dimension.
template <int Dim>
Eigen::Map<const Points<Dim>> points(const Array& array, const char* name) {
  if (array.ndim() != 2 || array.shape(1) != Dim)
    throw InvalidInput(std::string(name) + ": must be an array of " + std::to_string(Dim) + " columns");
  return {array.data(), Dim, array.shape(0)};
}

inline Eigen::Map<const Eigen::VectorXd> vector(const Array& array, const char* name) {
  if (array.ndim() != 1) throw InvalidInput(std::string(name) + ": must be a one-dimensional array");
  return {array.data(), array.size()};
}

/// A matrix as the C-contiguous array (columns, rows) that owns its memory.
template <class Matrix>
py::array_t<typename Matrix::Scalar> to_array(Matrix&& matrix) {
  auto owned = std::make_unique<std::decay_t<Matrix>>(std::forward<Matrix>(matrix));
  const auto* data = owned->data();
  const std::vector<py::ssize_t> shape = {owned->cols(), owned->rows()};
  const py::capsule owner(owned.release(), [](void* p) { delete static_cast<std::decay_t<Matrix>*>(p); });
  return py::array_t<typename std::decay_t<Matrix>::Scalar>(shape, data, owner);
}

/// Asks Python now and then whether a signal has arrived, and tells a listener, a function of stage and fraction or
/// None. Once the handler of a signal (Ctrl-C: KeyboardInterrupt) or the listener raised an exception, work is to stop.
class Watch {
 public:
  explicit Watch(const py::object& listener) : listener_(listener.is_none() ? nullptr : listener.ptr()) {}

  bool interrupted() {
    if (!raised_ && Clock::now() - last_ >= pause) {
      const py::gil_scoped_acquire hold;
      raised_ = PyErr_CheckSignals() != 0;
      last_ = Clock::now();
    }
    return raised_;
  }

  bool goes_on(std::string_view stage, double fraction) {
    if (interrupted() || listener_ == nullptr) return !raised_;
    const py::gil_scoped_acquire hold;
    try {
      py::reinterpret_borrow<py::function>(listener_)(py::str(stage.data(), stage.size()), fraction);
    } catch (py::error_already_set& error) {
      error.restore();
      raised_ = true;
    }
    return !raised_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds pause{50};

  PyObject* listener_;
  Clock::time_point last_ = Clock::now();
  bool raised_ = false;
};

/// work(progress) without the interpreter lock; exceptions of a signal handler or the listener are passed on.
template <class Work>
auto run(const py::object& listener, const Work& work) {
  const auto watch = std::make_shared<Watch>(listener);
  try {
    const py::gil_scoped_release release;
    const Interruptible interruptible([watch] { return watch->interrupted(); });
    return work([watch](std::string_view stage, double fraction) { return watch->goes_on(stage, fraction); });
  } catch (const Cancelled&) {
    throw py::error_already_set();
  } catch (const IoError&) {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();  // a signal ends waiting for a pipe
    throw;
  }
}

template <class Work>
auto run(const Work& work) {
  return run(py::none(), work);
}

/// Calls use(begin, count) for parts of [0, n), polling for signals in between.
template <class Use>
void in_parts(Index n, const Progress& progress, const Use& use) {
  constexpr Index part = Index{1} << 18;  // points; larger: fewer calls, smaller: quicker reaction to Ctrl-C
  for (Index begin = 0; begin < n; begin += part) {
    report(progress, "evaluate", static_cast<double>(begin) / static_cast<double>(n));
    use(begin, std::min(part, n - begin));
  }
}

/// Sets `field` to the entry of that name, if any.
template <class Value>
void read_entry(const py::dict& given, const char* name, Value& field) {
  if (!given.contains(name)) return;
  try {
    field = given[name].cast<Value>();
  } catch (const py::cast_error&) {
    const auto shown = py::repr(given[name]).cast<std::string>();
    throw InvalidInput(std::string(name) + " = " + shown + ": is of the wrong type; the docstring says what it may be");
  }
}

/// The word of that name, or another one where it is not given.
inline std::string word_or(const py::dict& given, const char* name, std::string word) {
  read_entry(given, name, word);
  return word;
}

void bind_fit(py::module_& m);
void bind_image(py::module_& m);
void bind_mesh(py::module_& m);
void bind_points(py::module_& m);
void bind_rbf_interpolator(py::module_& m);
void bind_segment(py::module_& m);
void bind_surface(py::module_& m);

}  // namespace csrbf::python
