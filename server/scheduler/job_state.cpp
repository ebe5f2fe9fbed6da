// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/job_state.hpp"

namespace tessera::scheduler {

std::string_view job_state_name(JobState state) {
  switch (state) {
    case JobState::kRunning:
      return "running";
    case JobState::kPaused:
      return "paused";
    case JobState::kDone:
      return "done";
    case JobState::kCancelled:
      return "cancelled";
    case JobState::kFailed:
      return "failed";
  }
  return "unknown";
}

bool may_become(JobState from, JobState to) {
  switch (from) {
    case JobState::kRunning:
      return to != JobState::kRunning;
    case JobState::kPaused:
      return to == JobState::kRunning || to == JobState::kCancelled || to == JobState::kFailed;
    case JobState::kDone:
      return to == JobState::kRunning;
    case JobState::kCancelled:
    case JobState::kFailed:
      return false;
  }
  return false;
}

}  // namespace tessera::scheduler
