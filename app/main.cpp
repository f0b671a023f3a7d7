#include "program.hpp"

int main(int argc, char** argv) {
  return csrbf::app::run_program(argc, argv);
}
