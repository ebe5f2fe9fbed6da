// SPDX-License-Identifier: Apache-2.0
// Manual pages and completions of a small program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/cli/completion.hpp"
#include "core/cli/man_page.hpp"
#include "core/cli/option_table.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::cli {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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
    draw->add_option("--show", text_, "Show it")->type_name("[HOST:PORT]");
    draw->add_flag("--fast", flag_, "Be fast");
    draw->add_option("SCENE", text_, "What to draw");
    draw->add_option("IMAGE", text_, "What to draw it on");
    set_help(*draw, {.exit_statuses = {{0, "done"}},
                     .examples = {"paint draw -o a.png"},
                     .required_arguments = {"SCENE"}});
    app_.add_subcommand("drop", "Forget it");
  }

  // What zsh offers for the last of these words, in the completion system of the shell itself: a shell on a
  // terminal of its own reads the script as a function of its path, and completes the line.
  std::vector<std::string> offered_by_zsh(const std::string& words) const {
    write_file(file("_paint"), zsh_completion(table_of(app_, "paint")));
    write_file(file("found"), "");
    write_file(file(".zshrc"), R"(
fpath=($ZDOTDIR $fpath)
autoload -Uz compinit
compinit -u -d $ZDOTDIR/dump
# Notes what is offered; calls that only ask which words match pass through.
compadd() {
  if [[ " $* " != *" -"[OAD]" "* ]]; then
    local -a offered
    builtin compadd -O offered "$@"
    print -rl -- $offered >>$ZDOTDIR/found
  fi
  builtin compadd "$@"
}
zle -C offer complete-word _main_complete
zle-line-init() { BUFFER=$TYPED; CURSOR=$#BUFFER; zle offer; exit }
zle -N zle-line-init
)");
    output_of("cd '" + folder_.path().string() + "' && ZDOTDIR=\"$PWD\" TERM=dumb TYPED='" + words +
              "' timeout 60 script -qec 'zsh -i' /dev/null </dev/null 2>&1");
    return lines_of(read_file(file("found")));
  }
  // What fish offers, without the descriptions.
  std::vector<std::string> offered_by_fish(const std::string& words) const {
    write_file(file("paint.fish"), fish_completion(table_of(app_, "paint")));
    std::vector<std::string> offered = lines_of(
        output_of("cd '" + folder_.path().string() + "' && TYPED='" + words +
                  "' timeout 60 fish --no-config -c 'source paint.fish; complete -C \"$TYPED\"' 2>&1"));
    for (std::string& line : offered) line = line.substr(0, line.find('\t'));
    return offered;
  }
  static std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream in(text);
    std::set<std::string> lines;
    for (std::string line; std::getline(in, line);)
      if (!line.empty()) lines.insert(line);
    return {lines.begin(), lines.end()};
  }
  std::string file(const std::string& name) const { return folder_.path() / name; }

  // What bash offers for the last of these words.
  std::string completed(const std::string& words) const {
    const std::string file = testing::TempDir() + "paint.bash";
    std::ofstream(file) << bash_completion(table_of(app_, "paint"));
    return output_of("bash -c 'compopt() { :; }; source " + file + "; COMP_WORDS=(" + words +
                     "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _paint; echo \"${COMPREPLY[@]}\"' 2>&1");
  }

  const TemporaryFolder folder_;
  std::string text_;
  bool flag_ = false;
  CLI::App app_{"Paint images", "paint"};
};

TEST_F(GeneratedPages, BashCompletesCommandsOptionsAndValues) {
  EXPECT_EQ(completed("paint dr"), "draw drop\n");
  EXPECT_EQ(completed("paint draw --f"), "--fast\n");
  EXPECT_EQ(completed("paint draw --curve a"), "aces\n");
  EXPECT_EQ(completed("paint draw --spp 1"), "\n");
  EXPECT_THAT(bash_completion(table_of(app_, "paint")), HasSubstr("--spp) compopt +o default"))
      << "files are no numbers, but may follow --show";
  EXPECT_EQ(completed("paint draw x"), "\n");
}

TEST_F(GeneratedPages, OtherShellsGetTheSameOptions) {
  const CommandTable table = table_of(app_, "paint");
  EXPECT_THAT(zsh_completion(table),
              AllOf(HasSubstr("#compdef paint\n"),
                    HasSubstr("'--curve[Tone \\[curve\\]\\: of PNG files]:value:(none aces)'"),
                    HasSubstr(":FILE:_files'"), HasSubstr("':SCENE:_files'"), HasSubstr("'::IMAGE:_files'"),
                    HasSubstr("'draw:Draw an image'")));
  EXPECT_THAT(fish_completion(table),
              AllOf(HasSubstr("complete -c paint -n '__fish_seen_subcommand_from draw' -l output -s o -r -F"),
                    HasSubstr("-l curve -x -a 'none aces'"), HasSubstr("-a draw -d 'Draw an image'")));
  EXPECT_FALSE(completion(table, "tcsh"));
}

TEST_F(GeneratedPages, ZshCompletesTheSame) {
  if (output_of("command -v zsh").empty()) GTEST_SKIP() << "there is no zsh";
  write_file(file("dr.png"), "");
  EXPECT_THAT(offered_by_zsh("paint dr"), ElementsAre("draw", "drop"));
  EXPECT_THAT(offered_by_zsh("paint draw --f"), ElementsAre("--fast"));
  EXPECT_THAT(offered_by_zsh("paint draw --curve a"), ElementsAre("aces"));
  EXPECT_THAT(offered_by_zsh("paint draw --curve "), ElementsAre("aces", "none"));
  EXPECT_THAT(offered_by_zsh("paint draw --spp 1"), IsEmpty());
  EXPECT_THAT(offered_by_zsh("paint draw -o dr"), ElementsAre("dr.png"));
  EXPECT_THAT(offered_by_zsh("paint draw dr"), ElementsAre("dr.png"));
  EXPECT_THAT(offered_by_zsh("paint drop dr"), IsEmpty());
}

TEST_F(GeneratedPages, FishCompletesTheSame) {
  if (output_of("command -v fish").empty()) GTEST_SKIP() << "there is no fish";
  write_file(file("dr.png"), "");
  EXPECT_THAT(offered_by_fish("paint dr"), ElementsAre("draw", "drop"));
  EXPECT_THAT(offered_by_fish("paint draw --f"), ElementsAre("--fast"));
  EXPECT_THAT(offered_by_fish("paint draw --curve a"), ElementsAre("aces"));
  EXPECT_THAT(offered_by_fish("paint draw --curve "), ElementsAre("aces", "none"));
  EXPECT_THAT(offered_by_fish("paint draw --spp 1"), IsEmpty());
  EXPECT_THAT(offered_by_fish("paint draw -o dr"), ElementsAre("dr.png"));
  EXPECT_THAT(offered_by_fish("paint draw dr"), ElementsAre("dr.png"));
  EXPECT_THAT(offered_by_fish("paint draw --show dr"), ElementsAre("dr.png"));
}

TEST_F(GeneratedPages, UsageShowsWhatMayBeLeftOut) {
  const CommandTable table = table_of(app_, "paint");
  EXPECT_EQ(usage_of(table), "paint COMMAND [OPTIONS]");
  EXPECT_EQ(usage_of(table.commands.at(0)), "paint draw [OPTIONS] SCENE [IMAGE]");
  EXPECT_EQ(usage_of(table.commands.at(1)), "paint drop [OPTIONS]");
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
