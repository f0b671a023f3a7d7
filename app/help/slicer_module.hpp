#pragma once

#include "help/usage.hpp"

namespace csrbf::app {

/// True for commands that 3D Slicer can run as command-line modules.
bool is_slicer_module(const std::string& subcommand);

/// The description that 3D Slicer asks a command-line module for (XML): title, parameters and their constraints.
std::string slicer_module(const Usage& subcommand);

}  // namespace csrbf::app
