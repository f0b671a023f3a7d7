#include "csrbf/io/files/column_picker.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/text.hpp"

#include <algorithm>

namespace csrbf {

std::string listed(const std::vector<std::string>& words) {
  std::vector<std::string> quoted;
  for (const std::string& word : words) quoted.push_back(in_quotes(word));
  return joined(quoted);
}

namespace {

// As 2024-03-01, 01.03.2024 or 3/1/2024, with or without a time.
bool is_date(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  char mark = 0;
  int marks = 0;
  for (const char c : text.substr(0, text.find_first_of(" T"))) {
    if (is_digit(c)) continue;
    if (std::string_view("-./").find(c) == std::string_view::npos || (mark != 0 && c != mark)) return false;
    mark = c;
    ++marks;
  }
  return marks == 2 && is_digit(text.front());
}

// The name without the unit in brackets behind it.
std::string_view without_unit(std::string_view name) {
  if (!name.ends_with(')') && !name.ends_with(']')) return name;
  return trimmed(name.substr(0, name.rfind(name.ends_with(')') ? '(' : '[')));
}

bool has_decimal_comma(std::string number) {
  const std::size_t comma = number.find(',');
  if (comma == std::string::npos) return false;
  number[comma] = '.';
  return parse_number(number).has_value();
}

std::string hint_on(const std::string& text, const std::string& remedy) {
  if (has_decimal_comma(text)) return "; write numbers with a point, as 0.5";
  if (is_date(text)) return "; write dates as numbers, as the days since the first one";
  return remedy.empty() ? "" : "; " + remedy + "; leave cells without a value empty";
}

}  // namespace

std::vector<Index> ColumnPicker::take(std::string_view list) {
  std::vector<Index> columns;
  while (!trimmed(list).empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    columns.push_back(take_one(trimmed(list.substr(0, comma))));
    list.remove_prefix(std::min(list.size(), comma + 1));
  }
  return columns;
}

std::vector<Index> ColumnPicker::find(std::string_view list) const {
  ColumnPicker other(table_, name_);
  return other.take(list);
}

std::optional<Index> ColumnPicker::find_similar(const std::string& word) const {
  const auto key = [](std::string_view name) { return lower_case(single_word(name)); };
  std::vector<Index> similar, without;
  for (Index i = 0; i < std::ssize(table_.names); ++i) {
    const std::string& name = table_.names[static_cast<std::size_t>(i)];
    if (name == word) return i;
    if (key(name) == key(word)) similar.push_back(i);
    const bool both =
        without_unit(name) != name && without_unit(word) != std::string_view(word);  // units, which differ
    if (!both && key(without_unit(name)) == key(without_unit(word))) without.push_back(i);
  }
  const std::vector<Index>& found = similar.empty() ? without : similar;
  return found.size() == 1 ? std::optional(found.front()) : std::nullopt;
}

std::vector<Index> ColumnPicker::take_free(const std::vector<Index>& wanted) {
  std::vector<Index> columns;
  for (const Index i : wanted)
    if (!used(i)) {
      use(i);
      columns.push_back(i);
    }
  return columns;
}

std::vector<Index> ColumnPicker::take_rest() {
  return take_free(all());
}

std::vector<Index> ColumnPicker::take_last() {
  for (Index i = size() - 1; i >= 0; --i)
    if (!used(i)) {
      use(i);
      return {i};
    }
  return {};
}

std::vector<Index> ColumnPicker::all() const {
  std::vector<Index> columns;
  for (Index i = 0; i < size(); ++i) columns.push_back(i);
  return columns;
}

void ColumnPicker::check_numbers(const std::vector<Index>& columns, const std::string& remedy) const {
  for (const TextCell& cell : table_.text_cells)
    if (std::find(columns.begin(), columns.end(), cell.column) != columns.end())
      throw IoError(name_ + ":" + std::to_string(cell.line) + ": " + in_quotes(cell.text) +
                    " is not a number (column " + std::to_string(cell.column + 1) + ")" + hint_on(cell.text, remedy));
}

Index ColumnPicker::take_one(std::string_view word) {
  const auto found = std::find(table_.names.begin(), table_.names.end(), word);
  const auto number = parse_integer(word);
  const std::optional<Index> similar = number ? std::nullopt : find_similar(std::string(word));
  Index column = 0;
  if (found != table_.names.end())
    column = found - table_.names.begin();
  else if (similar)
    column = *similar;
  else if (number && *number >= 1 && *number <= size())
    column = static_cast<Index>(*number) - 1;
  else if (number)
    throw IoError(name_ + ": there is no column " + in_quotes(word) + "; the file has " + std::to_string(size()) +
                  " columns");
  else
    throw IoError(name_ + ": no column is named " + in_quotes(word) + "; " + did_you_mean(word, table_.names) +
                  (table_.names.empty() ? "the columns have no names, give numbers from 1 to " + std::to_string(size())
                                        : "the columns are " + listed(table_.names)));
  if (used(column)) throw IoError(name_ + ": column " + in_quotes(word) + " is used twice");
  use(column);
  return column;
}

}  // namespace csrbf
