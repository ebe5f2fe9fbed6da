// SPDX-License-Identifier: Apache-2.0
// The simulated workers of one farm with their connections, which share one thread of timers. Not
// thread-safe.
#pragma once

#include <grpcpp/channel.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "bench/scale/ready_tiles.hpp"
#include "bench/scale/simulated_worker.hpp"
#include "bench/scale/tally.hpp"
#include "bench/scale/timeline.hpp"
#include "core/base/error.hpp"
#include "core/film/layers.hpp"

namespace tessera::bench {

class SimulatedWorkers {
 public:
  // The tally must outlive it. `layers`: of all jobs.
  explicit SimulatedWorkers(Tally& tally, const core::LayerSet& layers = {})
      : tally_(tally), tiles_(layers) {}
  // Waits for the end of their calls and connections.
  ~SimulatedWorkers();
  SimulatedWorkers(const SimulatedWorkers&) = delete;
  SimulatedWorkers& operator=(const SimulatedWorkers&) = delete;

  // Starts this many, one after the other, as on machines that start a program over a network. Blocks for a
  // millisecond each.
  core::Status start(int count, const Speed& speed, const std::string& address);
  // Ends one as if its process was killed: its connection closes (but for that of the last worker), and what
  // it has not delivered is lost.
  void kill(std::size_t worker);

 private:
  Tally& tally_;
  // Of the last worker. The last owner of a worker can be a thread of gRPC's, and gRPC 1.51 stops these
  // threads with the last connection: on one of them it would free its queue twice. So this one ends here,
  // after those of all workers.
  std::shared_ptr<grpc::Channel> last_connection_;
  const ReadyTiles tiles_;
  Timeline timeline_;
  std::atomic<int> alive_ = 0;  // counted down when a worker's destructor has ended
  std::vector<std::shared_ptr<SimulatedWorker>> workers_;  // null where one was killed
};

}  // namespace tessera::bench
