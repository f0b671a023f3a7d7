#pragma once

#include "common.hpp"

namespace csrbf::app {

/// A part of the report as a table, one row for each entry; empty when there is none. Lists of records become tables of
/// their own below it, long lists of numbers are replaced by their length.
std::string value_table(const Json& part);

/// Every option with the value used, why it was chosen, and its meaning.
std::string option_table(const Json& report, const std::vector<FlagUse>& flags);

/// "0.42 s", "12 s", "3:05 min".
std::string seconds_text(double seconds);

/// Times of the stages and the peak memory.
std::string time_table(const Json& report);

}  // namespace csrbf::app
