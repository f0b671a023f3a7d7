#include "csrbf/io/files/table.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/io/files/text.hpp"

#include <optional>

namespace csrbf {
namespace {

char separator_of(std::string_view line) {
  bool comma = false, quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ';' && !quoted) return ';';
    comma = comma || (c == ',' && !quoted);
  }
  return comma ? ',' : ' ';
}

// Where the comment of a line begins, at # or // outside of cells in double quotes; npos when it has none.
std::size_t find_comment(std::string_view line) {
  const std::size_t first = std::min(line.find('#'), line.find("//"));
  if (first == std::string_view::npos) return first;
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    if (!quoted && (line[i] == '#' || line.substr(i).starts_with("//"))) return i;
  }
  return quoted ? first : std::string_view::npos;  // a single quote is text
}

// Removes a cell in double quotes from the line, with the separator after it, and returns its content; nullopt when
// the next cell is not quoted. Quotes inside are doubled (RFC 4180).
std::optional<std::string_view> take_quoted(std::string_view& line, char separator) {
  constexpr std::string_view blanks = " \t";
  const std::size_t begin = line.find_first_not_of(blanks);
  if (begin == std::string_view::npos || line[begin] != '"') return std::nullopt;
  std::size_t end = line.find('"', begin + 1);
  while (end != std::string_view::npos && line.substr(end + 1).starts_with('"')) end = line.find('"', end + 2);
  if (end == std::string_view::npos) return std::nullopt;
  std::string_view behind = line.substr(end + 1);
  const bool blank = !behind.empty() && blanks.find(behind.front()) != std::string_view::npos;
  behind.remove_prefix(std::min(behind.find_first_not_of(blanks), behind.size()));
  const bool separated = separator == ' ' ? blank : behind.starts_with(separator);
  if (!behind.empty() && !separated) return std::nullopt;
  const std::string_view cell = trimmed(line.substr(begin + 1, end - begin - 1));
  line = behind.substr(!behind.empty() && separator != ' ' ? 1 : 0);
  return cell;
}

// Removes the next cell from the line; nullopt at its end. One separator at the end of a line is ignored.
std::optional<std::string_view> take_cell(std::string_view& line, char separator) {
  if (const auto cell = take_quoted(line, separator)) return cell;
  if (separator == ' ') {
    const std::string_view word = take_word(line);
    return word.empty() ? std::nullopt : std::optional(word);
  }
  if (line.empty()) return std::nullopt;
  const std::size_t end = std::min(line.find(separator), line.size());
  const std::string_view cell = trimmed(line.substr(0, end));
  line.remove_prefix(std::min(line.size(), end + 1));
  return cell;
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  while (const auto cell = take_cell(line, separator)) cells.push_back(*cell);
  return cells;
}

bool is_number(std::string_view cell) {
  return parse_number(cell).has_value();
}

// Whether cells are between single tabs: where names and the first row have as many of them, and no other blanks, or
// other numbers of words. Then cells may hold blanks, or nothing. `row`: with its first and last blanks.
bool has_tabs(std::string_view names, std::string_view row) {
  const auto count = [](std::string_view line, char separator) { return split(line, separator).size(); };
  const std::size_t cells = count(names, '\t'), found = count(row, '\t');
  const bool lacks_last = found + 1 == cells && row.ends_with('\t');
  if (cells < 2 || (cells != found && !lacks_last)) return false;
  const std::size_t words = count(names, ' ');
  return words != count(row, ' ') || words == cells;
}

bool is_missing(std::string_view cell) {
  return cell.empty() || cell == "NA" || cell == "null" || cell == "NULL";
}

std::vector<std::string> unquoted(const std::vector<std::string_view>& cells) {
  std::vector<std::string> names;
  for (std::string_view cell : cells) {
    if (cell.size() >= 2 && cell.front() == '\'' && cell.back() == '\'') cell = cell.substr(1, cell.size() - 2);
    std::string& name = names.emplace_back(cell);
    for (std::size_t i = 0; (i = name.find("\"\"", i)) != std::string::npos; ++i) name.erase(i, 1);
  }
  return names;
}

