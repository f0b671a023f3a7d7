#pragma once

#include "csrbf/kernels/kernel.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace csrbf {

struct Named {
  std::string name;
  double parameter = std::nan("");
};

// Every kernel of a dimension, those with a parameter with some values of it.
inline std::vector<Named> all_kernels(int dimension) {
  std::vector<Named> kernels;
  for (const std::string& name : Kernel::names(dimension)) kernels.push_back({name});
  for (const double nu : {.3, 1.0, 1.7, 2.0, 3.2}) kernels.push_back({"matern", nu});
  for (const double b : {.2, 1.5, 2.0}) kernels.push_back({"inverse-multiquadric", b});
  for (const double b : {.7, 1.5, 2.3}) kernels.push_back({"multiquadric", b});
  for (const double b : {.5, 2.5, 4.0, 6.0}) kernels.push_back({"polyharmonic", b});
  return kernels;
}

inline std::string label(const Named& k) {
  return k.name + " " + std::to_string(k.parameter);
}

}  // namespace csrbf
