// SPDX-License-Identifier: Apache-2.0
// Manual pages and completions of a small program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/cli/completion.hpp"
#include "core/cli/man_page.hpp"
#include "core/cli/option_table.hpp"

namespace tessera::cli {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// The output of a shell command.
std::string output_of(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  std::array<char, 4096> bytes{};
  while (const std::size_t count = std::fread(bytes.data(), 1, bytes.size(), pipe))
    text.append(bytes.data(), count);
  ::pclose(pipe);
  return text;
}

class GeneratedPages : public ::testing::Test {
 protected:
  GeneratedPages() {
    set_help(app_, {.notes = "It draws.\n\n.begins with a dot", .exit_statuses = {{0, "done"}}});
    CLI::App* draw = app_.add_subcommand("draw", "Draw an image");
    draw->add_option("-o,--output", text_, "File to write; it's kept")->type_name("FILE");
    draw->add_option("--curve", text_, "Tone [curve]: of PNG files")->type_name("none|aces");
    draw->add_option("--spp", text_, "Samples")->type_name("N");
    draw->add_flag("--fast", flag_, "Be fast");
    set_help(*draw, {.exit_statuses = {{0, "done"}}, .examples = {"paint draw -o a.png"}});
    app_.add_subcommand("drop", "Forget it");
  }

  // What bash offers for the last of these words.
  std::string completed(const std::string& words) const {
    const std::string file = testing::TempDir() + "paint.bash";
    std::ofstream(file) << bash_completion(table_of(app_, "paint"));
    return output_of("bash -c 'compopt() { :; }; source " + file + "; COMP_WORDS=(" + words +
                     "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _paint; echo \"${COMPREPLY[@]}\"' 2>&1");
  }

  std::string text_;
  bool flag_ = false;
  CLI::App app_{"Paint images", "paint"};
};

TEST_F(GeneratedPages, BashCompletesCommandsOptionsAndValues) {
  EXPECT_EQ(completed("paint dr"), "draw drop\n");
  EXPECT_EQ(completed("paint draw --f"), "--fast\n");
  EXPECT_EQ(completed("paint draw --curve a"), "aces\n");
  EXPECT_EQ(completed("paint draw --spp 1"), "\n");
  EXPECT_EQ(completed("paint draw x"), "\n");
}

TEST_F(GeneratedPages, OtherShellsGetTheSameOptions) {
  const CommandTable table = table_of(app_, "paint");
  EXPECT_THAT(zsh_completion(table),
              AllOf(HasSubstr("#compdef paint\n"),
                    HasSubstr("'--curve[Tone \\[curve\\]\\: of PNG files]:value:(none aces)'"),
                    HasSubstr(":FILE:_files'"), HasSubstr("'draw:Draw an image'")));
  EXPECT_THAT(fish_completion(table),
              AllOf(HasSubstr("complete -c paint -n '__fish_seen_subcommand_from draw' -l output -s o -r -F"),
                    HasSubstr("-l curve -x -a 'none aces'"), HasSubstr("-a draw -d 'Draw an image'")));
  EXPECT_FALSE(completion(table, "tcsh"));
}

TEST_F(GeneratedPages, TheManualPageIsCleanRoff) {
  const std::string page = man_page(table_of(app_, "paint"), "paint 1.0");
  EXPECT_THAT(page, AllOf(HasSubstr(".TH PAINT 1 "), HasSubstr("\n\\&.begins with a dot\n"),
                          HasSubstr("\\fB\\-o\\fR, \\fB\\-\\-output\\fR \\fIFILE\\fR\n"),
                          HasSubstr("paint draw \\-o a.png")));
  if (output_of("command -v groff").empty()) GTEST_SKIP() << "there is no groff";
  const std::string file = testing::TempDir() + "paint.1";
  std::ofstream(file) << page;
  EXPECT_EQ(output_of("groff -man -Tutf8 -ww -z " + file + " 2>&1"), "");
}

}  // namespace
}  // namespace tessera::cli
