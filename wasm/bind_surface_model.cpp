// Models of the module that has surfaces only: the place of bind_fit.cpp.
#include "model.hpp"

#include "csrbf/core/error.hpp"

#include <emscripten.h>

namespace csrbf::wasm {

void add_model(Answer& answer, Model model) {
  const Box<3> box = model.surface->bounds();
  answer.json["model"] = {{"dimension", 3},
                          {"components", 1},
                          {"bounds", {box.lo.x(), box.lo.y(), box.lo.z(), box.hi.x(), box.hi.y(), box.hi.z()}},
                          {"address", reinterpret_cast<std::uintptr_t>(new Model(std::move(model)))}};
}

}  // namespace csrbf::wasm

extern "C" {

using csrbf::wasm::Answer;
using csrbf::wasm::Model;

EMSCRIPTEN_KEEPALIVE Answer* csrbf_evaluate(const Model* model, const double* points, int dimension, int count,
                                            int with_gradient) {
  return csrbf::wasm::answer([&](Answer& answer) {
    csrbf::require(dimension == 3, "evaluate", "dimension", dimension, "the points must have 3 coordinates");
    const Eigen::Map<const csrbf::Points<3>> x(points, 3, count);
    csrbf::Jet<3> jet =
        model->surface->evaluate(x, with_gradient != 0 ? csrbf::Derivatives::gradient : csrbf::Derivatives::none);
    if (with_gradient != 0)
      answer.add("gradient", std::move(jet.gradient));
    else
      answer.add("value", std::move(jet.value));
  });
}
EMSCRIPTEN_KEEPALIVE void csrbf_delete(const Model* model) {
  delete model;
}
}
