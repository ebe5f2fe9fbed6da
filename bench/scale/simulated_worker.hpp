// SPDX-License-Identifier: Apache-2.0
// A simulated worker that speaks the real protocol on its own connection but renders nothing: it waits for
// the time that rendering would take, and sends precomputed tiles. Like the real worker (worker/), it keeps
// two leases, delivers each item as soon as it is "rendered", one delivery at a time, takes leases with the
// answer, and always has a Synchronize in progress. All calls are asynchronous; a thousand workers need a
// handful of threads. Thread-safe.
#pragma once

#include <grpcpp/channel.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/scale/ready_tiles.hpp"
#include "bench/scale/tally.hpp"
#include "bench/scale/timeline.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"

namespace tessera::bench {

// The speed of rendering.
struct Speed {
  double samples_per_second = 1;  // where a tile costs 1
  // The cost of a sample of this tile.
  std::function<double(const core::PixelRect&)> cost = [](const core::PixelRect&) { return 1.0; };
  // Whether it waits for the rendering time. Otherwise results are sent at once, and only report the time.
  bool takes_time = true;
};

class SimulatedWorker : public std::enable_shared_from_this<SimulatedWorker> {
 public:
  // What many workers share; must outlive them.
  struct World {
    const ReadyTiles& tiles;
    Timeline& timeline;
    Tally& tally;
  };

  SimulatedWorker(int number, Speed speed, std::shared_ptr<grpc::Channel> channel, World world);

  void start();
  // Cancels its calls and starts no others. A call that is being sent holds a reference.
  void stop();

 private:
  using Clock = Timeline::Clock;
  struct HeldLease {
    std::uint64_t id = 0;
    std::string job_id;
    std::string token;
    std::deque<proto::WorkItem> todo;
    std::optional<proto::WorkItem> rendering;
    std::vector<proto::WorkItem> ready, delivering;
    double ready_seconds = 0;  // the render time of the ready items

    bool is_finished() const { return todo.empty() && !rendering && ready.empty(); }
  };
  template <typename Request, typename Response>
  struct Call {
    std::shared_ptr<SimulatedWorker>
        worker;  // while it is sent. Released after the context, which uses the connection
    grpc::ClientContext context;
    Request request;
    Response response;
    Clock::time_point started = Clock::now();
  };
  using SyncCall = Call<v1::SynchronizeRequest, v1::SynchronizeResponse>;
  using SubmitCall = Call<v1::SubmitResultRequest, v1::SubmitResultResponse>;

  // The caller of these functions holds mutex_.
  void synchronize();
  void synchronized(const SyncCall& call, const grpc::Status& status);
  bool apply(const SyncCall& call);
  bool add_lease(const v1::Lease& lease);
  void note_next_lease();
  void report(v1::SynchronizeRequest& request) const;
  double seconds_for(const proto::WorkItem& item) const;
  void render_next();
  void rendered(std::uint64_t lease_id);
  void deliver_next();
  void submit(std::shared_ptr<SubmitCall> call);
  void delivered(const std::shared_ptr<SubmitCall>& call, const grpc::Status& status);
  HeldLease* find(std::uint64_t lease_id);
  // Calls the action with mutex_ held, unless the worker has stopped.
  template <typename Action>
  void later(double seconds, Action action);

  const std::string key_;
  const std::string id_, name_;
  const Speed speed_;
  const World world_;
  const std::unique_ptr<v1::WorkerService::Stub> stub_;

  std::mutex mutex_;
  // Guarded by mutex_:
  std::deque<HeldLease> leases_;
  std::set<std::string> known_jobs_;
  // Leases since the last Synchronize was sent: delivered, or received with the answer to a delivery.
  std::set<std::uint64_t> just_finished_, just_given_;
  bool rendering_ = false, has_rendered_ = false, delivering_ = false, stopped_ = false;
  std::uint64_t delivered_items_ = 0;
  std::optional<Clock::time_point> waiting_since_;  // since when it has waited for another lease
  std::weak_ptr<SyncCall> sync_call_;
  std::weak_ptr<SubmitCall> submit_call_;
};

}  // namespace tessera::bench
