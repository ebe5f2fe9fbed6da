// SPDX-License-Identifier: Apache-2.0
// The lifecycle of a lease.
//
//   granted, in a reply that                taken over from a worker that reports it
//   may be lost      │                     │
//                    ▼      reported       ▼
//                 GRANTED ─────────────▶ HELD
//                    └─────────┬──────────┘
//       ┌────────────┬─────────┴──┬────────────┬────────────┐
//       ▼            ▼            ▼            ▼            ▼
//      DONE       RETURNED     EXPIRED      STALLED      REVOKED
//
// DONE: none of its samples is missing, whoever delivered them. RETURNED: its holder has finished with it, or
// does not report it any more. EXPIRED: its holder is lost. STALLED: its holder sends heartbeats, but has
// delivered nothing of the job for too long. REVOKED: its job has ended, or its holder was dismissed. All
// five are final. The missing samples of an ended lease are free again. Results of an ended lease count as
// long as their samples are missing.
#pragma once

#include <cstddef>
#include <string_view>

namespace tessera::scheduler {

enum class LeaseState { kGranted, kHeld, kDone, kReturned, kExpired, kStalled, kRevoked };
inline constexpr std::size_t kLeaseStates = 7;

// "granted", "held", …, for messages.
std::string_view lease_state_name(LeaseState state);

// Whether the diagram has the transition. No state has a transition to itself.
bool may_become(LeaseState from, LeaseState to);

inline bool is_live(LeaseState state) {
  return state == LeaseState::kGranted || state == LeaseState::kHeld;
}

}  // namespace tessera::scheduler
