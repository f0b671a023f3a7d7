#pragma once

#include <charconv>

namespace csrbf {

/// std::from_chars for floating-point numbers, which libc++ has since version 20: reads the longest number at `begin`,
/// without sign '+' and blanks before it; 'inf' and 'nan' are numbers. What is too large for a double
/// (result_out_of_range) becomes infinite, what is too small 0.
std::from_chars_result read_number(const char* begin, const char* end, double& value);

/// std::to_chars for floating-point numbers, which libc++ has since version 14: the shortest text that reads back as
/// the same value, or `digits` significant ones as printf's %g gives them. 32 characters are always enough.
char* write_number(char* begin, char* end, double value);
char* write_number(char* begin, char* end, double value, int digits);

}  // namespace csrbf