// "0,5" as 0.5.
std::optional<double> number_with_comma(std::string_view cell) {
  const std::size_t comma = cell.find(',');
  if (comma == std::string_view::npos || comma + 1 == cell.size()) return std::nullopt;
  std::string number(cell);
  number[comma] = '.';
  return parse_number(number);
}

// Does the line hold several numbers, some with decimal commas, between semicolons or blanks?
bool has_decimal_commas(std::string_view line) {
  const char separator = line.find(';') != std::string_view::npos ? ';' : ' ';
  bool any = false;
  int cells = 0;
  for (; const auto cell = take_cell(line, separator); ++cells) {
    const bool comma = number_with_comma(*cell).has_value();
    if (!comma && (!is_number(*cell) || cell->ends_with('.'))) return false;
    any = any || comma;
  }
  return any && cells > 1;
}

// May the comma of a number separate thousands, as in 1,250?
bool may_be_thousands(std::string_view cell) {
  constexpr std::size_t group = 3;
  const std::size_t digits = cell.find(',') - (cell.starts_with('-') || cell.starts_with('+') ? 1 : 0);
  const char first = cell[cell.find(',') - digits];
  return digits > 0 && digits <= group && first != '0' && cell.size() == cell.find(',') + 1 + group &&
         cell.find_first_not_of("0123456789", cell.find(',') + 1) == std::string_view::npos;
}

// The code below expects lines to end in '\n'; on old Macs '\r' alone did.
bool has_old_line_ends(std::string_view text) {
  return text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos;
}

// With or without a byte order mark: characters in tables take one byte and a zero.
bool is_utf16(std::string_view text) {
  return text.size() >= 2 &&
         (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") || text[0] == '\0' || text[1] == '\0');
}

// Among the first bytes, where text has only blanks and line ends for control characters.
bool is_binary(std::string_view text) {
  constexpr std::size_t head = 1000;  // bytes
  const auto is_control = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < '\t' || (byte > '\r' && byte < ' ' && byte != '\x1a');  // which ended files of DOS
  };
  const std::string_view beginning = text.substr(0, head);
  return std::any_of(beginning.begin(), beginning.end(), is_control);
}

// A line of a text up to a comment with the blanks around it.
std::string_view with_blanks(std::string_view line, std::string_view text, std::size_t comment) {
  const char *begin = line.data(), *end = begin + std::min(line.size(), comment);
  while (begin > text.data() && begin[-1] != '\n') --begin;
  if (comment == std::string_view::npos)
    while (end < text.data() + text.size() && *end != '\n' && *end != '\r') ++end;
  return {begin, static_cast<std::size_t>(end - begin)};
}

class TableParser {
 public:
  TableParser(std::string_view text, const std::string& name, TextCells text_cells)
      : text_(text), reader_(text, name), text_cells_(text_cells) {}

  Table parse() {
    read_head();
    do {
      read_row();
    } while (next_line());
    const Index rows = columns_ > 0 ? static_cast<Index>(values_.size()) / columns_ : 0;
    if (promised_rows_ && *promised_rows_ != rows)
      throw IoError(reader_.name() + ": the first line promises " + std::to_string(*promised_rows_) + " rows, found " +
                    std::to_string(rows));
    table_.values = Eigen::Map<const Eigen::MatrixXd>(values_.data(), columns_, rows);
    return std::move(table_);
  }

 private:
  // Moves to the next line with more than a comment; keeps the last whole-line comment.
  bool next_line() {
    while (reader_.next()) {
      line_ = reader_.line();
      const std::size_t mark = find_comment(line_);
      if (mark == 0) comment_ = trimmed(line_.substr(line_[0] == '#' ? 1 : 2));
      untrimmed_ = with_blanks(line_, text_, mark);
      line_ = trimmed(line_.substr(0, mark));
      if (line_.empty()) continue;
      if (separator_ == '\t') line_ = untrimmed_;  // whose first and last cells may be empty
      return true;
    }
    return false;
  }

