// SPDX-License-Identifier: Apache-2.0
#include "core/cli/completion.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tessera::cli {
namespace {

// "tessera-worker" as part of a shell function's name.
std::string function_name(const std::string& program) {
  std::string name = "_" + program;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

// In single quotes, for every shell: '\'' stands for a quote.
std::string quoted(const std::string& text) {
  std::string shell = "'";
  for (const char c : text) shell += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return shell + "'";
}

// The first sentence or line of a description, without what it says of defaults.
std::string summary_of(const std::string& description) {
  std::string summary = description.substr(0, description.find(" [default"));
  summary = summary.substr(0, summary.find_first_of(";\n"));
  return summary;
}

std::vector<OptionRow> all_options(const CommandTable& table) {
  std::vector<OptionRow> options;
  for (const OptionGroup& group : table.groups)
    options.insert(options.end(), group.options.begin(), group.options.end());
  return options;
}

// "-o|--output" as a pattern of bash's case.
std::string pattern_of(const OptionRow& option) {
  return (option.short_name.empty() ? "" : option.short_name + "|") + option.name;
}

// What bash does after an option with a value.
std::string bash_values(const CommandTable& table, const std::string& indent) {
  std::string cases, others;
  for (const OptionRow& option : all_options(table)) {
    // What follows an option with an optional value may be an argument.
    if (option.value.empty() || is_path(option.value) || is_optional(option.value)) continue;
    const auto words = choices_of(option.value);
    if (words.empty())
      others += (others.empty() ? "" : "|") + pattern_of(option);
    else
      cases += fmt::format("{}{}) _tessera_words \"{}\"; return ;;\n", indent, pattern_of(option),
                           fmt::join(words, " "));
  }
  if (!others.empty()) cases += fmt::format("{}{}) compopt +o default; return ;;\n", indent, others);
  return cases;
}

std::string bash_words(const CommandTable& table) {
  std::string words;
  for (const OptionRow& option : all_options(table)) words += (words.empty() ? "" : " ") + option.name;
  return words;
}

// The body for one command, or for a program without commands.
std::string bash_command(const CommandTable& table, const std::string& indent) {
  const std::string values = bash_values(table, indent + "  ");
  std::string body;
  if (!values.empty()) body += indent + "case $prev in\n" + values + indent + "esac\n";
  return body +
         fmt::format("{0}[[ $cur == -* ]] && _tessera_words \"{1}\"\n{0}return\n", indent, bash_words(table));
}

std::string names_of(const std::vector<CommandTable>& commands) {
  std::string names;
  for (const CommandTable& command : commands) names += (names.empty() ? "" : " ") + command.name;
  return names;
}

// A description inside [...] of zsh's _arguments.
std::string zsh_text(const std::string& text) {
  std::string shown;
  for (const char c : summary_of(text)) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') shown += '\\';
    shown += c;
  }
  return shown;
}

// A second colon marks what may be left out.
std::string zsh_value(const std::string& value) {
  const auto words = choices_of(value);
  if (!words.empty()) return fmt::format(":value:({})", fmt::join(words, " "));
  std::string name = value;
  std::replace(name.begin(), name.end(), ':', ' ');
  return fmt::format("{}:{}:{}", is_optional(value) ? ":" : "", name, is_path(value) ? "_files" : " ");
}

std::string zsh_arguments(const CommandTable& table, const std::string& indent) {
  std::string lines = indent + "_arguments";
  const auto add = [&](const std::string& spec) { lines += " \\\n" + indent + "  " + quoted(spec); };
  for (const OptionRow& option : all_options(table)) {
    const std::string value = option.value.empty() ? "" : zsh_value(option.value);
    const std::string rest = fmt::format("[{}]{}", zsh_text(option.description), value);
    const char* star = option.is_repeatable ? "*" : "";
    add(star + option.name + rest);
    if (!option.short_name.empty()) add(star + option.short_name + rest);
  }
  for (const OptionRow& argument : table.arguments)
    add((argument.is_required ? "" : ":") + zsh_value(argument.name));
  return lines + "\n";
}

std::string fish_option(const std::string& begin, const OptionRow& option) {
  std::string line = begin + " -l " + option.name.substr(2);
  if (!option.short_name.empty()) line += " -s " + option.short_name.substr(1);
  const auto words = choices_of(option.value);
  if (!words.empty())
    line += fmt::format(" -x -a {}", quoted(fmt::format("{}", fmt::join(words, " "))));
  else if (!option.value.empty() && !is_optional(option.value))
    line += is_path(option.value) ? " -r -F" : " -x";
  return line + " -d " + quoted(summary_of(option.description)) + "\n";
}

}  // namespace

