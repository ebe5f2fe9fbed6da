// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/simulated_workers.hpp"

#include <chrono>
#include <thread>
#include <utility>

#include "bench/scale/farm_client.hpp"

namespace tessera::bench {
namespace {

using namespace std::chrono_literals;

constexpr auto kBetweenArrivals = 1ms;

}  // namespace

SimulatedWorkers::~SimulatedWorkers() {
  for (std::size_t i = 0; i < workers_.size(); ++i) kill(i);
  // Calls in progress hold their workers until they have ended.
  while (alive_ > 0) std::this_thread::sleep_for(1ms);
}

core::Status SimulatedWorkers::start(int count, const Speed& speed, const std::string& address) {
  for (int i = 0; i < count; ++i) {
    auto channel = own_connection(address);
    if (!channel) return core::fail(channel.error());
    last_connection_ = *std::move(channel);
    ++alive_;
    workers_.emplace_back(
        new SimulatedWorker(i, speed, last_connection_, SimulatedWorker::World{tiles_, timeline_, tally_}),
        [this](const SimulatedWorker* worker) {
          delete worker;
          --alive_;
        });
    workers_.back()->start();
    std::this_thread::sleep_for(kBetweenArrivals);
  }
  return {};
}

void SimulatedWorkers::kill(std::size_t worker) {
  const std::shared_ptr<SimulatedWorker> killed = std::move(workers_[worker]);
  if (!killed) return;
  killed->stop();
}

}  // namespace tessera::bench
