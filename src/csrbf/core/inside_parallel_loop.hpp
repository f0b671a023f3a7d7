#pragma once

namespace csrbf {

/// Whether the calling thread is executing the body of a parallel_for().
bool inside_parallel_loop();

}  // namespace csrbf
