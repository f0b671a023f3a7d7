#pragma once

namespace csrbf::app {

/// The program csrbf: runs the command on its command line and returns its exit code.
int run_program(int argc, char** argv);

}  // namespace csrbf::app
