#pragma once

#include "csrbf/core/types.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace csrbf::app {

using Json = nlohmann::ordered_json;

/// JSON of an option: null where it was not given.
template <class Value>
Json or_null(bool given, const Value& value) {
  return given ? Json(value) : Json(nullptr);
}
template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}
inline Json or_null(const std::string& text) {
  return or_null(!text.empty(), text);
}

/// The command line is malformed.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A flag of the command.
struct FlagUse {
  std::string name;  ///< without the dashes
  std::string what;
  bool given = false;
  std::string value = {};  ///< as typed
  bool common = false;     ///< shared by all commands
};

/// The hidden flag by which the studio starts commands.
inline constexpr const char* job_flag = "--job";

/// Flags of every command.
struct CommonOptions {
  int threads = 0;                   ///< 0 = all cores
  std::vector<std::string> reports;  ///< files of the report: .json, .html
  std::string progress = "auto";     ///< auto, always, never, slicer
  std::string format;                ///< of files without an extension; empty: by their content
  std::string job;                   ///< file of the report for the studio, which then reads progress as Slicer does
  bool quiet = false;
  bool verbose = false;

  std::string command;              ///< as typed
  std::vector<FlagUse> flags;       ///< all flags of the command
  std::vector<std::string> values;  ///< of arguments and flags, as typed
};

/// `value` with a few significant digits, for the summary.
std::string rounded(double value, int digits = 4);

/// The same, with digits enough to tell a thousandth of `extent`: places on a map, far from its origin.
std::string rounded_within(double extent, double value);

/// With thousands separators: 52,980; of a decimal number in its whole part.
std::string grouped(Index count);
std::string grouped(std::string number);

/// "1 point", "2 points", with thousands separators: counts in the summary.
std::string counted(Index count, const std::string& noun);

/// A number for people, with this many significant digits: 52,980, 0.0753, 3.2×10⁻⁶.
std::string readable(double value, int digits = 3);

/// A typographic minus, and powers of ten as 3×10⁻⁵.
std::string pretty_number(const std::string& text);

/// `text` as numbers separated by `separator`: exactly `count` of them. Throws UsageError that names `flag`.
Eigen::VectorXd parse_numbers(const std::string& text, char separator, Index count, const std::string& flag);

/// As parse_numbers, for any count.
Eigen::VectorXd parse_list(const std::string& text, char separator, const std::string& flag);

/// The value of --smoothing auto|none|L: nothing, 0 or L. Throws UsageError.
std::optional<double> parse_smoothing(const std::string& text);

/// The value of a flag that takes a word or a number. Throws UsageError when the text is neither.
std::optional<double> parse_word_or_number(const std::string& text, const std::string& word, const std::string& flag);

}  // namespace csrbf::app