  // Row count, column names and the shape of the first row.
  void read_head() {
    if (!next_line()) throw IoError(reader_.name() + ": the file holds no rows of numbers");
    separator_ = separator_of(line_);
    std::vector<std::string_view> cells = split(line_, separator_);
    if (const auto count = parse_integer(line_); cells.size() == 1 && count && *count >= 0) {
      const LineReader before = reader_;
      if (next_line() && split(line_, separator_of(line_)).size() > 1) {
        promised_rows_ = *count;
        separator_ = separator_of(line_);
        cells = split(line_, separator_);
      } else {
        reader_ = before;
        line_ = reader_.line();
      }
    }
    if (separator_ == ';') find_decimal_commas();
    if (std::none_of(cells.begin(), cells.end(), is_number) && !is_row_with_commas(cells)) {
      refuse_decimal_commas();
      const std::string names(line_);
      table_.names = unquoted(cells);
      if (!next_line()) throw IoError(reader_.name() + ": the file holds column names but no rows of numbers");
      if (separator_ == ' ') separator_ = separator_of(line_);
      if (separator_ == ' ' && has_tabs(names, untrimmed_)) {
        separator_ = '\t';
        line_ = untrimmed_;
        table_.names = unquoted(split(names, separator_));
      }
      cells = split(line_, separator_);
      if (cells.size() + 1 == table_.names.size() && last_cell_is_empty()) cells.emplace_back();
      if (cells.size() != table_.names.size()) {
        refuse_decimal_commas();
        reader_.fail("expected " + std::to_string(table_.names.size()) + " columns as named, found " +
                     std::to_string(cells.size()));
      }
    } else {
      take_names_from_comment(cells.size());
    }
    columns_ = static_cast<Index>(cells.size());
    table_.first_line = reader_.line_number();
    table_.separator = separator_;
    values_.reserve(cells.size() * (1 + text_.size() / (reader_.line().size() + 1)));
  }

  void take_names_from_comment(std::size_t columns) {
    const std::vector<std::string_view> cells = split(comment_, separator_of(comment_));
    if (cells.size() != columns || std::any_of(cells.begin(), cells.end(), is_number)) return;
    table_.names = unquoted(cells);
    table_.names_from_comment = true;
  }

  void read_row() {
    std::string_view rest = line_;
    Index found = 0;
    while (const auto cell = take_cell(rest, separator_)) {
      if (++found > columns_) continue;
      const std::optional<double> value = number(*cell, found - 1);
      values_.push_back(value ? *value : not_a_number(*cell, found - 1));
    }
    if (found + 1 == columns_ && last_cell_is_empty()) {
      values_.push_back(not_a_number("", found));
      ++found;
    }
    if (found != columns_) {
      refuse_decimal_commas();
      reader_.fail("expected " + std::to_string(columns_) + " columns as in line " + std::to_string(table_.first_line) +
                   ", found " + std::to_string(found));
    }
  }

  std::optional<double> number(std::string_view cell, Index column) const {
    const std::optional<double> value = parse_number(cell);
    const bool commas = static_cast<std::size_t>(column) < decimal_commas_.size() && decimal_commas_[column];
    return value || !commas ? value : number_with_comma(cell);
  }

  // The columns, between semicolons, whose numbers have decimal commas: where no number of the table has a point, and
  // commas of the column, or of others if none of its numbers is without one, cannot separate thousands.
  void find_decimal_commas() {
    struct Count {
      Index bare = 0, commas = 0, decimal = 0;
    };
    std::vector<Count> columns;
    bool has_points = false, has_decimal = false;
    LineReader lines(text_, reader_.name());
    while (lines.next() && !has_points) {
      std::string_view rest = trimmed(lines.line().substr(0, find_comment(lines.line())));
      for (std::size_t c = 0; const auto cell = take_cell(rest, separator_); ++c) {
        columns.resize(std::max(columns.size(), c + 1));
        if (is_number(*cell)) {
          has_points = has_points || cell->find('.') != std::string_view::npos;
          ++columns[c].bare;
        } else if (number_with_comma(*cell)) {
          ++columns[c].commas;
          columns[c].decimal += may_be_thousands(*cell) ? 0 : 1;
          has_decimal = has_decimal || !may_be_thousands(*cell);
        }
      }
    }
    if (has_points || !has_decimal) return;
    for (const Count& count : columns)
      decimal_commas_.push_back(count.decimal > 0 || (count.commas > 0 && count.bare == 0));
  }

