#include "program.hpp"

#include "file_memory.hpp"
#include "interrupt.hpp"
#include "processes.hpp"
#include "verbs.hpp"

#include "csrbf/core/error.hpp"

#include <cstdio>
#include <filesystem>
#include <new>

namespace csrbf::app {
namespace {

enum ExitCode { success = 0, no_result = 1, bad_input = 2 };

int fail(const std::string& verb, const std::string& message, int code) {
  const std::string name = verb.empty() ? "csrbf" : "csrbf " + verb;
  std::fprintf(stderr, "%s: %s\n", name.c_str(), message.c_str());
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
      Session session(line.verb, common);
      std::visit([&](const auto& command) { app::run(command, session); }, line.command);
      session.finish();
    });
    return success;
  } catch (const std::exception& error) {
    // A signal also interrupts reads and writes, which then fail with errors of their own.
    if (interrupted()) return fail(line.verb, "interrupted", interrupt_exit_code());
    if (is_one_of<std::bad_alloc>(error)) return fail(line.verb, not_enough_memory(), no_result);
    const bool is_input = is_one_of<UsageError, InvalidInput, IoError>(error);
    return fail(line.verb, error.what(), is_input ? bad_input : no_result);
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
