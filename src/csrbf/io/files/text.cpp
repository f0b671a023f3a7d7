#include "csrbf/io/files/text.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/numbers/number_text.hpp"

#include <charconv>
#include <cstring>

namespace csrbf {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  return word;
}

std::from_chars_result read_from(const char* begin, const char* end, double& value) {
  return read_number(begin, end, value);
}
std::from_chars_result read_from(const char* begin, const char* end, std::int64_t& value) {
  return std::from_chars(begin, end, value);
}

template <class Number>
std::errc parse_whole(std::string_view word, Number& value) {
  const char* end = word.data() + word.size();
  const auto [stop, error] = read_from(word.data(), end, value);
  if (stop != end || word.empty()) return std::errc::invalid_argument;
  return error;
}

}  // namespace

LineReader::LineReader(std::string_view text, std::string name, char comment)
    : text_(text), name_(std::move(name)), comment_(comment) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
}

bool LineReader::next() {
  pause_();
  while (position_ < text_.size()) {
    const char* begin = text_.data() + position_;
    const std::size_t left = text_.size() - position_;
    const void* found = std::memchr(begin, '\n', left);
    const std::size_t length = found != nullptr ? static_cast<const char*>(found) - begin : left;
    position_ += std::min(left, length + 1);
    ++number_;
    line_ = std::string_view(begin, length);
    if (comment_ != '\0') line_ = line_.substr(0, line_.find(comment_));
    line_ = trimmed(line_);
    if (!line_.empty()) return true;
  }
  line_ = {};
  return false;
}

bool LineReader::can_hold(Index items, Index values_each) const {
  // A value takes a digit and a separator. The slack lets files that lack a few values be read up to that line.
  constexpr Index slack = 1 << 16;
  return items <= (std::ssize(rest()) + slack) / (2 * values_each);
}

double LineReader::number(std::string_view word) const {
  const auto value = parse_number(word);
  if (!value) fail(in_quotes(word) + " is not a number");
  return *value;
}

std::int64_t LineReader::integer(std::string_view word, std::int64_t lo, std::int64_t hi) const {
  const auto value = parse_integer(word);
  if (!value || *value < lo || *value > hi)
    fail(in_quotes(word) + " is not a whole number from " + std::to_string(lo) + " to " + std::to_string(hi));
  return *value;
}

void LineReader::fail(const std::string& message) const {
  throw IoError(name_ + ":" + std::to_string(number_) + ": " + message);
}

std::string_view take_word(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && is_blank(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

Index count_words(std::string_view rest) {
  Index words = 0;
  while (!take_word(rest).empty()) ++words;
  return words;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string single_word(std::string_view text) {
  std::string word(text.empty() ? "_" : text);
  for (char& c : word)
    if (static_cast<unsigned char>(c) <= ' ' || c == ',' || c == ';' || c == '#' || c == '"') c = '_';
  return word;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 40;  // characters shown
  std::string out = "\"";
  for (const char c : text.substr(0, longest)) out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return out + (text.size() > longest ? "...\"" : "\"");
}

std::optional<double> parse_number(std::string_view word) {
  word = without_plus(word);
  double value = 0;
  const std::errc error = parse_whole(word, value);
  if (error != std::errc() && error != std::errc::result_out_of_range) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
  std::int64_t value = 0;
  if (parse_whole(without_plus(word), value) != std::errc()) return std::nullopt;
  return value;
}

void append_number(std::string& out, double value) {
  char buffer[32];
  out.append(buffer, write_number(buffer, buffer + sizeof buffer, value));
}

}  // namespace csrbf
