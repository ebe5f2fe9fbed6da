// SPDX-License-Identifier: Apache-2.0
#include "core/cli/config_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/cli/help.hpp"
#include "core/cli/option_table.hpp"
#include "core/cli/parse.hpp"

namespace tessera::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(ParseConfig, ReadsNamesAndValuesWithTheirLines) {
  const auto lines = parse_config("# a comment = 1\n\n  spp=4\r\nname =  a = b # c \nfast\nempty =");
  ASSERT_TRUE(lines);
  EXPECT_THAT(*lines, ElementsAre(ConfigLine{3, "spp", "4"}, ConfigLine{4, "name", "a = b # c"},
                                  ConfigLine{5, "fast", std::nullopt}, ConfigLine{6, "empty", ""}));
}

TEST(ParseConfig, RefusesWhatIsNoOption) {
  for (const char* text :
       {"# fine\n= 4", "# fine\ntwo words = 4", "# fine\nspp 4", "# fine\nname = a\x1b[2J"}) {
    const auto lines = parse_config(text);
    ASSERT_FALSE(lines) << text;
    EXPECT_THAT(lines.error().message, testing::StartsWith("2: it must be NAME = VALUE")) << text;
  }
}

// A program with some options, whose file and environment a test chooses.
class ConfigFile : public testing::Test {
 protected:
  ConfigFile() {
    std::filesystem::create_directories(folder_);
    set_help(app_, {.exit_statuses = {{0, "done"}}});
    add_config_option(app_);
    app_.add_option("--spp", spp_, "Samples")->type_name("N")->check([](const std::string& text) {
      return text == "0" ? "must be positive" : "";
    });
    app_.add_option("--name", name_, "Name")->envname("PAINT_OTHER")->type_name("NAME");
    app_.add_option("--accept", accepted_, "Accept")->allow_extra_args(false)->type_name("HEX");
    app_.add_flag("--fast", fast_, "Be fast");
    app_.add_option("--check", check_, "Check")->configurable(false)->type_name("DIR");
    app_.final_callback([this] { is_final_ = true; });
  }
  ~ConfigFile() override {
    for (const std::string& name : variables_) ::unsetenv(name.c_str());
    std::filesystem::remove_all(folder_);
  }

  void set(const std::string& variable, const std::string& value) {
    variables_.push_back(variable);
    ::setenv(variable.c_str(), value.c_str(), 1);
  }

  // The message of the parser; empty if it accepts the file and these words.
  std::string parse_with(const std::string& text, std::vector<std::string> words = {}) {
    std::ofstream(file_) << text;
    words.insert(words.begin(), {"paint", "--config", file_});
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    testing::internal::CaptureStderr();
    const auto ended = parse(app_, static_cast<int>(arguments.size()), arguments.data(), "paint");
    const std::string error = testing::internal::GetCapturedStderr();
    EXPECT_EQ(ended.has_value(), !error.empty());
    if (ended) EXPECT_EQ(*ended, kExitUsage);
    return error;
  }

  // "FILE:2: WHAT", as the message begins.
  std::string at_line(int line, const std::string& what) const {
    return "paint: error: " + file_ + ":" + std::to_string(line) + ": " + what;
  }

  const std::string folder_ = testing::TempDir() + "config_file_test." + std::to_string(::getpid());
  const std::string file_ = folder_ + "/paint.conf";
  std::vector<std::string> variables_, accepted_;
  int spp_ = 1;
  std::string name_, check_;
  bool fast_ = false, is_final_ = false;
  CLI::App app_{"Paint images", "paint"};
};

TEST_F(ConfigFile, SetsOptionsAndFlags) {
  EXPECT_EQ(parse_with("spp = 4\nname = a b\nfast\naccept = 1\naccept = 2\n"), "");
  EXPECT_EQ(spp_, 4);
  EXPECT_EQ(name_, "a b");
  EXPECT_TRUE(fast_);
  EXPECT_THAT(accepted_, ElementsAre("1", "2"));
  EXPECT_TRUE(is_final_);
  EXPECT_EQ(app_.get_option("--spp")->count(), 1u);
}

TEST_F(ConfigFile, IsOverriddenByTheEnvironmentAndBothByTheCommandLine) {
  set("PAINT_SPP", "8");
  set("PAINT_OTHER", "environment");
  set("PAINT_ACCEPT", "3");
  EXPECT_EQ(parse_with("spp = 4\nname = file\naccept = 1\naccept = 2\n", {"--name", "line"}), "");
  EXPECT_EQ(spp_, 8);
  EXPECT_EQ(name_, "line");
  EXPECT_THAT(accepted_, ElementsAre("3"));
}

