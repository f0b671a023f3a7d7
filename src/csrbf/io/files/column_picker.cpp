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

// As 2024-03-01, with or without a time.
bool is_date(std::string_view text) {
  constexpr std::string_view form = "dddd-dd-dd";
  bool fits = text.size() >= form.size();
  for (std::size_t i = 0; fits && i < form.size(); ++i)
    fits = form[i] == 'd' ? text[i] >= '0' && text[i] <= '9' : text[i] == form[i];
  return fits;
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
  return remedy.empty() ? "" : "; " + remedy;
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
  const auto key = [](const std::string& name) { return lower_case(single_word(name)); };
  std::vector<Index> similar;
  for (Index i = 0; i < std::ssize(table_.names); ++i) {
    const std::string& name = table_.names[static_cast<std::size_t>(i)];
    if (name == word) return i;
    if (key(name) == key(word)) similar.push_back(i);
  }
  return similar.size() == 1 ? std::optional(similar.front()) : std::nullopt;
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
  Index column = 0;
  if (found != table_.names.end())
    column = found - table_.names.begin();
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
