#pragma once

namespace csrbf {

/// Whether the calling thread is at work on the body of a parallel_for().
bool inside_parallel_loop();

}  // namespace csrbf
