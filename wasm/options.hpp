#pragma once

#include "csrbf/core/error.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <type_traits>

namespace csrbf::wasm {

/// Options that JavaScript gives: an object, of which every member must be known.
class Options {
 public:
  /// From its JSON text; `function` is for messages.
  Options(const char* text, std::string function)
      : given_(nlohmann::json::parse(text)), function_(std::move(function)) {}

  /// Sets `field` to the member of that name, if there is one. null stands for `unset` where the field has that.
  template <class Value>
  void read(const char* name, Value& field) {
    if (const nlohmann::json* value = find(name)) convert(name, *value, field);
  }
  template <class Value>
  void read(const char* name, std::optional<Value>& field) {
    const nlohmann::json* value = find(name);
    if (value == nullptr) return;
    if (value->is_null() || *value == "auto") return field.reset();
    Value known{};
    convert(name, *value, known);
    field = known;
  }
  /// A word that `parse` turns into a value.
  template <class Value, class Parse>
  void read(const char* name, Value& field, const Parse& parse) {
    std::string word;
    const nlohmann::json* value = find(name);
    if (value == nullptr) return;
    convert(name, *value, word);
    field = parse(word);
  }

  /// A number, "auto" (unset) or "none" (0).
  void read_smoothing(std::optional<double>& field) {
    const nlohmann::json* value = find("smoothing");
    if (value != nullptr && *value == "none")
      field = 0;
    else
      read("smoothing", field);
  }

  [[noreturn]] void refuse(const char* name, const std::string& why) const {
    throw InvalidInput(function_ + ": " + name + " = " + given_.at(name).dump() + ": " + why);
  }

  /// Throws InvalidInput for a member that nobody read.
  void expect_all_known() const {
    for (const auto& [name, value] : given_.items()) {
      if (known_.contains(name)) continue;
      std::string names;
      for (const std::string& known : known_) names += (names.empty() ? "" : ", ") + known;
      throw InvalidInput(function_ + ": " + name + ": there is no such option; there are " + names);
    }
  }

 private:
  const nlohmann::json* find(const char* name) {
    known_.insert(name);
    const auto found = given_.find(name);
    return found == given_.end() ? nullptr : &*found;
  }
  template <class Value>
  void convert(const char* name, const nlohmann::json& value, Value& field) const {
    constexpr bool is_number = std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>;
    if (is_number && !value.is_number()) refuse(name, "must be a number");
    if (std::is_integral_v<Value> && is_number && value.get<double>() != std::floor(value.get<double>()))
      refuse(name, "must be a whole number");
    if (std::is_same_v<Value, bool> && !value.is_boolean()) refuse(name, "must be true or false");
    try {
      if constexpr (std::is_integral_v<Value> && is_number)
        field = static_cast<Value>(std::clamp(value.get<double>(), -2147483648.0, 2147483647.0));
      else
        field = value.get<Value>();
    } catch (const nlohmann::json::exception&) {
      refuse(name, "is of the wrong type");
    }
  }

  nlohmann::json given_;
  std::string function_;
  std::set<std::string> known_;
};

}  // namespace csrbf::wasm
