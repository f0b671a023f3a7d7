#pragma once

#include "csrbf/core/types.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace csrbf {

/// Rows of numbers from a text.
struct Table {
  std::vector<std::string> names;   ///< column names, or none
  bool names_from_comment = false;  ///< the names stood in a comment line right before the first row
  Eigen::MatrixXd values;           ///< columns x rows: one matrix column per line of the text
  Index first_line = 0;             ///< line number of the first row, for messages
};

/// Reads lines of numbers separated by blanks, tabs, commas or semicolons (the first row decides); # and // begin
/// comments. A first line without any number names the columns. One single number on the first line, before longer
/// rows, is the number of rows (.pts) and must be right. Throws IoError "name:line: ..." for ragged rows, cells that
/// are no numbers and a text without rows.
Table parse_table(std::string_view text, const std::string& name);

}  // namespace csrbf
