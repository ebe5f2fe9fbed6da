// SPDX-License-Identifier: Apache-2.0
// How full the cache folder is, for heartbeats: measured every few seconds, since it takes reading the sizes
// of all files. For one thread.
#pragma once

#include <chrono>
#include <optional>

#include "tessera/v1/types.pb.h"
#include "worker/blob_cache.hpp"

namespace tessera::worker {

class CacheMeter {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kInterval{5};

  // The cache must outlive it.
  explicit CacheMeter(const BlobCache& cache) : cache_(cache) {}

  // As it was at most kInterval before `now`.
  const v1::CacheUse& read(Clock::time_point now = Clock::now());

 private:
  const BlobCache& cache_;
  std::optional<Clock::time_point> measured_at_;
  v1::CacheUse use_;
};

}  // namespace tessera::worker