TEST_F(ConfigFile, CanBeNamedByTheEnvironment) {
  std::ofstream(file_) << "spp = 4\n";
  set("PAINT_CONFIG", file_);
  std::string program = "paint";
  char* arguments[] = {program.data()};
  EXPECT_FALSE(parse(app_, 1, arguments, "paint"));
  EXPECT_EQ(spp_, 4);
}

TEST_F(ConfigFile, RefusesUnknownOptions) {
  EXPECT_THAT(parse_with("fast\nsp = 4\n"),
              HasSubstr(at_line(2, "there is no option 'sp'; did you mean 'spp'?")));
}

TEST_F(ConfigFile, RefusesDashes) {
  EXPECT_THAT(parse_with("--spp = 4\n"), HasSubstr(at_line(1, "'--spp' must stand without dashes\n")));
}

TEST_F(ConfigFile, RefusesWhatOnlyTheCommandLineMayHave) {
  EXPECT_THAT(parse_with("check = .\n"), HasSubstr(at_line(1, "'check' is for the command line alone")));
  app_.clear();
  EXPECT_THAT(parse_with("config = b\n"), HasSubstr(at_line(1, "'config' is for the command line alone")));
  app_.clear();
  EXPECT_THAT(parse_with("help\n"), HasSubstr(at_line(1, "'help' is for the command line alone")));
}

TEST_F(ConfigFile, RefusesInvalidValues) {
  EXPECT_THAT(parse_with("\nspp = 0\n"), HasSubstr(at_line(2, "spp: must be positive\n")));
}

TEST_F(ConfigFile, RefusesValuesThatAreNoNumbers) {
  EXPECT_THAT(parse_with("spp = four\n"), HasSubstr(at_line(1, "Could not convert: --spp = four\n")));
}

TEST_F(ConfigFile, RefusesMissingAndSuperfluousValues) {
  EXPECT_THAT(parse_with("spp\n"), HasSubstr(at_line(1, "'spp' needs a value: spp = VALUE\n")));
  app_.clear();
  EXPECT_THAT(parse_with("name =\n"), HasSubstr(at_line(1, "'name' needs a value: name = VALUE\n")));
  app_.clear();
  EXPECT_THAT(parse_with("fast = no\n"), HasSubstr(at_line(1, "'fast' takes no value")));
}

TEST_F(ConfigFile, RefusesWhatIsSetTwice) {
  EXPECT_THAT(parse_with("spp = 4\nfast\nspp = 5\n"),
              HasSubstr(at_line(3, "'spp' is already set in line 1\n")));
}

// A mistake is reported also where the command line overrides the value.
TEST_F(ConfigFile, IsCheckedAlsoWhereItIsOverridden) {
  EXPECT_THAT(parse_with("spp = 4\nspp = 5\n", {"--spp", "6"}),
              HasSubstr(at_line(2, "'spp' is already set")));
}

TEST_F(ConfigFile, MustExistAndBeSmall) {
  EXPECT_THAT(parse_with(std::string((1 << 20) + 1, '#')), HasSubstr(file_ + ": it is longer than 1 MiB"));
  std::filesystem::remove(file_);
  std::filesystem::create_directory(file_);
  app_.clear();
  EXPECT_THAT(parse_with(""), HasSubstr(file_ + ": cannot be read: "));
  std::filesystem::remove(file_);
  std::string program = "paint", option = "--config", file = folder_ + "/none";
  char* arguments[] = {program.data(), option.data(), file.data()};
  testing::internal::CaptureStderr();
  app_.clear();
  EXPECT_EQ(parse(app_, 3, arguments, "paint"), kExitUsage);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              HasSubstr("paint: error: " + file + ": cannot be read: No such file or directory\n"));
}

TEST_F(ConfigFile, VariablesAreNamedByARuleInHelp) {
  add_environment_variables(app_);
  const auto rows = variables_of(table_of(app_, "paint"));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].name + ": " + rows[0].description, "PAINT_OTHER: Default of --name");
  EXPECT_EQ(rows[1].name + ": " + rows[1].description,
            "PAINT_CONFIG: Default of --config, and so on for each other option");
  EXPECT_EQ(app_.get_option("--check")->get_envname(), "");
  EXPECT_EQ(variable_of("tessera-worker", "--cache-gib"), "TESSERA_WORKER_CACHE_GIB");
}

}  // namespace
}  // namespace tessera::cli
