#include "program.hpp"

#include "command_line.hpp"
#include "inputs/tile_flags.hpp"
#include "process/allocation.hpp"
#include "process/interrupt.hpp"

#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/files/process_files.hpp"
#include "csrbf/io/files/read_file.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <new>
#include <system_error>

namespace csrbf::app {
namespace {

enum ExitCode { success = 0, no_result = 1, bad_input = 2 };

int fail(const std::string& subcommand, const std::string& message, int code) {
  const std::string name = subcommand.empty() ? "csrbf" : "csrbf " + subcommand;
  std::fprintf(stderr, "%s: %s\n", name.c_str(), message.c_str());
  return code;
}

bool is_identifier(std::string_view word) {
  return !word.empty() &&
         std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

// The library says "function: parameter = value: constraint"; who types commands knows neither functions nor
// parameters, but flags.
std::string in_terms_of_flags(std::string message, const CommandLine& line) {
  for (std::size_t colon = message.find(": "); colon != std::string::npos && is_identifier(message.substr(0, colon));
       colon = message.find(": "))
    message.erase(0, colon + 2);
  const std::size_t equals = message.find(" = ");
  std::string name = message.substr(0, equals);
  std::replace(name.begin(), name.end(), '_', '-');
  const auto is_named = [&](const FlagUse& flag) { return flag.name == name && !flag.common; };
  if (equals == std::string::npos || std::none_of(line.common.flags.begin(), line.common.flags.end(), is_named))
    return message;
  return "--" + name + " " + message.substr(equals + 3);
}

// --format says what files are whose names do not: the inputs, and an output without an extension.
void assume_formats(const CommandLine& line) {
  if (line.common.format.empty()) return;
  const std::string extension = line.common.format.starts_with('.') ? line.common.format : "." + line.common.format;
  const auto assume = [&](const auto& c) {
    if constexpr (requires { c.input; }) assume_format(c.input, extension);
    if constexpr (requires { c.first; })
      for (const std::string& path : {c.first, c.second})
        if (file_extension(path).empty()) assume_format(path, extension);
    if constexpr (requires { c.output; })
      if (file_extension(c.output).empty()) assume_format(c.output, extension);
  };
  std::visit(assume, line.command);
}

// Finished tiles stay, and take room, until the same command has gone on from them.
std::string interruption(const CommandLine& line) {
  const auto folder = [](const auto& c) -> std::string {
    if constexpr (requires { c.tiles; })
      if (works_in_tiles(c.tiles)) return tile_folder(c.tiles, c.output);
    return {};
  };
  const std::string steps = std::visit(folder, line.command);
  std::error_code none;
  if (steps.empty() || !std::filesystem::exists(utf8_path(steps), none)) return "interrupted";
  return "interrupted; the same command goes on from the steps in " + steps;
}

std::string lack_of_memory(const CommandLine& line) {
  const auto can_be_given = [](const FlagUse& flag) { return flag.name == "memory" && !flag.given; };
  const bool has_tiles = std::any_of(line.common.flags.begin(), line.common.flags.end(), can_be_given);
  return has_tiles ? "not enough memory; --memory SIZE, such as 2GB, works on one part after the other"
                   : "not enough memory";
}

template <class... Types>
bool is_one_of(const std::exception& error) {
  return ((dynamic_cast<const Types*>(&error) != nullptr) || ...);
}

int run(const CommandLine& line) {
  try {
    assume_formats(line);
    Session session(line.subcommand, line.common);
    app::run(line.command, session);
    session.finish();
    return success;
  } catch (const std::exception& error) {
    // A signal also interrupts reads and writes, which then fail with errors of their own.
    if (interrupted()) return fail(line.subcommand, interruption(line), interrupt_exit_code());
    if (is_one_of<std::bad_alloc>(error)) return fail(line.subcommand, lack_of_memory(line), no_result);
    const bool is_input = is_one_of<UsageError, InvalidInput, IoError>(error) && !is_one_of<OutputError>(error);
    const bool has_parameters = is_one_of<InvalidInput>(error);
    return fail(line.subcommand, has_parameters ? in_terms_of_flags(error.what(), line) : error.what(),
                is_input ? bad_input : no_result);
  }
}

// What was printed may be the result, as of info. Without a standard output, nobody waits for it.
int after_printing(int code) {
  errno = EIO;  // of an earlier write
  const bool printed = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (printed || errno == EBADF || code != success) return code;
  return fail("", "standard output: cannot write: " + std::generic_category().message(errno), no_result);
}

}  // namespace

int run_program(int argc, char** argv) {
  catch_interrupts();
  keep_freed_memory();
  try {
    const std::optional<CommandLine> line = parse_command_line(argc, argv);
    return after_printing(line ? run(*line) : success);
  } catch (const UsageError& error) {
    return fail("", error.what(), bad_input);
  } catch (const OutputError& error) {
    return fail("", error.what(), no_result);
  }
}

}  // namespace csrbf::app
