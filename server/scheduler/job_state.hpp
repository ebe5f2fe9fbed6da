// SPDX-License-Identifier: Apache-2.0
// The lifecycle of a job.
//
//                 pause                      cancel
//             ┌──────────▶ PAUSED ─────────────────────┐
//   submit    │◀──────────   │ fail                    ▼
//   ──────▶ RUNNING  resume  └──────▶ FAILED       CANCELLED
//             │ ▲ │ fail ────────────────▲             ▲
//    complete │ │ └── cancel ──────────────────────────┘
//             ▼ │ extend; doubt
//            DONE
//
// Doubt: a worker that rendered some of its samples was quarantined, and others must verify these
// (audits.hpp). CANCELLED and FAILED are final. A job in any state can be deleted. PAUSED has no transition
// to DONE: a paused job whose last samples arrive stays paused, and is done as soon as it is resumed.
#pragma once

#include <cstddef>
#include <string_view>

namespace tessera::scheduler {

enum class JobState { kRunning, kPaused, kDone, kCancelled, kFailed };
inline constexpr std::size_t kJobStates = 5;

// "running", "paused", …, for messages.
std::string_view job_state_name(JobState state);

// Whether the diagram has the transition. No state has a transition to itself.
bool may_become(JobState from, JobState to);

// Whether samples that arrive still count.
inline bool takes_results(JobState state) {
  return state == JobState::kRunning || state == JobState::kPaused || state == JobState::kDone;
}

}  // namespace tessera::scheduler
