#include "help/usage.hpp"

#include <string_view>

namespace csrbf::app {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::string with_backslashes(std::string_view text, std::string_view special) {
  std::string escaped;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::vector<std::string> names_of(const std::vector<FlagUsage>& flags) {
  std::vector<std::string> names;
  for (const FlagUsage& flag : flags) names.insert(names.end(), flag.names.begin(), flag.names.end());
  return names;
}

// Bash: candidates are looked up by the command and the previous word. Without a match, readline completes file names.

std::string bash_command(const Usage& subcommand) {
  std::string script;
  for (const FlagUsage& flag : subcommand.flags)
    for (const std::string& name : flag.names)
      if (!flag.words.empty())
        script += "    '" + subcommand.name + " " + name + "') words='" + joined(flag.words) + "' ;;\n";
  return script + "    '" + subcommand.name + " '*) [[ $current != -* ]] || words='" +
         joined(names_of(subcommand.flags)) + "' ;;\n";
}

std::string bash(const Usage& program) {
  std::string first;
  for (const Usage& subcommand : program.subcommands) first += subcommand.name + " ";
  std::string script = R"(# bash completion for csrbf
_csrbf() {
  local current=${COMP_WORDS[COMP_CWORD]} command= words=
  ((COMP_CWORD == 1)) || command=${COMP_WORDS[1]}
  case "$command ${COMP_WORDS[COMP_CWORD - 1]}" in
)";
  script += "    ' '*) words='" + first + joined(names_of(program.flags)) + "' ;;\n";
  for (const Usage& subcommand : program.subcommands) script += bash_command(subcommand);
  return script + R"(  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}
complete -o default -F _csrbf csrbf
)";
}

// Zsh: one specification for _arguments per name of a flag and per argument.

std::string zsh_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string zsh_text(const std::string& text) {
  return with_backslashes(text, "\\:[]");
}

std::string zsh_flags(const std::vector<FlagUsage>& flags) {
  std::string script;
  for (const FlagUsage& flag : flags) {
    std::string value;
    if (!flag.value.empty())
      value = ":" + zsh_text(flag.value) + ":" + (flag.takes_file() ? "_files" : "(" + joined(flag.words) + ")");
    for (const std::string& name : flag.names)
      script +=
          " \\\n        " + zsh_quoted("(" + joined(flag.names) + ")" + name + "[" + zsh_text(flag.what) + "]" + value);
  }
  return script;
}

std::string zsh_command(const Usage& subcommand) {
  std::string script = "    " + subcommand.name + ")\n      _arguments" + zsh_flags(subcommand.flags);
  for (const ArgumentUsage& argument : subcommand.arguments)
    script += " \\\n        " + zsh_quoted(":" + zsh_text(argument.name) + ":_files");
  return script + "\n      ;;\n";
}

std::string zsh(const Usage& program) {
  std::string script = R"(#compdef csrbf
_csrbf() {
  local -a commands=(
)";
  for (const Usage& subcommand : program.subcommands)
    script += "    " + zsh_quoted(with_backslashes(subcommand.name, "\\:") + ":" + subcommand.what) + "\n";
  script += R"(  )
  if ((CURRENT == 2)); then
    _arguments)" +
            zsh_flags(program.flags) + R"( \
        ':command:{_describe command commands}'
    return
  fi
  # The command is the command from here on.
  shift words
  ((CURRENT--))
  case $words[1] in
)";
  for (const Usage& subcommand : program.subcommands) script += zsh_command(subcommand);
  return script + R"(  esac
}
_csrbf "$@"
)";
}

// Fish: one `complete` per flag, under the condition that its command was typed.

std::string fish_quoted(const std::string& text) {
  return "'" + with_backslashes(text, "\\'") + "'";
}

std::string fish_flags(const std::vector<FlagUsage>& flags, const std::string& condition) {
  std::string script;
  for (const FlagUsage& flag : flags) {
    script += "complete -c csrbf -n " + fish_quoted(condition);
    for (const std::string& name : flag.names)
      script += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!flag.value.empty()) script += flag.takes_file() ? " -r" : " -x";
    if (!flag.words.empty()) script += " -a " + fish_quoted(joined(flag.words));
    script += " -d " + fish_quoted(flag.what) + "\n";
  }
  return script;
}

std::string fish(const Usage& program) {
  std::string script = "# fish completion for csrbf\n";
  for (const Usage& subcommand : program.subcommands)
    script += "complete -c csrbf -n __fish_use_subcommand -f -a " + subcommand.name + " -d " +
              fish_quoted(subcommand.what) + "\n";
  script += fish_flags(program.flags, "__fish_use_subcommand");
  for (const Usage& subcommand : program.subcommands)
    script += fish_flags(subcommand.flags, "__fish_seen_subcommand_from " + subcommand.name);
  return script;
}

}  // namespace

std::string completion(const Usage& program, const std::string& shell) {
  return shell == "bash" ? bash(program) : shell == "zsh" ? zsh(program) : fish(program);
}

}  // namespace csrbf::app
