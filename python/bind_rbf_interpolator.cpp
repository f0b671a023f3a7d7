#include "bindings.hpp"

#include "csrbf/approx/rbf_interpolator.hpp"

#include <memory>

namespace csrbf::python {
namespace {

RbfInterpolatorOptions make_interpolator_options(Index neighbors, const Array& smoothing, const std::string& kernel,
                                                 double epsilon, int degree) {
  return {.neighbors = neighbors,
          .smoothing = vector(smoothing, "smoothing"),
          .kernel = kernel,
          .epsilon = epsilon,
          .degree = degree};
}

}  // namespace

void bind_rbf_interpolator(py::module_& m) {
  py::class_<RbfInterpolator>(m, "RbfInterpolator")
      .def(py::init([](const Array& points, const Array& values, Index neighbors, const Array& smoothing,
                       const std::string& kernel, std::optional<double> epsilon, std::optional<int> degree) {
        RbfInterpolatorOptions options{.neighbors = neighbors,
                                       .smoothing = vector(smoothing, "smoothing"),
                                       .kernel = kernel,
                                       .epsilon = epsilon,
                                       .degree = degree};
        return run([&](const Progress& progress) {
          options.progress = progress;
          return std::make_unique<RbfInterpolator>(columns(points, "y"), columns(values, "d"), options);
        });
      }))
      .def_static("restore",
                  [](const Array& points, const Array& coefficients, const Array& smoothing, const std::string& kernel,
                     double epsilon, int degree) {
                    return std::make_unique<RbfInterpolator>(
                        RbfInterpolator::restore(columns(points, "y"), columns(coefficients, "coefficients"),
                                                 make_interpolator_options(0, smoothing, kernel, epsilon, degree)));
                  })
      .def("evaluate",
           [](const RbfInterpolator& f, const Array& x) {
             return to_array(run([&](const Progress& progress) { return f.evaluate(columns(x, "x"), progress); }));
           })
      .def_property_readonly("coefficients", [](const RbfInterpolator& f) { return to_array(f.coefficients()); })
      .def_property_readonly("degree", &RbfInterpolator::degree)
      .def_property_readonly("epsilon", &RbfInterpolator::epsilon)
      .def_property_readonly("powers",
                             [](const RbfInterpolator& f) { return to_array(Eigen::MatrixXi(f.powers().transpose())); })
      .def_static("smallest_degree", &RbfInterpolator::smallest_degree);
}

}  // namespace csrbf::python
