// SPDX-License-Identifier: Apache-2.0
// Renders that end early, and what later ones make of them: files and messages of the built program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/render_checkpoint.hpp"
#include "core/image/decode.hpp"
#include "tests/support/fake_tev.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/client/glowing_sphere.hpp"
#include "tests/unit/client/process.hpp"

namespace tessera::client {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr std::uint64_t kPixels = 150 * 100;

class Resume : public testing::Test {
 protected:
  Resume() { write_file(path("scene.json"), kGlowingSphere); }

  std::string path(const std::string& name) const { return folder_.path() / name; }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_.path())) found.push_back(entry.path().filename());
    return found;
  }
  std::vector<std::string> command(std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", path("scene.json")});
    return more;
  }
  ProcessResult render(const std::vector<std::string>& more) const { return run_tessera(command(more)); }
  // A render without end, interrupted when it has samples and thus a speed.
  ProcessResult interrupted(std::vector<std::string> more, int signal = SIGINT) const {
    more.insert(more.end(), {"--spp", "10000000"});
    return run_on_terminal_and_signal(command(more), " left", signal);
  }
  // A number of samples per pixel that the checkpoint does not have yet.
  std::string further_spp(const std::string& checkpoint) const {
    const auto header = read_checkpoint_header(path(checkpoint));
    EXPECT_TRUE(header);
    if (!header) return "0";
    const std::uint64_t pixels = header->render.settings.window().pixel_count();
    return std::to_string(header->totals.counters.samples / pixels +
                          70);  // tiles may have 64 more than others
  }
  // The file that a render without interruption writes.
  std::string at_once(const std::string& spp, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"-o", path("at_once.exr"), "--spp", spp};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(render(arguments).exit_status, 0);
    return read_file(path("at_once.exr"));
  }

  const TemporaryFolder folder_;
};

TEST_F(Resume, AnInterruptWritesWhatThereIsAndExitsWith130) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const ProcessResult result = interrupted({"-o", path("a.exr"), "--stats", path("s.json")}, signal);
    EXPECT_EQ(result.exit_status, 130);
    EXPECT_THAT(result.err, AllOf(HasSubstr("interrupted at "), HasSubstr("--resume")));
    EXPECT_THAT(names(), UnorderedElementsAre("scene.json", "a.exr", "a.exr.tessera", "s.json"));
    const auto stats = nlohmann::json::parse(read_file(path("s.json")));
    EXPECT_EQ(stats["complete"], false);
    EXPECT_GT(stats["samples"], 0);
    const auto image = core::read_image(path("a.exr"));
    ASSERT_TRUE(image);
    EXPECT_EQ(image->width, 150);
  }
}

TEST_F(Resume, GivesTheBytesOfAnUninterruptedRenderAndTidiesUp) {
  interrupted({"-o", path("a.exr"), "--threads", "3"});
  interrupted({"-o", path("a.exr"), "--threads", "1", "--resume"});
  const std::string spp = further_spp("a.exr.tessera");
  const ProcessResult last =
      render({"-o", path("a.exr"), "--threads", "2", "--resume", "--spp", spp, "--stats", path("s.json")});
  ASSERT_EQ(last.exit_status, 0) << last.err;
  EXPECT_FALSE(fs::exists(path("a.exr.tessera")));
  EXPECT_EQ(nlohmann::json::parse(read_file(path("s.json")))["samples"], kPixels * std::stoul(spp));
  EXPECT_TRUE(read_file(path("a.exr")) == at_once(spp));
}

TEST_F(Resume, AfterAKillLosesNoMoreThanTheTimeBetweenCheckpoints) {
  for (int kill = 0; kill < 3; ++kill) {
    const std::string checkpoint = path("a.exr.tessera");
    const auto before = read_checkpoint_header(checkpoint);  // none at first
    const std::uint64_t samples = before ? before->totals.counters.samples : 0;
    std::vector<std::string> arguments{
        "-o",  path("a.exr"), "--spp",       "10000000",  "--checkpoint-every",
        "0.1", "--crop",      "3,4,150,100", "--threads", std::to_string(1 + kill)};
    if (kill > 0) arguments.push_back("--resume");
    run_tessera_and_signal(
        command(arguments),
        [&] {
          const auto header = read_checkpoint_header(checkpoint);
          return header && header->totals.counters.samples > samples;
        },
        SIGKILL);
    EXPECT_FALSE(fs::exists(path("a.exr")));
  }
  const std::string spp = further_spp("a.exr.tessera");
  ASSERT_EQ(render({"-o", path("a.exr"), "--crop", "3,4,150,100", "--resume", "--spp", spp}).exit_status, 0);
  EXPECT_TRUE(read_file(path("a.exr")) == at_once(spp, {"--crop", "3,4,150,100"}));
  EXPECT_THAT(names(), UnorderedElementsAre("scene.json", "a.exr", "at_once.exr"));
}

