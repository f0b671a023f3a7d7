#include "program.hpp"

#include "command_line.hpp"
#include "process/file_memory.hpp"
#include "process/interrupt.hpp"
#include "process/processes.hpp"

#include <cstdio>
#include <filesystem>
#include <new>

namespace csrbf::app {
namespace {

enum ExitCode { success = 0, no_result = 1, bad_input = 2 };

int fail(const std::string& subcommand, const std::string& message, int code) {
  const std::string name = subcommand.empty() ? "csrbf" : "csrbf " + subcommand;
  // The library names its function, which often has the name of the command.
  const std::string function = subcommand + ": ";
  const bool is_twice = !subcommand.empty() && message.starts_with(function);
  std::fprintf(stderr, "%s: %s\n", name.c_str(), message.c_str() + (is_twice ? function.size() : 0));
  return code;
}

template <class... Types>
bool is_one_of(const std::exception& error) {
  return ((dynamic_cast<const Types*>(&error) != nullptr) || ...);
}

// The folder of the output, which needs room for large files anyway.
std::string output_folder(const Command& command) {
  const auto output = [](const auto& c) -> std::string {
    if constexpr (requires { c.output; }) return c.output;
    return "";
  };
  const std::string folder = std::filesystem::path(std::visit(output, command)).parent_path().string();
  return folder.empty() ? "." : folder;
}

std::string not_enough_memory() {
  const std::string reason = file_memory() != nullptr ? file_memory()->failure() : "";
  return "not enough memory" + (reason.empty() ? "" : ": " + reason);
}

int run(const CommandLine& line) {
  try {
    CommonOptions common = line.common;
    if (common.scratch.empty()) common.scratch = output_folder(line.command);
    processes().conclude([&] {
      Session session(line.subcommand, common);
      std::visit([&](const auto& command) { app::run(command, session); }, line.command);
      session.finish();
    });
    return success;
  } catch (const std::exception& error) {
    // A signal also interrupts reads and writes, which then fail with errors of their own.
    if (interrupted()) return fail(line.subcommand, "interrupted", interrupt_exit_code());
    if (is_one_of<std::bad_alloc>(error)) return fail(line.subcommand, not_enough_memory(), no_result);
    const bool is_input = is_one_of<UsageError, InvalidInput, IoError>(error);
    return fail(line.subcommand, error.what(), is_input ? bad_input : no_result);
  }
}

}  // namespace

int run_program(int argc, char** argv) {
  catch_interrupts();
  try {
    const std::optional<CommandLine> line = parse_command_line(argc, argv);
    return line ? run(*line) : success;
  } catch (const UsageError& error) {
    return fail("", error.what(), bad_input);
  }
}

}  // namespace csrbf::app
