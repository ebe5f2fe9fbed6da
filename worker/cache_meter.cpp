// SPDX-License-Identifier: Apache-2.0
#include "worker/cache_meter.hpp"

namespace tessera::worker {

const v1::CacheUse& CacheMeter::read(Clock::time_point now) {
  if (measured_at_ && now < *measured_at_ + kInterval) return use_;
  measured_at_ = now;
  use_.set_used_bytes(cache_.used_bytes());
  use_.set_limit_bytes(cache_.max_bytes());
  return use_;
}

}  // namespace tessera::worker
