// SPDX-License-Identifier: Apache-2.0
// A lease's life.
//
//   given, in a reply that                 taken over from a worker that reports it
//   may be lost      │                     │
//                    ▼      reported       ▼
//                 GRANTED ─────────────▶ HELD
//                    └─────────┬──────────┘
//       ┌────────────┬─────────┴──┬────────────┬────────────┐
//       ▼            ▼            ▼            ▼            ▼
//      DONE       RETURNED     EXPIRED      STALLED      REVOKED
//
// DONE: nothing of it is left to do, whoever did it. RETURNED: its holder has finished with it, or reports it
// no more. EXPIRED: its holder is lost. STALLED: its holder is heard of, and has delivered nothing
// of the job for too long. REVOKED: its job has ended, or its holder was dismissed. All five are final. What
// is missing of a lease that has ended is free again, and what comes of it all the same counts as long as it
// is missing.
#pragma once

#include <string_view>

namespace tessera::scheduler {

enum class LeaseState { kGranted, kHeld, kDone, kReturned, kExpired, kStalled, kRevoked };

// "granted", "held", …: for sentences.
std::string_view lease_state_name(LeaseState state);

// Whether the arrow is drawn above. A state has no arrow to itself.
bool may_become(LeaseState from, LeaseState to);

inline bool is_live(LeaseState state) {
  return state == LeaseState::kGranted || state == LeaseState::kHeld;
}

}  // namespace tessera::scheduler
