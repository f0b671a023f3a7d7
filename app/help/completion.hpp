#pragma once

#include "help/usage.hpp"

namespace csrbf::app {

/// The script with which a shell completes the command line of the program: its commands, their flags, and values that
/// are words; file names elsewhere. `shell` is bash, zsh or fish.
std::string completion(const Usage& program, const std::string& shell);

}  // namespace csrbf::app
