// SPDX-License-Identifier: Apache-2.0
#include "client/farm/interruption.hpp"

#include <chrono>

#include "client/interrupt.hpp"

namespace tessera::client {
namespace {

constexpr auto kLookEvery = std::chrono::milliseconds(50);

}  // namespace

bool sleep_unless_interrupted(proto::Duration duration) {
  const auto end = std::chrono::steady_clock::now() + duration;
  while (std::chrono::steady_clock::now() < end && !interrupted()) std::this_thread::sleep_for(kLookEvery);
  return !interrupted();
}

std::jthread cancel_at_interrupt(grpc::ClientContext& context) {
  return std::jthread([&context](const std::stop_token& done) {
    while (!done.stop_requested() && !interrupted()) std::this_thread::sleep_for(kLookEvery);
    if (interrupted()) context.TryCancel();
  });
}

}  // namespace tessera::client
