// SPDX-License-Identifier: Apache-2.0
// Checks --help and --version of every program and command.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/integration/processes.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class HelpTest : public ::testing::Test {
 protected:
  // The output of a program on stdout; it must exit with success and print nothing to stderr.
  std::string said(const std::vector<std::string>& command) const {
    Process process({.arguments = command, .out = folder_ / "out", .err = folder_ / "err"});
    EXPECT_EQ(process.wait(std::chrono::seconds(20)), 0) << command.front();
    EXPECT_EQ(process.err(), "");
    return process.out();
  }

  TempFolder folder_;
};

const std::vector<std::vector<std::string>> kPrograms{{TESSERA_CLIENT},
                                                      {TESSERA_COORDINATOR_PROGRAM},
                                                      {TESSERA_WORKER},
                                                      {TESSERA_VALIDATOR},
                                                      {TESSERA_SCENE_LOADER}};

// The programs, and the commands that the client's help lists.
std::vector<std::vector<std::string>> all_commands(const std::string& help_of_client) {
  std::vector<std::vector<std::string>> commands = kPrograms;
  static const std::regex name("\n  ([a-z]+) +[A-Z]");
  for (std::sregex_iterator match(help_of_client.begin(), help_of_client.end(), name), end; match != end;
       ++match)
    commands.push_back({TESSERA_CLIENT, (*match)[1]});
  return commands;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Options and arguments have a description, beside them or in the next line.
void expect_descriptions(const std::string& help) {
  const std::vector<std::string> lines = lines_of(help);
  const std::string margin(28, ' ');
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool option = std::regex_search(lines[i], std::regex("^  (-[a-zA-Z], |    )--[a-z]"));
    if (!option) continue;
    const bool beside = lines[i].size() > 28 && lines[i].substr(26, 2) == "  " && lines[i][28] != ' ';
    const bool below = i + 1 < lines.size() && lines[i + 1].starts_with(margin) && lines[i + 1].size() > 28;
    EXPECT_TRUE(beside || below) << lines[i];
  }
}

TEST_F(HelpTest, IsCompleteAndFitsATerminal) {
  const auto commands = all_commands(said({TESSERA_CLIENT, "--help"}));
  EXPECT_EQ(commands.size(), 5u + 24u);
  for (std::vector<std::string> command : commands) {
    command.emplace_back("--help");
    const std::string help = said(command);
    SCOPED_TRACE(help);
    for (const std::string& line : lines_of(help)) {
      EXPECT_LE(line.size(), 80u) << line;
      EXPECT_TRUE(line.empty() || line.back() != ' ') << line;
    }
    EXPECT_THAT(help, HasSubstr("\n\nUsage: tessera"));
    EXPECT_THAT(help, HasSubstr("\nExit status:\n  0   "));
    const bool can_wait = command.front() == TESSERA_CLIENT && command[1] != "help";
    EXPECT_TRUE(!can_wait || help.find("\n  130 ") != std::string::npos);
    EXPECT_THAT(help, HasSubstr("  -h, --help                Print this help\n"));
    EXPECT_EQ(help.find('\n'), help.find("\n\nUsage: ")) << "the summary is one line";
    expect_descriptions(help);
    for (const char* word :
         {"TEXT", "UINT", " INT ", "INT:", "FLOAT", "BOOLEAN", "ENUM", "REQUIRED", "OPTIONS:", "Positionals",
          "Subcommands", "SUBCOMMAND", "(Env:", "Excludes", "Needs"})
      EXPECT_THAT(help, Not(HasSubstr(word)));
  }
}

// The page is written by scripts/write_command_line_docs.sh.
TEST_F(HelpTest, MatchesTheReferencePage) {
  const std::string page = read_file(TESSERA_SOURCE_DIR "/docs/command-line.md");
  for (std::vector<std::string> command : all_commands(said({TESSERA_CLIENT, "--help"}))) {
    std::string shown = command.front().substr(command.front().rfind('/') + 1);
    if (command.size() > 1) shown += " " + command.back();
    command.emplace_back("--help");
    const std::string block = "<!-- " + shown + " --help -->\n```text\n" + said(command) + "```\n";
    EXPECT_NE(page.find(block), std::string::npos)
        << "run scripts/write_command_line_docs.sh; the help is now\n"
        << block;
  }
}

