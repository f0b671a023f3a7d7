#pragma once

#include <cstddef>

namespace csrbf::app {

/// The most memory that the process has had at once; 0 where the system does not tell.
std::size_t peak_memory_bytes();

}  // namespace csrbf::app
