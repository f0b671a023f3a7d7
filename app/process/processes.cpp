#include "process/processes.hpp"

#include "process/interrupt.hpp"

namespace csrbf::app {
namespace {

Processes alone;
Processes* in_use = &alone;

}  // namespace

bool Processes::interrupted() {
  return app::interrupted();
}

Processes& processes() {
  return *in_use;
}

void set_processes(Processes* processes) {
  in_use = processes != nullptr ? processes : &alone;
}

}  // namespace csrbf::app
