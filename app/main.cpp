#include "interrupt.hpp"
#include "verbs.hpp"

#include "csrbf/core/error.hpp"

#include <cstdio>
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

int run(const CommandLine& line) {
  try {
    Session session(line.verb, line.common);
    std::visit([&](const auto& command) { app::run(command, session); }, line.command);
    session.finish();
    return success;
  } catch (const std::exception& error) {
    // A signal also breaks off reading and writing, which then fail with errors of their own.
    if (interrupted()) return fail(line.verb, "interrupted", interrupt_exit_code());
    if (is_one_of<std::bad_alloc>(error)) return fail(line.verb, "not enough memory", no_result);
    const bool is_input = is_one_of<UsageError, InvalidInput, IoError>(error);
    return fail(line.verb, error.what(), is_input ? bad_input : no_result);
  }
}

int main(int argc, char** argv) {
  catch_interrupts();
  try {
    const std::optional<CommandLine> line = parse_command_line(argc, argv);
    return line ? run(*line) : success;
  } catch (const UsageError& error) {
    return fail("", error.what(), bad_input);
  }
}

}  // namespace
}  // namespace csrbf::app

int main(int argc, char** argv) {
  return csrbf::app::main(argc, argv);
}
