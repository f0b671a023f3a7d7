#pragma once

#include "csrbf/core/types.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// A cell that is not a number.
struct TextCell {
  Index column = 0;  ///< from 0
  Index line = 0;    ///< of the text
  std::string text;
};

/// What happens to cells that are not numbers: an error, or they become NaN and the table lists them.
enum class TextCells { refuse, note };

/// Rows of numbers, read from text.
struct Table {
  std::vector<std::string> names;    ///< column names, or none
  bool names_from_comment = false;   ///< the names were in a comment line right before the first row
  Eigen::MatrixXd values;            ///< columns x rows: one matrix column per line of the text
  Index first_line = 0;              ///< line number of the first row, for messages
  char separator = ' ';              ///< between cells; ' ': any blanks and tabs
  std::vector<TextCell> text_cells;  ///< the first of each column that has any (TextCells::note)
};

/// Reads lines of numbers separated by blanks, tabs, commas or semicolons (the first row decides), each of which may
/// be in double quotes; separators in quotes are text (names of columns), doubled quotes are quotes. # and //
/// outside of quotes begin comments. A first line without any number names the columns. One single number on the first
/// line, before longer rows, is the number of rows (.pts) and must be right. Where names and first row have as many
/// cells between single tabs, these may hold blanks, or nothing but at the ends of a row. With TextCells::note, cells
/// that are empty, NA or null are NaN. Throws IoError "name:line: ..." for ragged rows, cells that are not numbers
/// (decimal commas are recognised), UTF-16, binary data and text without rows. Line ends are those of Unix, Windows or
/// old Macs.
Table parse_table(std::string_view text, const std::string& name, TextCells text_cells = TextCells::refuse);

/// Rows of numbers as text: values is columns x rows. `head` comes before the first name.
std::string format_table(const std::vector<std::string>& names, const Eigen::Ref<const Eigen::MatrixXd>& values,
                         char separator, std::string_view head = "");

}  // namespace csrbf
