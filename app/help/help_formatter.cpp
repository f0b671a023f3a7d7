#include "help/usage.hpp"

#include "csrbf/io/files/text.hpp"

#include <CLI/CLI.hpp>

#include <utility>

namespace csrbf::app {
namespace {

constexpr std::size_t name_width = 28;                // columns: most flags with their values fit
constexpr std::size_t text_width = 100 - name_width;  // a common width of terminals

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() {
    column_width(name_width);
    label("Positionals", "Arguments");
  }

 private:
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    std::string name = CLI::Formatter::make_option_name(option, is_positional);
    const std::size_t value = name.find("{false}");
    return name.substr(0, value);
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    // The checks are left out: the description states what matters of them.
    const std::string form = value_form(*option);
    return form.empty() ? "" : " " + form;
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    std::string text = option->get_description();
    if (!option->get_default_str().empty()) text += " (default: " + option->get_default_str() + ")";
    std::string wrapped;
    std::size_t column = 0;
    std::string_view rest = text;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      const bool breaks = column > 0 && column + 1 + word.size() > text_width;
      if (column > 0) wrapped += breaks ? '\n' : ' ';
      column = breaks ? word.size() : column + (column > 0 ? 1 : 0) + word.size();
      wrapped += word;
    }
    return wrapped;
  }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string text = make_description(app) + make_usage(app, std::move(name)) + make_positionals(app);
    for (const std::string& group : app->get_groups()) {
      const auto members = app->get_options([&](const CLI::Option* option) {
        return option->get_group() == group && option->nonpositional() && !group.empty();
      });
      if (!members.empty()) text += make_group(group, false, members);
    }
    return text + make_subcommands(app, mode) + "\n" + make_footer(app);
  }

  std::string make_usage(const CLI::App* app, std::string name) const override {
    std::string usage = "\nUsage: " + (name.empty() ? app->get_name() : name);
    for (const CLI::Option* option : app->get_options())
      if (option->get_positional()) usage += " " + option->get_name(true);
    if (app->get_option_no_throw("--output") != nullptr) usage += " -o FILE";
    return usage + (app->get_subcommands({}).empty() ? " [FLAGS]\n" : " COMMAND ...\n");
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_formatter() {
  return std::make_shared<HelpFormatter>();
}

}  // namespace csrbf::app
