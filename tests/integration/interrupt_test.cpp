// SPDX-License-Identifier: Apache-2.0
// Ctrl-C leaves no partial file, for local renders and farm commands.
#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>

#include "tests/integration/farm_processes.hpp"

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

TEST_F(InterruptTest, OfARenderLeavesNoFile) {
  Process render = start({"render", kCornell});
  ASSERT_TRUE(render.wait_until_catches(SIGINT, 20s));
  render.signal(SIGINT);
  EXPECT_EQ(render.wait(10s), 130);
  EXPECT_TRUE(nothing_written());
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

TEST_F(InterruptTest, OfAWatchEndsItEvenWhileTheCoordinatorIsGone) {
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
