// What streams share: places for uploads, memory for pictures, and patience with callers that stand still.
// Thread-safe.
#pragma once

#include "server/coordinator/fair_share.hpp"
#include "server/limits.hpp"
#include "server/rpc/stall_watch.hpp"

namespace tessera::rpc {

struct StreamLimits {
  explicit StreamLimits(const server::Limits& l)
      : limits(l), uploads(l.uploads), image_mib(l.image_mib), stalls(l.stall_time) {}

  const server::Limits& limits;
  coordinator::FairShare uploads, image_mib;
  StallWatch stalls;
};

}  // namespace tessera::rpc
