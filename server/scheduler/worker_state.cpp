// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/worker_state.hpp"

namespace tessera::scheduler {

std::string_view worker_state_name(WorkerState state) {
  switch (state) {
    case WorkerState::kPresent:
      return "present";
    case WorkerState::kDraining:
      return "draining";
    case WorkerState::kSilent:
      return "silent";
    case WorkerState::kForgotten:
      return "forgotten";
  }
  return "unknown";
}

std::string_view worker_activity_name(WorkerActivity activity) {
  switch (activity) {
    case WorkerActivity::kBusy:
      return "busy";
    case WorkerActivity::kIdle:
      return "idle";
    case WorkerActivity::kStuck:
      return "stuck";
    case WorkerActivity::kDraining:
      return "draining";
    case WorkerActivity::kSilent:
      return "silent";
  }
  return "unknown";
}

bool may_become(WorkerState from, WorkerState to) {
  switch (from) {
    case WorkerState::kPresent:
      return to == WorkerState::kDraining || to == WorkerState::kSilent;
    case WorkerState::kDraining:
      return to == WorkerState::kPresent || to == WorkerState::kSilent;
    case WorkerState::kSilent:
      return to != WorkerState::kSilent;
    case WorkerState::kForgotten:
      return false;
  }
  return false;
}

}  // namespace tessera::scheduler
