// SPDX-License-Identifier: Apache-2.0
// The principal of a worker's call, as the farm knows it. A pure function.
#pragma once

#include "server/auth/principal.hpp"
#include "server/farm/waiting_calls.hpp"

namespace tessera::rpc {

// Losses and refusals count for an individual principal, and else for name and machine together: machines may
// share a token, and callers an address.
inline farm::WorkerPrincipal principal_of(const auth::Principal& caller) {
  return {.name = caller.name,
          .individual = caller.individual,
          .origin = caller.individual ? caller.name : caller.name + " at " + caller.machine,
          .peer = caller.machine};
}

}  // namespace tessera::rpc
