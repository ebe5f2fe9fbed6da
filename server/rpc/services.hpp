// SPDX-License-Identifier: Apache-2.0
// What every way to call a coordinator shares, so that quotas, queues and limits hold for all of them
// together. Plain references.
#pragma once

#include "server/auth/auth_interceptor.hpp"
#include "server/coordinator.hpp"
#include "server/rpc/pools.hpp"
#include "server/rpc/readiness.hpp"
#include "server/rpc/server_info.hpp"
#include "server/rpc/stream_limits.hpp"
#include "server/rpc/validation_queue.hpp"
#include "server/rpc/watch_hub.hpp"

namespace tessera::rpc {

struct Services {
  server::Coordinator& coordinator;
  auth::AuthInterceptor& gate;
  Pools pools;
  ValidationQueue& validations;
  WatchHub& watches;
  StreamLimits& streams;
  const ServerFacts& facts;
  const Readiness& readiness;
};

}  // namespace tessera::rpc