  // Not names, of which one may look like a number.
  [[nodiscard]] bool is_row_with_commas(const std::vector<std::string_view>& cells) const {
    Index count = 0;
    for (std::size_t c = 0; c < std::min(cells.size(), decimal_commas_.size()); ++c)
      count += decimal_commas_[c] && number_with_comma(cells[c]) ? 1 : 0;
    return 2 * count > std::ssize(cells);
  }

  // A separator at the end of the line may also precede an empty cell: when one cell is missing.
  [[nodiscard]] bool last_cell_is_empty() const {
    return text_cells_ == TextCells::note && separator_ != ' ' && line_.ends_with(separator_);
  }

  void refuse_decimal_commas() const {
    if (has_decimal_commas(line_))
      reader_.fail(in_quotes(line_) + " has decimal commas; write numbers with a point, as 0.5");
  }

  double not_a_number(std::string_view cell, Index column) {
    if (text_cells_ == TextCells::refuse) {
      refuse_decimal_commas();
      if (cell.empty()) reader_.fail("cell " + std::to_string(column + 1) + " is empty");
      reader_.fail(in_quotes(cell) + " is not a number");
    }
    holds_text_.resize(columns_);
    if (!is_missing(cell) && !holds_text_[column]) {
      refuse_decimal_commas();
      holds_text_[column] = true;
      table_.text_cells.push_back({column, reader_.line_number(), std::string(cell)});
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

  std::string_view text_;
  LineReader reader_;
  TextCells text_cells_;
  std::string_view line_, untrimmed_, comment_;
  char separator_ = ' ';
  Index columns_ = 0;
  std::optional<std::int64_t> promised_rows_;
  std::vector<double> values_;
  std::vector<bool> holds_text_;      // columns with a text cell
  std::vector<bool> decimal_commas_;  // columns whose numbers have them
  Table table_;
};

}  // namespace

Table parse_table(std::string_view text, const std::string& name, TextCells text_cells) {
  if (is_utf16(text)) throw IoError(name + ": the text is UTF-16; save it as UTF-8");
  if (is_binary(text)) throw IoError(name + ": the file is binary, not text with rows of numbers");
  if (!has_old_line_ends(text)) return TableParser(text, name, text_cells).parse();
  std::string lines(text);
  std::replace(lines.begin(), lines.end(), '\r', '\n');
  return TableParser(lines, name, text_cells).parse();
}

namespace {

// As the head of a column: a word between blanks; between commas as it is, in quotes where it needs them.
std::string column_head(const std::string& name, char separator) {
  const bool is_plain = name.find_first_of(",;#\"\n\r\t") == std::string::npos && name.find("//") == std::string::npos;
  if (separator != ',' || trimmed(name).empty()) return single_word(name);
  if (is_plain) return name;
  std::string quoted = "\"";
  for (const char c : name) {
    if (c == '"') quoted += c;
    quoted += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return quoted + '"';
}

}  // namespace

std::string format_table(const std::vector<std::string>& names, const Eigen::Ref<const Eigen::MatrixXd>& values,
                         char separator, std::string_view head) {
  std::string out(names.empty() ? "" : head);
  for (const std::string& name : names) out.append(column_head(name, separator)) += separator;
  if (!names.empty()) out.back() = '\n';
  InterruptionPoint pause(1U << 12);
  for (Index row = 0; row < values.cols(); ++row) {
    pause();
    for (Index column = 0; column < values.rows(); ++column) {
      append_number(out, values(column, row));
      out += separator;
    }
    out.back() = '\n';
  }
  return out;
}

}  // namespace csrbf
