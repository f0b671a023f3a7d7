#include "bindings.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/version.hpp"

// The names of this module are those of C++; csrbf/__init__.py makes of them what users see.
PYBIND11_MODULE(_csrbf, m) {
  using namespace csrbf;

  // InvalidInput is a std::invalid_argument, for which pybind11 raises ValueError.
  pybind11::register_exception<SolverFailure>(m, "SolverFailure", PyExc_RuntimeError).attr("__module__") = "csrbf";
  pybind11::register_exception<IoError>(m, "IoError", PyExc_OSError).attr("__module__") = "csrbf";

  m.attr("version") = CSRBF_VERSION;
  m.def("thread_count", &thread_count, "Number of threads that computations use.");
  m.def("set_thread_count", &set_thread_count, pybind11::arg("threads"),
        "Sets the number of threads, 0 for all cores. Results do not depend on it.");
  python::bind_fit(m);
  python::bind_rbf_interpolator(m);
  python::bind_segment(m);
  python::bind_surface(m);
}
