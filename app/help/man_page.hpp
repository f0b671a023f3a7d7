#pragma once

#include "help/usage.hpp"

namespace csrbf::app {

/// The manual page of the program in roff with the man macros.
std::string man_page(const Usage& program);

}  // namespace csrbf::app
