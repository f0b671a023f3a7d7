#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace csrbf::app {

/// A part of the report as a table, one row for each entry; empty when there is none. Lists of records become tables of
/// their own below it, long lists of numbers are replaced by their length.
std::string value_table(const nlohmann::ordered_json& part);

/// One value as HTML.
std::string value_text(const nlohmann::ordered_json& value);

/// A key in words: rms_distance becomes "rms distance".
std::string words(std::string key);

/// "0.42 s", "12 s", "3:05 min".
std::string seconds_text(double seconds);

/// Times of the stages and the peak memory.
std::string time_table(const nlohmann::ordered_json& report);

}  // namespace csrbf::app
