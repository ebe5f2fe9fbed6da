// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/lease_state.hpp"

namespace tessera::scheduler {

std::string_view lease_state_name(LeaseState state) {
  switch (state) {
    case LeaseState::kGranted:
      return "granted";
    case LeaseState::kHeld:
      return "held";
    case LeaseState::kDone:
      return "done";
    case LeaseState::kReturned:
      return "returned";
    case LeaseState::kExpired:
      return "expired";
    case LeaseState::kStalled:
      return "stalled";
    case LeaseState::kRevoked:
      return "revoked";
  }
  return "unknown";
}

bool may_become(LeaseState from, LeaseState to) {
  switch (from) {
    case LeaseState::kGranted:
      return to != LeaseState::kGranted;
    case LeaseState::kHeld:
      return !is_live(to);
    case LeaseState::kDone:
    case LeaseState::kReturned:
    case LeaseState::kExpired:
    case LeaseState::kStalled:
    case LeaseState::kRevoked:
      return false;
  }
  return false;
}

}  // namespace tessera::scheduler
