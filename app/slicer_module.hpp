#pragma once

#include "usage.hpp"

namespace csrbf::app {

/// True for verbs that 3D Slicer can run as command-line modules.
bool is_slicer_module(const std::string& verb);

/// The description that 3D Slicer asks a command-line module for (XML): title, parameters and their constraints.
std::string slicer_module(const Usage& verb);

}  // namespace csrbf::app
