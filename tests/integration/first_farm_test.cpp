// SPDX-License-Identifier: Apache-2.0
// The blocks "First farm" of the documents, pasted into a shell: in a network and with a state of their own,
// and with an image that costs little.
#include <gmock/gmock.h>

#include <cstdlib>
#include <regex>
#include <sstream>
#include <string>

#include "tests/integration/network.hpp"
#include "tests/integration/processes.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;

// The first block between `fence` and "```" after `heading`.
std::string block_of(const std::string& page, const std::string& heading, const std::string& fence) {
  const std::size_t section = page.find(heading);
  if (section == std::string::npos) return "";
  const std::size_t begin = page.find(fence, section) + fence.size();
  return page.substr(begin, page.find("```", begin) - begin);
}

// The command that writes the image with which `farm` compares that of the farm, from further up the page.
std::string local_render(const std::string& page, const std::string& farm) {
  std::smatch compared;
  if (!std::regex_search(farm, compared, std::regex("tessera compare \\S+ (\\S+)"))) return "";
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("tessera render ") && line.find("-o " + compared.str(1)) != std::string::npos)
      return line + "\n";
  return "";
}

class FirstFarm : public ::testing::TestWithParam<const char*> {
 protected:
  // As an interactive shell runs it, but that the first failure ends it. Afterwards nothing of it runs.
  Process paste(const std::string& commands) {
    write_file(folder_ / "script", "set -em\ntrap 'kill $(jobs -p) 2>/dev/null || :' EXIT\n" + commands +
                                       "wait\necho all processes have ended\n");
    const std::filesystem::path programs = std::filesystem::path(TESSERA_CLIENT).parent_path();
    return Process({.arguments = {"/bin/bash", folder_ / "script"},
                    .out = folder_ / "out",
                    .err = folder_ / "err",
                    .folder = folder_.path(),
                    .environment = {{"PATH", programs.string() + ":/usr/bin:/bin"},
                                    {"HOME", folder_.path().string()},
                                    {"XDG_STATE_HOME", ""},
                                    {"XDG_CACHE_HOME", ""},
                                    {"TESSERA_COORDINATOR", ""}}});
  }

  TempFolder folder_;
};

TEST_P(FirstFarm, GivesTheBytesOfALocalRender) {
  const std::string source = TESSERA_SOURCE_DIR "/", page = read_file(source + GetParam());
  const std::string farm = block_of(page, "\n## First farm\n", "```\n");
  ASSERT_THAT(farm, HasSubstr("tessera-coordinator --listen 127.0.0.1:7420 &\n"));
  ASSERT_THAT(farm, HasSubstr("tessera submit "));
  const std::string local = local_render(page, farm);
  ASSERT_NE(local, "") << "nothing above writes the image that is compared";
  write_file(folder_ / "first.json", block_of(read_file(source + "docs/scene-format.md"), "#", "```jsonc\n"));

  // With its own ports, whoever listens on this machine.
  if (const auto obstacle = Network::enter()) GTEST_SKIP() << *obstacle;
  ASSERT_EQ(std::system("ip link set lo up"), 0);
  const std::string commands =
      std::regex_replace(local + farm, std::regex("tessera (render|submit) \\S+"), "$& --size 64x48 --spp 4");
  Process shell = paste(commands);
  EXPECT_EQ(shell.wait(std::chrono::seconds(90)), 0) << commands << shell.out() << shell.err();
  EXPECT_THAT(shell.out(), HasSubstr("identical\n"));
  EXPECT_THAT(shell.out(), HasSubstr("all processes have ended\n"));
}

INSTANTIATE_TEST_SUITE_P(Documents, FirstFarm, ::testing::Values("README.md", "docs/getting-started.md"),
                         [](const auto& document) {
                           return std::string(document.index == 0 ? "Readme" : "GettingStarted");
                         });

}  // namespace
}  // namespace tessera::test
