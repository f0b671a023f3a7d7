#pragma once

#include "figure.hpp"
#include "level_sets.hpp"

namespace csrbf::thesis {

/// What the thesis measured on a Pentium IV of 3.6 GHz, s.
struct PublishedTimes {
  double build, factor;             ///< Table 8.1
  double euler, parameters, total;  ///< Table 8.2
};

/// An image of Tables 8.1 and 8.2 and what we measure on it, s.
struct Timing {
  std::string name;
  double voxels = 0, nodes = 0;
  PublishedTimes published;
  double entries = 0;                ///< of H, per row
  double build = 0, factor = 0;      ///< of H as a sparse matrix and its Cholesky factor; 0: not tried
  double set_up = 0;                 ///< of H as collocate() takes it
  double euler = 0, parameters = 0;  ///< of all steps; values at the voxels are part of a step
  double total = 0;
  int iterations = 0;
  double dice = 0;
  double segment = 0, segment_dice = 0;  ///< the same task by segment()
};

Timing time_shape();    ///< Simulation 1
Timing time_star();     ///< Simulation 2
Timing time_speckle();  ///< U.S.
Timing time_bone();     ///< Calcaneous

/// Tables 8.1 and 8.2.
Figure table_8_1();

}  // namespace csrbf::thesis
