// SPDX-License-Identifier: Apache-2.0
#include "core/cli/man_page.hpp"

#include <fmt/format.h>

#include <cctype>
#include <sstream>
#include <string_view>

namespace tessera::cli {
namespace {

// Text as roff shows it unchanged. A line of it must not begin with a control character of roff.
std::string escaped(std::string_view text) {
  std::string roff;
  for (const char c : text) {
    const bool at_line_begin = roff.empty() || roff.back() == '\n';
    if (at_line_begin && (c == '.' || c == '\'')) roff += "\\&";
    if (c == '\\')
      roff += "\\e";
    else if (c == '-')
      roff += "\\-";
    else if (c == '~')
      roff += "\\(ti";
    else
      roff += c;
  }
  return roff;
}

std::string bold(std::string_view text) {
  return fmt::format("\\fB{}\\fR", escaped(text));
}
std::string italic(std::string_view text) {
  return fmt::format("\\fI{}\\fR", escaped(text));
}

// Paragraphs of notes: empty lines divide them, and lines that begin with a space stand as they are.
std::string notes_of(const std::string& notes) {
  std::string roff;
  bool verbatim = false;
  const auto set_verbatim = [&](bool now) {
    if (now != verbatim) roff += now ? ".PP\n.nf\n" : ".fi\n";
    verbatim = now;
  };
  std::istringstream lines(notes);
  bool begins_paragraph = true;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) {
      begins_paragraph = true;
      continue;
    }
    set_verbatim(line.front() == ' ');
    if (begins_paragraph && !verbatim) roff += ".PP\n";
    begins_paragraph = false;
    roff += escaped(line) + "\n";
  }
  set_verbatim(false);
  return roff;
}

std::string entry(const std::string& tag, const std::string& description) {
  return ".TP\n" + tag + "\n" + escaped(description.empty() ? "-" : description) + "\n";
}

std::string option_tag(const OptionRow& option) {
  std::string tag = option.short_name.empty() ? "" : bold(option.short_name) + ", ";
  tag += bold(option.name);
  return option.value.empty() ? tag : tag + " " + italic(option.value);
}

std::string options_of(const CommandTable& table) {
  std::string roff;
  for (const OptionRow& argument : table.arguments)
    roff += entry(italic(argument.name), argument.description);
  for (const OptionGroup& group : table.groups) {
    if (table.groups.size() > 1) roff += fmt::format(".PP\n{}:\n", escaped(group.title));
    for (const OptionRow& option : group.options) roff += entry(option_tag(option), option.description);
  }
  return roff;
}

std::string environment_of(const CommandTable& table) {
  std::string roff;
  for (const VariableRow& variable : variables_of(table))
    roff += entry(bold(variable.name), variable.description + ".");
  return roff;
}

std::string exit_statuses_of(const CommandTable& table) {
  std::string roff;
  for (const auto& [status, meaning] : table.text.exit_statuses)
    roff += entry(bold(std::to_string(status)), meaning);
  return roff;
}

std::string examples_of(const CommandTable& table) {
  std::string roff = ".nf\n";
  for (const std::string& example : table.text.examples) roff += escaped(example) + "\n";
  return table.text.examples.empty() ? "" : roff + ".fi\n";
}

// A part under a heading of its own, in the page of a program. The heading begins its first paragraph.
std::string section(const char* title, const std::string& roff) {
  constexpr std::string_view kParagraph = ".PP\n";
  const std::string text = roff.starts_with(kParagraph) ? roff.substr(kParagraph.size()) : roff;
  return text.empty() ? "" : fmt::format(".SH {}\n{}", title, text);
}

// The same in the subsection of a command.
std::string part(const char* title, const std::string& roff) {
  return roff.empty() ? "" : fmt::format(".PP\n{}:\n{}", title, roff);
}

std::string command_of(const CommandTable& command) {
  return fmt::format(".SS {}\n{}.\n.PP\n{}\n", escaped(command.full_name), escaped(command.description),
                     escaped(usage_of(command))) +
         options_of(command) + notes_of(command.text.notes) + part("Exit status", exit_statuses_of(command)) +
         part("Examples", examples_of(command).empty() ? "" : ".PP\n" + examples_of(command));
}

std::string in_capitals(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string environment_of_all(const CommandTable& table) {
  std::string roff = environment_of(table);
  for (const CommandTable& command : table.commands)
    if (roff.empty()) roff = environment_of(command);
  return roff;
}

}  // namespace

std::string man_page(const CommandTable& table, const std::string& version) {
  std::string commands;
  for (const CommandTable& command : table.commands) commands += command_of(command);
  return fmt::format(".TH {} 1 \"\" \"{}\" \"User Commands\"\n", escaped(in_capitals(table.name)),
                     escaped(version)) +
         fmt::format(".SH NAME\n{} \\- {}\n", escaped(table.name), escaped(table.description)) +
         fmt::format(".SH SYNOPSIS\n{}\n", escaped(usage_of(table))) +
         section("DESCRIPTION", notes_of(table.text.notes)) + section("COMMANDS", commands) +
         section("OPTIONS", options_of(table)) + section("ENVIRONMENT", environment_of_all(table)) +
         section("EXIT STATUS", exit_statuses_of(table)) + section("EXAMPLES", examples_of(table));
}

}  // namespace tessera::cli
