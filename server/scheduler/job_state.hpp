// SPDX-License-Identifier: Apache-2.0
// A job's life.
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
// Doubt: a worker that rendered some of it was quarantined, and others are to verify that (audits.hpp).
// CANCELLED and FAILED are final. A job in any state can be deleted. PAUSED has no arrow to DONE: a paused
// job whose last samples come in stays paused, and is done as soon as it is resumed.
#pragma once

#include <string_view>

namespace tessera::scheduler {

enum class JobState { kRunning, kPaused, kDone, kCancelled, kFailed };

// "running", "paused", …: for sentences.
std::string_view job_state_name(JobState state);

// Whether the arrow is drawn above. A state has no arrow to itself.
bool may_become(JobState from, JobState to);

// Whether samples that come in for it still count.
inline bool takes_results(JobState state) {
  return state == JobState::kRunning || state == JobState::kPaused || state == JobState::kDone;
}

}  // namespace tessera::scheduler
