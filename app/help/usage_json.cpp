#include "help/usage.hpp"

#include <nlohmann/json.hpp>

namespace csrbf::app {
namespace {

using Json = nlohmann::ordered_json;

Json described(const FlagUsage& flag) {
  return {{"name", flag.names.back()}, {"value", flag.value},
          {"words", flag.words},       {"onlyWords", flag.only_words},
          {"lowest", flag.lowest},     {"highest", flag.highest},
          {"common", flag.common},     {"required", flag.required},
          {"what", flag.what},         {"shownDefault", flag.shown_default}};
}

Json described(const Usage& command) {
  Json arguments = Json::array(), flags = Json::array();
  for (const ArgumentUsage& argument : command.arguments)
    arguments.push_back({{"name", argument.name}, {"what", argument.what}});
  for (const FlagUsage& flag : command.flags) flags.push_back(described(flag));
  return {{"name", command.name},
          {"what", command.what},
          {"example", command.example},
          {"arguments", arguments},
          {"flags", flags}};
}

}  // namespace

std::string usage_json(const Usage& program) {
  Json commands = Json::array();
  for (const Usage& command : program.subcommands) commands.push_back(described(command));
  return commands.dump() + "\n";
}

}  // namespace csrbf::app