TEST_F(Resume, ANamedCheckpointIsKeptSoThatSamplesCanBeAdded) {
  const std::vector<std::string> files{"-o", path("a.exr"), "--checkpoint", path("film")};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), files.begin(), files.end());
    return render(more);
  };
  ASSERT_EQ(with({"--spp", "5"}).exit_status, 0);
  ASSERT_EQ(with({"--spp", "9", "--resume"}).exit_status, 0);
  EXPECT_TRUE(read_file(path("a.exr")) == at_once("9"));
  ASSERT_EQ(render({"-o", path("b.exr"), "--resume", path("film"), "--spp", "11"}).exit_status, 0);
  EXPECT_TRUE(read_file(path("b.exr")) == at_once("11"));
  const ProcessResult fewer = with({"--spp", "8", "--resume"});
  EXPECT_EQ(fewer.exit_status, 1);
  EXPECT_THAT(fewer.err, HasSubstr("has 9 samples per pixel already: give a larger --spp than 8"));
}

TEST_F(Resume, AnotherRenderIsRefused) {
  interrupted({"-o", path("a.exr")});
  const std::string image = read_file(path("a.exr"));
  const ProcessResult seed = render({"-o", path("a.exr"), "--resume", "--seed", "7"});
  EXPECT_EQ(seed.exit_status, 1);
  EXPECT_THAT(seed.err, HasSubstr("belongs to another render: its seed is 0, and not 7"));
  write_file(path("scene.json"), [&] {
    std::string text = read_file(path("scene.json"));
    return text.replace(text.find("0.5, \"emission\""), 3, "0.6");
  }());
  const ProcessResult scene = render({"-o", path("a.exr"), "--resume"});
  EXPECT_EQ(scene.exit_status, 1);
  EXPECT_THAT(scene.err, HasSubstr("the materials of the scene differ"));
  write_file(path("a.exr.tessera"), "damaged");
  const ProcessResult damaged = render({"-o", path("a.exr"), "--resume"});
  EXPECT_EQ(damaged.exit_status, 1);
  EXPECT_THAT(damaged.err, HasSubstr("no checkpoint that this release can continue"));
  EXPECT_TRUE(read_file(path("a.exr")) == image);
}

TEST_F(Resume, WithoutACheckpointBeginsAtTheStart) {
  const ProcessResult result = run_tessera({"render", "--resume", path("scene.json"), "-o", path("a.exr")});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(result.err,
              HasSubstr("there is no checkpoint '" + path("a.exr.tessera") + "': rendering from"));
  EXPECT_TRUE(read_file(path("a.exr")) == at_once("4"));
  EXPECT_EQ(render({"-o", path("a.exr"), "--resume", path("missing")}).exit_status, 1);
}

TEST_F(Resume, WhatHasMoreSamplesIsNotOverwritten) {
  ASSERT_EQ(render({"-o", path("a.exr"), "--spp", "60", "--checkpoint", path("a.exr.tessera")}).exit_status,
            0);
  const ProcessResult again = interrupted({"-o", path("a.exr"), "--checkpoint-every", "3600"});
  EXPECT_THAT(again.err, HasSubstr("has samples of this very render"));
  const auto header = read_checkpoint_header(path("a.exr.tessera"));
  ASSERT_TRUE(header);
  EXPECT_GE(header->totals.counters.samples, kPixels * 60);
}

TEST_F(Resume, AnotherFileIsNoPlaceForACheckpoint) {
  const std::string scene = read_file(path("scene.json"));
  const ProcessResult result = render({"-o", path("a.exr"), "--checkpoint", path("scene.json")});
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.err, HasSubstr("exists and is no checkpoint"));
  EXPECT_EQ(read_file(path("scene.json")), scene);
}

TEST_F(Resume, TimeEndsARenderWithSuccess) {
  const ProcessResult result =
      render({"-o", path("a.exr"), "--spp", "10000000", "--time", "1s", "--stats", path("s.json")});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(result.err, AllOf(HasSubstr("stopped by --time at "), HasSubstr("--resume")));
  const auto stats = nlohmann::json::parse(read_file(path("s.json")));
  EXPECT_EQ(stats["complete"], false);
  EXPECT_GE(stats["render_seconds"], 0.5);
  EXPECT_TRUE(fs::exists(path("a.exr.tessera")));
  EXPECT_EQ(render({"-o", path("a.exr"), "--time", "soon"}).exit_status, 2);
}

TEST_F(Resume, UpdatesAreWholeImages) {
  const ProcessResult result = run_tessera_and_signal(
      command({"-o", path("a.exr"), "-o", path("a.png"), "--spp", "10000000", "--update-every", "0.1"}),
      [&] { return fs::exists(path("a.png")); }, SIGKILL);
  EXPECT_EQ(result.exit_status, -1);
  for (const char* name : {"a.exr", "a.png"}) EXPECT_TRUE(core::read_image(path(name))) << name;
}

TEST_F(Resume, TevShowsWhatTheFileHas) {
  test::FakeTev viewer;
  ASSERT_EQ(
      run_tessera({"render", "-o", path("a.exr"), "--tev", viewer.address(), path("scene.json")}).exit_status,
      0);
  const auto file = core::read_image(path("a.exr"));
  ASSERT_TRUE(file);
  viewer.wait_for_end();
  EXPECT_TRUE(viewer.images()[path("a.exr")].pixels == file->pixels);
}

}  // namespace
}  // namespace tessera::client
