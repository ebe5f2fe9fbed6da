#include "server/scheduler/job_state.hpp"

#include <gtest/gtest.h>

#include <set>
#include <utility>

namespace tessera::scheduler {
namespace {

using enum JobState;

TEST(JobState, HasTheArrowsOfTheContractAndNoOthers) {
  const std::set<std::pair<JobState, JobState>> arrows = {
      {kRunning, kPaused},    {kPaused, kRunning},   {kRunning, kDone},   {kDone, kRunning},
      {kRunning, kCancelled}, {kPaused, kCancelled}, {kRunning, kFailed}, {kPaused, kFailed},
  };
  for (const JobState from : {kRunning, kPaused, kDone, kCancelled, kFailed}) {
    for (const JobState to : {kRunning, kPaused, kDone, kCancelled, kFailed}) {
      EXPECT_EQ(may_become(from, to), arrows.contains({from, to}))
          << job_state_name(from) << " to " << job_state_name(to);
    }
  }
}

}  // namespace
}  // namespace tessera::scheduler
