// SPDX-License-Identifier: Apache-2.0
// `tessera demo`: a farm in one process, which renders and leaves nothing behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/integration/processes.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;

class DemoTest : public ::testing::Test {
 protected:
  DemoTest() { write_scene("4"); }

  void write_scene(const std::string& spp) {
    write_file(folder_ / "scene.json", R"({
      "render": {"width": 40, "height": 30, "spp": )" +
                                           spp + R"(},
      "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
      "materials": {"glow": {"type": "lambert", "albedo": 0.5, "emission": [2, 1, 0.5]}},
      "shapes": [{"type": "sphere", "radius": 1, "center": [0, 0, 0], "material": "glow"}]})");
  }

  Process start(std::vector<std::string> more = {}) {
    more.insert(more.begin(), {TESSERA_CLIENT, "demo", folder_ / "scene.json"});
    return Process({.arguments = more,
                    .out = folder_ / "out",
                    .err = folder_ / "err",
                    .environment = {{"TMPDIR", folder_.path().string()}}});
  }
  // Whether the temporary folder of the demo is gone.
  bool is_clean() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      if (entry.path().filename().string().starts_with("tessera-demo-")) return false;
    return true;
  }

  TempFolder folder_;
};

// The processes that any of its threads has started.
std::vector<pid_t> children_of(pid_t pid) {
  std::vector<pid_t> children;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
    std::ifstream file(thread.path() / "children");
    for (pid_t child = 0; file >> child;) children.push_back(child);
  }
  return children;
}

TEST_F(DemoTest, RendersAndEnds) {
  Process demo = start({"--once"});
  EXPECT_EQ(demo.wait(std::chrono::seconds(90)), 0) << demo.err();
  EXPECT_THAT(demo.out(), HasSubstr("The page of this farm: http://127.0.0.1:"));
  EXPECT_THAT(demo.err(), HasSubstr("done. Save the image: tessera image "));
  EXPECT_TRUE(is_clean());
}

TEST_F(DemoTest, SpeaksJson) {
  Process demo = start({"--once", "--json"});
  EXPECT_EQ(demo.wait(std::chrono::seconds(90)), 0) << demo.err();
  std::istringstream out(demo.out());
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(out, line);) lines.push_back(nlohmann::json::parse(line));
  ASSERT_GE(lines.size(), 2u);
  EXPECT_THAT(lines.front()["page"].get<std::string>(), ::testing::StartsWith("http://127.0.0.1:"));
  EXPECT_EQ(lines.back()["state"], "done");
  std::istringstream err(demo.err());  // nothing else than what this machine's sandbox lacks
  for (std::string line; std::getline(err, line);)
    EXPECT_THAT(line, ::testing::StartsWith("the sandbox of ")) << demo.err();
}

// As after the installation of the package tessera alone.
TEST_F(DemoTest, NamesThePackagesOfProgramsThatAreMissing) {
  const std::filesystem::path built = TESSERA_CLIENT;
  std::filesystem::create_directory(folder_ / "bin");
  std::filesystem::copy_file(built, folder_ / "bin" / "tessera");
  std::filesystem::create_directory_symlink(built.parent_path().parent_path() / "lib", folder_ / "lib");
  Process demo({.arguments = {folder_ / "bin" / "tessera", "demo", folder_ / "scene.json"},
                .out = folder_ / "out",
                .err = folder_ / "err"});
  EXPECT_EQ(demo.wait(std::chrono::seconds(30)), 1);
  EXPECT_THAT(demo.err(), HasSubstr("the demo reads scenes in tessera-validator and tessera-scene-loader"));
  EXPECT_THAT(demo.err(), HasSubstr("apt-get install ./tessera-coordinator_*.deb ./tessera-worker_*.deb"));
}

TEST_F(DemoTest, SaysWhatIsMissingOfTheSandbox) {
  const std::filesystem::path built = TESSERA_CLIENT;
  std::filesystem::create_directory(folder_ / "bin");
  for (const char* const program : {"tessera", "tessera-validator"})
    std::filesystem::copy_file(built.parent_path() / program, folder_ / "bin" / program);
  std::filesystem::create_directory_symlink(built.parent_path().parent_path() / "lib", folder_ / "lib");
  const std::filesystem::path loader = folder_ / "bin" / "tessera-scene-loader";
  write_file(loader, "#!/bin/sh\nexit 3\n");
  std::filesystem::permissions(loader, std::filesystem::perms::owner_all);
  Process demo({.arguments = {folder_ / "bin" / "tessera", "demo", folder_ / "scene.json", "--http", "none"},
                .out = folder_ / "out",
                .err = folder_ / "err",
                .environment = {{"TMPDIR", folder_.path().string()}}});
  EXPECT_EQ(demo.wait(std::chrono::seconds(30)), 1);
  EXPECT_THAT(demo.err(),
              HasSubstr("the sandbox of tessera-scene-loader is incomplete: it cannot be checked"));
}

TEST_F(DemoTest, EndsByCtrlC) {
  Process demo = start();
  ASSERT_TRUE(poll_until(std::chrono::seconds(60), [&] {
    return demo.err().find("done.") != std::string::npos;
  })) << demo.err();
  EXPECT_THAT(children_of(demo.pid()), ::testing::IsEmpty()) << "coordinator and worker are in this process";
  demo.signal(SIGINT);
  EXPECT_EQ(demo.wait(std::chrono::seconds(30)), 0);
  EXPECT_EQ(demo.err().find("error"), std::string::npos) << demo.err();
  EXPECT_TRUE(is_clean());
}

TEST_F(DemoTest, SaysWhatAddressItCannotServeThePageAt) {
  Process demo = start({"--http", "127.0.0.1:notaport"});
  EXPECT_EQ(demo.wait(std::chrono::seconds(30)), 1);
  EXPECT_THAT(demo.err(), HasSubstr("127.0.0.1:notaport"));
  EXPECT_TRUE(is_clean());
}

TEST_F(DemoTest, SaysThatItsOnlyJobWasInterrupted) {
  write_scene("1000000");
  Process demo = start({"--once"});
  ASSERT_TRUE(poll_until(std::chrono::seconds(60), [&] {
    return demo.err().find(", as job ") != std::string::npos;
  })) << demo.err();
  demo.signal(SIGINT);
  EXPECT_EQ(demo.wait(std::chrono::seconds(30)), 130);
  EXPECT_TRUE(is_clean());
}

}  // namespace
}  // namespace tessera::test
