#include "bindings.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/version.hpp"

namespace {

constexpr const char* thread_count_text = R"(Number of threads that computations use.

Returns
-------
int

Examples
--------
>>> csrbf.thread_count() >= 1
True
)";

constexpr const char* set_thread_count_text = R"(Set the number of threads. Results do not depend on it.

Parameters
----------
threads : int
    0 for all cores.

Raises
------
ValueError
    For negative numbers.

Examples
--------
>>> csrbf.set_thread_count(1)
>>> csrbf.thread_count()
1
>>> csrbf.set_thread_count(0)
)";

constexpr const char* solver_failure_text = R"(Valid data, but no result of the requested quality.

Examples
--------
>>> try:
...     csrbf.RBFInterpolator([[0.0], [0.0]], [1.0, 2.0])
... except csrbf.SolverFailure:
...     print("one point cannot have two values")
one point cannot have two values
)";

constexpr const char* io_error_text = R"(A file that cannot be read or written; an OSError.

Examples
--------
>>> try:
...     csrbf.read_points("nowhere.ply")
... except csrbf.IoError as error:
...     print("nowhere.ply" in str(error))
True
)";

}  // namespace

// The names of this module are those of C++; csrbf/__init__.py wraps them for users.
PYBIND11_MODULE(_csrbf, m) {
  using namespace csrbf;

  // InvalidInput is a std::invalid_argument, for which pybind11 raises ValueError.
  auto& solver_failure = pybind11::register_exception<SolverFailure>(m, "SolverFailure", PyExc_RuntimeError);
  solver_failure.attr("__module__") = "csrbf";
  solver_failure.attr("__doc__") = solver_failure_text;
  auto& io_error = pybind11::register_exception<IoError>(m, "IoError", PyExc_OSError);
  io_error.attr("__module__") = "csrbf";
  io_error.attr("__doc__") = io_error_text;

  m.attr("version") = CSRBF_VERSION;
  m.def("thread_count", &thread_count, thread_count_text);
  m.def("set_thread_count", &set_thread_count, pybind11::arg("threads"), set_thread_count_text);
  python::bind_fit(m);
  python::bind_image(m);
  python::bind_mesh(m);
  python::bind_points(m);
  python::bind_rbf_interpolator(m);
  python::bind_segment(m);
  python::bind_surface(m);
}
