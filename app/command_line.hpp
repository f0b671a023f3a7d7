#pragma once

#include "commands/commands.hpp"

namespace csrbf::app {

struct CommandLine {
  std::string subcommand;
  CommonOptions common;
  Command command;
};

/// Parses the arguments; nothing when they ask for help or the version, which is then printed. Throws UsageError.
std::optional<CommandLine> parse_command_line(int argc, char** argv);

}  // namespace csrbf::app
