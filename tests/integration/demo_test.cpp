// SPDX-License-Identifier: Apache-2.0
// `tessera demo`: starts a farm, renders, and leaves nothing behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cerrno>
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

std::vector<pid_t> children_of(pid_t pid) {
  const std::string number = std::to_string(pid);
  std::ifstream file("/proc/" + number + "/task/" + number + "/children");
  std::vector<pid_t> children;
  for (pid_t child = 0; file >> child;) children.push_back(child);
  return children;
}

bool is_running(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string number, name, state;
  return (stat >> number >> name >> state) && state != "Z";
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
  EXPECT_EQ(demo.err(), "");
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
  EXPECT_THAT(demo.err(), HasSubstr("the demo starts tessera-coordinator and tessera-worker, which must be"));
  EXPECT_THAT(demo.err(), HasSubstr("apt-get install ./tessera-coordinator_*.deb ./tessera-worker_*.deb"));
}

TEST_F(DemoTest, EndsByCtrlC) {
  Process demo = start();
  ASSERT_TRUE(poll_until(std::chrono::seconds(60), [&] {
    return demo.err().find("done.") != std::string::npos;
  })) << demo.err();
  const std::vector<pid_t> children = children_of(demo.pid());
  EXPECT_EQ(children.size(), 2u);
  demo.signal(SIGINT);
  EXPECT_EQ(demo.wait(std::chrono::seconds(30)), 0);
  for (const pid_t child : children) EXPECT_FALSE(is_running(child));
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

TEST_F(DemoTest, LeavesNoProcessEvenIfItIsKilled) {
  Process demo = start();
  ASSERT_TRUE(poll_until(std::chrono::seconds(60), [&] { return children_of(demo.pid()).size() == 2; }))
      << demo.err();
  const std::vector<pid_t> children = children_of(demo.pid());
  demo.signal(SIGKILL);
  EXPECT_TRUE(poll_until(std::chrono::seconds(20), [&] {
    for (const pid_t child : children)
      if (is_running(child)) return false;
    return true;
  }));
}

}  // namespace
}  // namespace tessera::test