TEST_F(HelpTest, NamesEnvironmentVariablesAndDefaults) {
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {TESSERA_CLIENT, "jobs", "--help"}, {TESSERA_WORKER, "--help"}}) {
    const std::string help = said(command);
    EXPECT_THAT(
        help, HasSubstr("\nEnvironment variables:\n  TESSERA_COORDINATOR       Default of --coordinator\n"));
    EXPECT_THAT(help, HasSubstr("[default:\n                            127.0.0.1:7420]"));
  }
}

TEST_F(HelpTest, AllProgramsReportUsageErrorsAlike) {
  for (const auto& program : kPrograms) {
    Process process(
        {.arguments = {program.front(), "--no-such-option"}, .out = folder_ / "out", .err = folder_ / "err"});
    EXPECT_EQ(process.wait(std::chrono::seconds(20)), 2);
    EXPECT_EQ(process.out(), "");
    const std::string name = program.front().substr(program.front().rfind('/') + 1);
    EXPECT_THAT(process.err(), ::testing::StartsWith(name + ": error: "));
    EXPECT_THAT(process.err(), HasSubstr("--no-such-option"));
    EXPECT_THAT(process.err(), ::testing::EndsWith("\nTry: " + name + " --help\n"));
  }
}

// Workers log what fails, since they try again.
TEST_F(HelpTest, AllProgramsReportFailuresAlike) {
  const std::string garbage = "echo garbage | ";
  const std::map<std::string, std::string> failing{
      {TESSERA_CLIENT, " render /missing.json -o /missing.png"},
      {TESSERA_COORDINATOR_PROGRAM, " --listen 127.0.0.1:0 --state /proc/missing"},
      {TESSERA_VALIDATOR, ""},
      {TESSERA_SCENE_LOADER, ""}};
  for (const auto& [program, arguments] : failing) {
    Process process({.arguments = {"/bin/sh", "-c", garbage + program + arguments},
                     .out = folder_ / "out",
                     .err = folder_ / "err"});
    EXPECT_EQ(process.wait(std::chrono::seconds(20)), 1) << program;
    const std::string name = program.substr(program.rfind('/') + 1);
    EXPECT_THAT("\n" + process.err(), HasSubstr("\n" + name + ": error: "));
  }
}

TEST_F(HelpTest, TheCommandHelpPrintsTheSame) {
  EXPECT_EQ(said({TESSERA_CLIENT, "help"}), said({TESSERA_CLIENT, "--help"}));
  EXPECT_EQ(said({TESSERA_CLIENT, "help", "submit"}), said({TESSERA_CLIENT, "submit", "--help"}));
}

TEST_F(HelpTest, ManualPagesAndCompletionsHaveEveryOption) {
  for (const char* program : {TESSERA_CLIENT, TESSERA_COORDINATOR_PROGRAM, TESSERA_WORKER}) {
    const std::string help = said({program, "--help"}), man = said({program, "--print-man-page"});
    EXPECT_THAT(man, ::testing::StartsWith(".TH TESSERA"));
    for (const char* shell : {"bash", "zsh", "fish"}) {
      const std::string script = said({program, "--print-completion", shell});
      static const std::regex option("    --([a-z-]+)");
      for (std::sregex_iterator match(help.begin(), help.end(), option), end; match != end; ++match)
        EXPECT_THAT(script, HasSubstr((*match)[1].str())) << shell;
    }
  }
}

TEST_F(HelpTest, VersionsAreOneLine) {
  for (const auto& program : kPrograms) {
    const std::string name = program.front().substr(program.front().rfind('/') + 1);
    EXPECT_TRUE(std::regex_match(said({program.front(), "--version"}), std::regex(name + " [0-9].*\n")));
  }
}

}  // namespace
}  // namespace tessera::test
