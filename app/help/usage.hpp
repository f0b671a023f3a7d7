#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
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

/// The usage as declared to the parser.
Usage usage_of(const CLI::App& app);

}  // namespace csrbf::app
