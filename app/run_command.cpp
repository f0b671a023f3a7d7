#include "commands/commands.hpp"

namespace csrbf::app {

void run(const Command& command, Session& session) {
  std::visit([&](const auto& chosen) { run(chosen, session); }, command);
}

}  // namespace csrbf::app
