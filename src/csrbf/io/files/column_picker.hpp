#pragma once

#include "csrbf/io/files/table.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// Words in quotes, with commas between them: for messages.
std::string listed(const std::vector<std::string>& words);

/// Finds columns of a table, each of which is used once. Throws IoError that begins with `name`, that of the file.
class ColumnPicker {
 public:
  ColumnPicker(const Table& table, std::string name)
      : table_(table), name_(std::move(name)), used_(static_cast<std::size_t>(table.values.rows()), false) {}

  /// The columns of a list of names, see find_similar(), and numbers from 1 on, separated by commas, which count as
  /// used from now on.
  std::vector<Index> take(std::string_view list);

  /// The same, but they do not count as used.
  [[nodiscard]] std::vector<Index> find(std::string_view list) const;

  /// The column of that name, or else the only one whose name differs in capitals, or in blanks for underscores; or
  /// else in a unit in brackets, as in x (m).
  [[nodiscard]] std::optional<Index> find_similar(const std::string& word) const;

  /// Those of the columns that are not used yet.
  std::vector<Index> take_free(const std::vector<Index>& wanted);

  /// All unused columns, or the last of them.
  std::vector<Index> take_rest();
  std::vector<Index> take_last();

  [[nodiscard]] std::vector<Index> all() const;

  /// Throws when one of the columns holds text; `remedy` ends the message, where the text does not tell a better one.
  void check_numbers(const std::vector<Index>& columns, const std::string& remedy) const;

 private:
  [[nodiscard]] Index size() const { return table_.values.rows(); }
  [[nodiscard]] bool used(Index column) const { return used_[static_cast<std::size_t>(column)]; }
  void use(Index column) { used_[static_cast<std::size_t>(column)] = true; }
  Index take_one(std::string_view word);

  const Table& table_;
  std::string name_;
  std::vector<bool> used_;
};

}  // namespace csrbf
