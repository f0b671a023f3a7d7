#pragma once

#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class FormatterBase;
class Option;
}  // namespace CLI

namespace csrbf::app {

/// Heading of the flags of every command in the help.
inline constexpr const char* common_group = "Common flags";

/// A flag as the help shows it.
struct FlagUsage {
  std::vector<std::string> names = {};  ///< with their dashes, short ones first
  std::string value;                    ///< form of its value, such as N, FILE or auto|none|L; empty when it takes none
  std::vector<std::string> words = {};  ///< values that are literal words: auto and none above
  bool only_words = false;              ///< it takes nothing else
  std::string lowest = {}, highest = {};  ///< bounds of a number, where they are checked
  bool common = false;                    ///< of every command
  std::string what;
  std::string shown_default;  ///< empty: none
  bool required = false;

  [[nodiscard]] bool takes_file() const { return value == "FILE"; }
};

struct ArgumentUsage {
  std::string name, what;
};

/// The command line of the program or of one of its commands. The program has commands and no arguments, a command the
/// opposite.
struct Usage {
  std::string name, what;
  std::string example;  ///< one command
  std::vector<ArgumentUsage> arguments = {};
  std::vector<FlagUsage> flags = {};  ///< in the order of the help; hidden ones are left out
  std::vector<Usage> subcommands = {};
};

/// Form of the value of a flag, without the checks that CLI11 appends; empty when it takes none.
std::string value_form(const CLI::Option& option);

/// Declares that the value of an option may be one of these words, for completion; others may be valid too.
void name_words(const CLI::Option& option, std::vector<std::string> words);

/// The usage as declared to the parser.
Usage usage_of(const CLI::App& app);

/// Help with one entry per flag: the form of its value, its wrapped description and its default.
std::shared_ptr<CLI::FormatterBase> help_formatter();

/// The manual page of the program in roff with the man macros.
std::string man_page(const Usage& program);

/// The script with which a shell completes the command line of the program: its commands, their flags, and values that
/// are words; file names elsewhere. `shell` is bash, zsh or fish.
std::string completion(const Usage& program, const std::string& shell);

/// The commands of the program with their arguments and flags as JSON, in the form that viewer/src/engine/engine.js
/// describes (Command).
std::string usage_json(const Usage& program);

/// True for commands that 3D Slicer can run as command-line modules.
bool is_slicer_module(const std::string& subcommand);

/// The description that 3D Slicer asks a command-line module for (XML): title, parameters and their constraints.
std::string slicer_module(const Usage& subcommand);

}  // namespace csrbf::app
