// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/stall_watch.hpp"

#include <algorithm>

namespace tessera::rpc {

namespace {

constexpr std::chrono::milliseconds kLongestPeriod{1000};

}  // namespace

StallWatch::StallWatch(std::chrono::milliseconds patience)
    : patience_(patience), checker_(std::min(kLongestPeriod, patience / 4), [this] { check(); }) {}

void StallWatch::check() {
  const auto since = WatchedStream::Clock::now() - patience_;
  streams_.for_each([since](WatchedStream& stream) { stream.end_if_waiting_since(since); });
}

}  // namespace tessera::rpc
