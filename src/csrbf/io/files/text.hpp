#pragma once

#include "csrbf/core/interruption.hpp"
#include "csrbf/core/types.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace csrbf {

/// Iterates over the lines of a text and knows its position for messages. Unix and Windows line ends; the last line may
/// lack one. The text must outlive the reader.
class LineReader {
 public:
  /// `name` is the file's name in messages; what follows `comment` on a line is ignored (none by default).
  LineReader(std::string_view text, std::string name, char comment = '\0');

  /// Moves to the next line that is not blank; false at the end of the text.
  bool next();
  /// The current line without comment, line end and surrounding blanks.
  [[nodiscard]] std::string_view line() const { return line_; }
  /// 1-based number of the current line.
  [[nodiscard]] Index line_number() const { return number_; }
  /// The text after the current line.
  [[nodiscard]] std::string_view rest() const { return text_.substr(position_); }
  /// False when the text after the current line is far too short for so many items: their memory must not be allocated.
  [[nodiscard]] bool can_hold(Index items, Index values_each) const;
  /// The file's name.
  [[nodiscard]] const std::string& name() const { return name_; }

  /// A word of the current line as a number. Throws IoError when it is none.
  [[nodiscard]] double number(std::string_view word) const;
  /// A word of the current line as an integer in [lo, hi]. Throws IoError when it is none.
  [[nodiscard]] std::int64_t integer(std::string_view word, std::int64_t lo, std::int64_t hi) const;
  /// Throws IoError "name:line: message".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string_view text_;
  std::string name_;
  char comment_;
  std::size_t position_ = 0;
  std::string_view line_;
  Index number_ = 0;
  InterruptionPoint pause_{1U << 12};
};

/// Removes the next blank-separated word from `rest`; empty when there is none.
std::string_view take_word(std::string_view& rest);

/// Number of words left in `rest`.
Index count_words(std::string_view rest);

/// `text` without blanks around it.
std::string_view trimmed(std::string_view text);

/// `text` with the letters A to Z in lower case.
std::string lower_case(std::string_view text);

/// `text` as one word for headers: blanks, separators and quotes become underscores.
std::string single_word(std::string_view text);

/// `text` in double quotes, shortened when long and without control characters: for messages.
std::string in_quotes(std::string_view text);

/// `word` as a number (a leading plus, nan and inf are allowed), if all of it is one.
std::optional<double> parse_number(std::string_view word);

/// `word` as an integer, if all of it is one.
std::optional<std::int64_t> parse_integer(std::string_view word);

/// Appends the shortest text that reads back as the same double.
void append_number(std::string& out, double value);

}  // namespace csrbf
