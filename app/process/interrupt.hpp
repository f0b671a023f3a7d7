#pragma once

namespace csrbf::app {

/// From now on Ctrl-C (and SIGTERM, SIGHUP) asks the program to stop instead of killing it; a second one ends it at
/// once, without leaving partly written results: those have temporary names.
void catch_interrupts();

/// Whether the program was asked to stop.
bool interrupted();

/// 128 + the number of the signal that asked; 130 for Ctrl-C.
int interrupt_exit_code();

}  // namespace csrbf::app
