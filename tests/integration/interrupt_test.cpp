// SPDX-License-Identifier: Apache-2.0
// Ctrl-C: a local render writes what there is, and farm commands leave the job running. And what watches a
// job beside the terminal.
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>

#include "core/image/decode.hpp"
#include "tests/integration/farm_processes.hpp"
#include "tests/support/fake_tev.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class InterruptTest : public FarmTest {
 protected:
  InterruptTest() { std::filesystem::create_directory(out_); }

  bool nothing_written() const { return std::filesystem::is_empty(out_); }

  const std::vector<std::string> long_{"--size", "256x256", "--spp", "100000"};
  const std::filesystem::path out_ = folder_ / "out";

  Process start(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), long_.begin(), long_.end());
    for (const char* name : {"a.png", "b.exr"}) {
      arguments.push_back("-o");
      arguments.push_back((out_ / name).string());
    }
    return start_tessera(arguments);
  }
};

TEST_F(InterruptTest, OfARenderWritesWhatThereIs) {
  Process render = start({"render", kCornell, "--update-every", "0.1"});
  ASSERT_TRUE(poll_until(20s, [&] { return std::filesystem::exists(out_ / "b.exr"); }));
  render.signal(SIGINT);
  EXPECT_EQ(render.wait(20s), 130);
  EXPECT_THAT(render.err(), HasSubstr("interrupted at "));
  EXPECT_TRUE(core::read_image(out_ / "a.png"));
  EXPECT_TRUE(core::read_image(out_ / "b.exr"));
  EXPECT_TRUE(std::filesystem::exists(out_ / "a.png.tessera"));
}

TEST_F(InterruptTest, ASecondOneEndsARenderAtOnce) {
  Process render = start({"render", kCornell});
  ASSERT_TRUE(render.wait_until_catches(SIGTERM, 20s));
  render.signal(SIGTERM);
  render.signal(SIGTERM);
  const auto status = render.wait(20s);
  EXPECT_TRUE(status == 130 || status == 128 + SIGTERM) << status.value_or(-1);
  for (const auto& file : std::filesystem::directory_iterator(out_)) {
    const std::string name = file.path().filename();
    if (name == "a.png" || name == "b.exr") {
      EXPECT_TRUE(core::read_image(file.path())) << name;
    }
  }
}

TEST_F(InterruptTest, TevShowsTheImageOfAJobToTheBit) {
  start_coordinator();
  start_worker("worker", 1);
  FakeTev viewer;
  const std::string id = submit({"--size", "150x90", "--crop", "10,5,149,88", "--spp", "16"});
  EXPECT_EQ(tessera({"watch", id, "--tev", viewer.address()}).exit_code, 0);
  viewer.wait_for_end();
  ASSERT_EQ(tessera({"image", id, "-o", (out_ / "job.exr").string()}).exit_code, 0);
  const auto file = core::read_image(out_ / "job.exr");
  ASSERT_TRUE(file);
  const auto images = viewer.images();
  ASSERT_EQ(images.size(), 1u);
  EXPECT_EQ(images.begin()->first, "job " + id.substr(0, 12));
  EXPECT_TRUE(images.begin()->second.pixels == file->pixels);
}

TEST_F(InterruptTest, TevShowsTheLayersOfAJob) {
  start_coordinator();
  start_worker("worker", 1);
  FakeTev viewer;
  const std::string id = submit({"--size", "64x64", "--spp", "2", "--layers", "normal,depth"});
  EXPECT_EQ(tessera({"watch", id, "--tev", viewer.address()}).exit_code, 0);
  viewer.wait_for_end();
  const auto images = viewer.all();
  ASSERT_EQ(images.size(), 1u);
  EXPECT_THAT(images.begin()->second.channels,
              testing::ElementsAre("R", "G", "B", "Normal.X", "Normal.Y", "Normal.Z", "Depth.Z"));
}

TEST_F(InterruptTest, AMissingTevEndsNoWatch) {
  start_coordinator();
  start_worker("worker", 1);
  std::string address;
  { address = FakeTev().address(); }
  const std::string id = submit({"--size", "64x64", "--spp", "4"});
  const Outcome watch = tessera({"watch", id, "--tev", address});
  EXPECT_EQ(watch.exit_code, 0);
  EXPECT_THAT(watch.err, HasSubstr("no tev at " + address));
}

TEST_F(InterruptTest, OfASubmissionLeavesTheJobAndNoFile) {
  start_coordinator();
  start_worker("worker", 1);
  Process submit = start({"submit", kCornell, "--wait"});
  ASSERT_TRUE(submit.wait_until_catches(SIGINT, 20s));
  const std::string id = jobs().at(0).id();
  ASSERT_TRUE(wait_for_samples(id, 1));
  submit.signal(SIGINT);
  EXPECT_EQ(submit.wait(10s), 130);
  EXPECT_TRUE(nothing_written());
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  EXPECT_THAT(submit.err(), HasSubstr("tessera watch " + id.substr(0, 12)));
  EXPECT_THAT(submit.err(), HasSubstr("tessera cancel " + id.substr(0, 12)));
}

TEST_F(InterruptTest, OfAWatchEndsItWithoutACoordinator) {
  start_coordinator();
  const std::string id = submit(long_);
  Process watch = start_tessera({"watch", id});
  ASSERT_TRUE(watch.wait_until_catches(SIGINT, 20s));
  kill_coordinator();
  ASSERT_TRUE(poll_until(20s, [&] { return watch.err().find("lost the coordinator") != std::string::npos; }));
  watch.signal(SIGINT);
  EXPECT_EQ(watch.wait(10s), 130);
}

}  // namespace
}  // namespace tessera::test
