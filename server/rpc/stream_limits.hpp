// SPDX-License-Identifier: Apache-2.0
// What calls share: their counts, the quotas of uploads, downloads and watchers, memory for images and
// answers, and the watch over stalled streams. Thread-safe.
#pragma once

#include "server/base/fair_queue.hpp"
#include "server/base/fair_share.hpp"
#include "server/limits.hpp"
#include "server/rpc/call_stats.hpp"
#include "server/rpc/stall_watch.hpp"

namespace tessera::rpc {

// Images that may wait for memory.
inline constexpr std::uint64_t kMaxWaitingImages = 64;

struct StreamLimits {
  StreamLimits(const server::Limits& l, CallStats& c)
      : limits(l),
        calls(c),
        uploads(l.uploads),
        fetches(l.fetches),
        watches(l.watches),
        answers(l.answer_mib * server::kMib),
        image_mib(l.image_mib, kMaxWaitingImages),
        stalls(l.stall_time) {}

  const server::Limits& limits;
  CallStats& calls;
  base::FairShare uploads, fetches, watches;
  base::FairShare answers;  // bytes of unary answers that callers have not read yet
  base::FairQueue image_mib;
  StallWatch stalls;
};

}  // namespace tessera::rpc
