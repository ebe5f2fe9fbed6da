// SPDX-License-Identifier: Apache-2.0
// Waiting that ends at Ctrl-C: a signal alone ends neither a sleep nor a call. For after
// watch_for_interrupt().
#pragma once

#include <grpcpp/client_context.h>

#include <thread>

#include "proto/retry.hpp"

namespace tessera::client {

// Waits a while, or until interrupted(). Returns whether all the time has passed.
bool sleep_unless_interrupted(proto::Duration duration);

// Cancels a call when interrupted(), for as long as the answer lives. `context` must outlive it.
[[nodiscard]] std::jthread cancel_at_interrupt(grpc::ClientContext& context);

}  // namespace tessera::client
