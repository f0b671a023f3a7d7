#include "help/usage.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>

namespace csrbf::app {
namespace {

// The alternatives auto|none|L are words where they are in lower case, and a placeholder where they are not.
std::vector<std::string> literal_words(const std::string& form) {
  std::vector<std::string> words;
  std::istringstream alternatives(form);
  for (std::string word; std::getline(alternatives, word, '|');)
    if (std::islower(static_cast<unsigned char>(word.front())) != 0) words.push_back(word.substr(0, word.find(':')));
  return words;
}

// The words that CLI::IsMember allows; it appends them to the form as NAME:{first,second}.
std::vector<std::string> allowed_words(const std::string& checks) {
  std::vector<std::string> words;
  const std::size_t begin = checks.find('{'), end = checks.find('}');
  if (begin == std::string::npos || end == std::string::npos) return words;
  std::istringstream list(checks.substr(begin + 1, end - begin - 1));
  for (std::string word; std::getline(list, word, ',');) words.push_back(word);
  return words;
}

// CLI11 has no place for words that are not checked.
std::map<const CLI::Option*, std::vector<std::string>>& named_words() {
  static std::map<const CLI::Option*, std::vector<std::string>> words;
  return words;
}

// The bounds of CLI::Range, appended to the form as N:INT in [2 - 16].
void take_range(const std::string& checks, FlagUsage& flag) {
  const std::size_t begin = checks.find(" in ["), middle = checks.find(" - "), end = checks.find(']');
  if (begin == std::string::npos || middle == std::string::npos || end == std::string::npos) return;
  constexpr std::size_t before = 5, between = 3;
  flag.lowest = checks.substr(begin + before, middle - begin - before);
  flag.highest = checks.substr(middle + between, end - middle - between);
}

FlagUsage flag_usage(const CLI::Option& option) {
  FlagUsage flag{.value = value_form(option),
                 .what = option.get_description(),
                 .shown_default = option.get_default_str(),
                 .required = option.get_required()};
  for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
  flag.words = literal_words(flag.value);
  flag.common = option.get_group() == common_group;
  const std::string checks = option.get_expected_max() > 0 ? option.get_type_name() : "";
  const std::vector<std::string> allowed = allowed_words(checks);
  flag.only_words = !allowed.empty();
  if (flag.words.empty()) flag.words = allowed;
  if (const auto named = named_words().find(&option); named != named_words().end()) flag.words = named->second;
  take_range(checks, flag);
  return flag;
}

std::string last_line(const std::string& text) {
  const std::size_t start = text.find_first_not_of(' ', text.rfind('\n') + 1);
  return start == std::string::npos ? "" : text.substr(start);
}

}  // namespace

void name_words(const CLI::Option& option, std::vector<std::string> words) {
  named_words()[&option] = std::move(words);
}

std::string value_form(const CLI::Option& option) {
  const bool takes_value = option.get_expected_max() > 0 && !option.get_positional();
  if (!takes_value) return "";
  // CLI11 appends the descriptions of CLI::IsMember and CLI::Range; a form may have colons of its own.
  const std::string type = option.get_type_name();
  std::size_t end = type.find(":{");
  if (const std::size_t range = type.find(" in ["); range != std::string::npos)
    end = std::min(end, type.rfind(':', range));
  return type.substr(0, end);
}

Usage usage_of(const CLI::App& app) {
  Usage usage{.name = app.get_name(), .what = app.get_description(), .example = last_line(app.get_footer())};
  for (const CLI::Option* option : app.get_options())
    if (option->get_positional()) usage.arguments.push_back({option->get_name(true), option->get_description()});
  for (const std::string& group : app.get_groups())
    for (const CLI::Option* option : app.get_options())
      if (!group.empty() && option->get_group() == group && option->nonpositional())
        usage.flags.push_back(flag_usage(*option));
  for (const CLI::App* subcommand : app.get_subcommands([](const CLI::App*) { return true; }))
    usage.subcommands.push_back(usage_of(*subcommand));
  return usage;
}

}  // namespace csrbf::app
