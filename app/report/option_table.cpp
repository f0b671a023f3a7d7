#include "report/option_table.hpp"

#include "report/html.hpp"
#include "report/option_reasons.hpp"
#include "report/value_table.hpp"
#include "session.hpp"

#include <algorithm>

namespace csrbf::app {
namespace {

const FlagUse* flag_of(const std::string& option, const std::vector<FlagUse>& flags) {
  std::string name = option;
  std::replace(name.begin(), name.end(), '_', '-');
  const auto found = std::find_if(flags.begin(), flags.end(), [&](const FlagUse& flag) { return flag.name == name; });
  return found == flags.end() ? nullptr : &*found;
}

}  // namespace

std::string option_table(const Json& report, const std::vector<FlagUse>& flags) {
  std::string rows;
  for (const auto& [option, value] : report["options"].items()) {
    const FlagUse* flag = flag_of(option, flags);
    const bool given = flag != nullptr && flag->given;
    const std::string reason = given ? "" : option_reason(report, option);
    const std::string why = given ? "given" : reason.empty() ? "default" : "chosen: " + reason;
    const char* kind = given ? "given" : reason.empty() ? "default" : "chosen";
    const std::string meaning = flag != nullptr ? flag->what : option_meaning(report["command"], option);
    rows += "<tr class=\"" + std::string(kind) + "\"><th scope=\"row\">" + escaped(words(option)) + "</th><td>" +
            value_text(value) + "</td><td>" + escaped(why) + "</td><td class=\"meaning\"><span title=\"" +
            escaped(meaning) + "\">" + escaped(meaning) + "</span></td></tr>\n";
  }
  if (rows.empty()) return "";
  return "<div class=\"scroll\"><table class=\"options\">\n<thead><tr><th scope=\"col\">Option</th><th "
         "scope=\"col\">Value "
         "used</th><th scope=\"col\">Why</th><th scope=\"col\">What it means</th></tr></thead>\n<tbody>\n" +
         rows + "</tbody></table></div>\n";
}

}  // namespace csrbf::app
