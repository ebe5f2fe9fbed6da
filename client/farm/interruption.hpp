// SPDX-License-Identifier: Apache-2.0
// Waiting that Ctrl-C interrupts: a signal by itself ends neither a sleep nor a call. Requires
// watch_for_interrupt().
#pragma once

#include <grpcpp/client_context.h>

#include <thread>

#include "proto/retry.hpp"

namespace tessera::client {

// Waits for `duration`, or until interrupted(). Returns whether the whole time has passed.
bool sleep_unless_interrupted(proto::Duration duration);

// Cancels a call when interrupted(), as long as the returned thread lives. `context` must outlive it.
[[nodiscard]] std::jthread cancel_at_interrupt(grpc::ClientContext& context);

}  // namespace tessera::client
