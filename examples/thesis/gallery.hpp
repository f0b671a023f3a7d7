#pragma once

#include "figure.hpp"

#include <string>
#include <vector>

namespace csrbf::thesis {

/// Image files of the user's, or empty: an ultrasound image for Fig. 8.10 and an image of bone for Fig. 8.8, which are
/// segmented as well.
struct UserImages {
  std::string ultrasound, bone;
};

/// The names of all figures and tables, in the order of the thesis.
std::vector<std::string> names();

/// Computes one of them. Throws InvalidInput for other names, and what reading the images throws.
Figure compute(const std::string& name, const UserImages& images = {});

}  // namespace csrbf::thesis