std::string bash_completion(const CommandTable& table) {
  const std::string function = function_name(table.full_name);
  std::string script = fmt::format("# bash completion for {}\n", table.full_name);
  script +=
      "_tessera_words() {\n"
      "  mapfile -t COMPREPLY < <(compgen -W \"$1\" -- \"$cur\")\n"
      "}\n";
  script += function +
            "() {\n"
            "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]}\n"
            "  COMPREPLY=()\n";
  if (table.commands.empty()) {
    script += bash_command(table, "  ");
  } else {
    script += fmt::format("  if ((COMP_CWORD == 1)); then\n    _tessera_words \"{} {}\"\n    return\n  fi\n",
                          names_of(table.commands), bash_words(table));
    script += "  case ${COMP_WORDS[1]} in\n";
    for (const CommandTable& command : table.commands) {
      script += "    " + command.name + ")\n";
      if (command.name == "help")
        script += fmt::format("      _tessera_words \"{}\"\n      return\n", names_of(table.commands));
      else
        script += bash_command(command, "      ");
      script += "      ;;\n";
    }
    script += "  esac\n";
  }
  return script + fmt::format("}}\ncomplete -o default -F {} {}\n", function, table.full_name);
}

std::string zsh_completion(const CommandTable& table) {
  const std::string function = function_name(table.full_name);
  std::string script = fmt::format("#compdef {}\n{}() {{\n", table.full_name, function);
  if (table.commands.empty()) {
    script += zsh_arguments(table, "  ");
  } else {
    script += "  local -a commands=(\n";
    for (const CommandTable& command : table.commands)
      script += "    " + quoted(command.name + ":" + summary_of(command.description)) + "\n";
    script +=
        "  )\n"
        "  if ((CURRENT == 2)); then\n"
        "    _describe command commands\n" +
        zsh_arguments(table, "    ") +
        "    return\n"
        "  fi\n"
        "  local command=$words[2]\n"
        "  shift words\n"
        "  ((CURRENT--))\n"
        "  case $command in\n";
    for (const CommandTable& command : table.commands) {
      script += "    " + command.name + ")\n";
      script +=
          command.name == "help" ? "      _describe command commands\n" : zsh_arguments(command, "      ");
      script += "      ;;\n";
    }
    script += "  esac\n";
  }
  return script + fmt::format("}}\n{} \"$@\"\n", function);
}

std::string fish_completion(const CommandTable& table) {
  std::string script = fmt::format("# fish completion for {}\n", table.full_name);
  const std::string begin = "complete -c " + table.full_name;
  if (table.commands.empty()) {
    for (const OptionRow& option : all_options(table)) script += fish_option(begin, option);
    return script;
  }
  for (const OptionRow& option : all_options(table))
    script += fish_option(begin + " -n __fish_use_subcommand", option);
  for (const CommandTable& command : table.commands) {
    script += fmt::format("{} -f -n __fish_use_subcommand -a {} -d {}\n", begin, command.name,
                          quoted(summary_of(command.description)));
    const std::string of_command = fmt::format("{} -n '__fish_seen_subcommand_from {}'", begin, command.name);
    for (const OptionRow& option : all_options(command)) script += fish_option(of_command, option);
  }
  return script + fmt::format("{} -f -n '__fish_seen_subcommand_from help' -a {}\n", begin,
                              quoted(names_of(table.commands)));
}

std::optional<std::string> completion(const CommandTable& table, const std::string& shell) {
  if (shell == "bash") return bash_completion(table);
  if (shell == "zsh") return zsh_completion(table);
  if (shell == "fish") return fish_completion(table);
  return std::nullopt;
}

}  // namespace tessera::cli
