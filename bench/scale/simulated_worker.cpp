// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/simulated_worker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "core/base/determinism_fingerprint.hpp"
#include "proto/worker_key.hpp"

namespace tessera::bench {
namespace {

constexpr std::uint32_t kWantedLeases = 2;
// The delay before a failed call is retried, or a Synchronize without a change is repeated.
constexpr double kRetrySeconds = 0.1, kShortestExchangeSeconds = 0.05;
constexpr std::size_t kMaxItemsPerDelivery = 42;  // 8 MiB of sums
const std::string kArithmetic(core::kDeterminismFingerprint);

// Has the length of a real worker's key.
std::string key_of(int number) {
  return fmt::format("{:048}", number);
}

double seconds_since(Timeline::Clock::time_point start) {
  return Timeline::Seconds(Timeline::Clock::now() - start).count();
}

}  // namespace

SimulatedWorker::SimulatedWorker(int number, Speed speed, std::shared_ptr<grpc::Channel> channel, World world)
    : key_(key_of(number)),
      id_(proto::worker_id_of(key_)),
      name_(fmt::format("simulated-{}", number)),
      speed_(speed),
      world_(world),
      stub_(v1::WorkerService::NewStub(std::move(channel))) {}

void SimulatedWorker::start() {
  const std::lock_guard lock(mutex_);
  synchronize();
}

void SimulatedWorker::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  if (const auto call = sync_call_.lock()) call->context.TryCancel();
  if (const auto call = submit_call_.lock()) call->context.TryCancel();
}

template <typename Action>
void SimulatedWorker::later(double seconds, Action action) {
  world_.timeline.after(Timeline::Seconds(seconds), [self = weak_from_this(), action = std::move(action)] {
    const auto worker = self.lock();
    if (!worker) return;
    const std::lock_guard lock(worker->mutex_);
    if (!worker->stopped_) action(*worker);
  });
}

// ---- Synchronisation ----

void SimulatedWorker::synchronize() {
  auto call = std::make_shared<SyncCall>();
  report(call->request);
  just_finished_.clear();
  just_given_.clear();
  sync_call_ = call;
  call->worker = shared_from_this();
  stub_->async()->Synchronize(&call->context, &call->request, &call->response,
                              [call](const grpc::Status& status) {
                                const std::lock_guard lock(call->worker->mutex_);
                                call->worker->synchronized(*call, status);
                              });
}

void SimulatedWorker::report(v1::SynchronizeRequest& request) const {
  request.set_worker_id(id_);
  request.set_worker_key(key_);
  request.set_name(name_);
  request.set_version("simulated");
  request.set_determinism_fingerprint(kArithmetic);
  request.set_threads(1);
  request.set_wanted_leases(kWantedLeases);
  request.set_names_images(true);
  request.set_renders_layers(true);
  for (const std::string& job : known_jobs_) request.add_known_job_ids(job);
  for (const HeldLease& held : leases_) {
    v1::Lease& lease = *request.add_held();
    lease.set_id(held.id);
    lease.set_job_id(held.job_id);
    lease.set_token(held.token);
    const auto add = [&](const proto::WorkItem& item) { *lease.add_items() = proto::to_proto(item); };
    std::for_each(held.delivering.begin(), held.delivering.end(), add);
    std::for_each(held.ready.begin(), held.ready.end(), add);
    if (held.rendering) add(*held.rendering);
    std::for_each(held.todo.begin(), held.todo.end(), add);
  }
}

void SimulatedWorker::synchronized(const SyncCall& call, const grpc::Status& status) {
  if (stopped_) return;
  world_.tally.note([&](Counts& counts) {
    ++counts.synchronizes;
    counts.sent_bytes += call.request.ByteSizeLong();
    counts.received_bytes += call.response.ByteSizeLong();
    if (!status.ok()) ++counts.failed_calls;
  });
  if (!status.ok()) return later(kRetrySeconds, [](SimulatedWorker& worker) { worker.synchronize(); });
  if (apply(call)) {
    render_next();
    return synchronize();
  }
  const double rest = kShortestExchangeSeconds - seconds_since(call.started);
  if (rest <= 0) return synchronize();
  later(rest, [](SimulatedWorker& worker) { worker.synchronize(); });
}

// Returns whether anything changed.
bool SimulatedWorker::apply(const SyncCall& call) {
  for (const v1::JobSpec& job : call.response.jobs()) known_jobs_.insert(job.job_id());
  std::set<std::uint64_t> wanted = just_given_;
  for (const v1::Lease& lease : call.response.leases()) wanted.insert(lease.id());
  for (HeldLease& held : leases_)
    if (!wanted.contains(held.id)) held.todo.clear();
  std::erase_if(leases_, [&](const HeldLease& held) {
    return !wanted.contains(held.id) && held.is_finished() && held.delivering.empty();
  });
  bool changed = false;
  for (const v1::Lease& lease : call.response.leases()) changed |= add_lease(lease);
  if (changed) note_next_lease();
  return changed;
}

bool SimulatedWorker::add_lease(const v1::Lease& lease) {
  if (find(lease.id()) != nullptr || just_finished_.contains(lease.id())) return false;
  HeldLease held{lease.id(), lease.job_id(), lease.token(), {}, {}, {}, {}, 0};
  for (const v1::WorkItem& item : lease.items())
    if (const auto read = proto::from_proto(item)) held.todo.push_back(*read);
  leases_.push_back(std::move(held));
  return true;
}

void SimulatedWorker::note_next_lease() {
  if (!waiting_since_) return;
  const double waited = seconds_since(*std::exchange(waiting_since_, std::nullopt));
  world_.tally.note([&](Counts& counts) { counts.next_lease_seconds.push_back(waited); });
}

SimulatedWorker::HeldLease* SimulatedWorker::find(std::uint64_t lease_id) {
  const auto held =
      std::find_if(leases_.begin(), leases_.end(), [&](const HeldLease& h) { return h.id == lease_id; });
  return held == leases_.end() ? nullptr : &*held;
}

// ---- Rendering ----

double SimulatedWorker::seconds_for(const proto::WorkItem& item) const {
  const double samples = static_cast<double>(item.rect.pixel_count()) * item.range.count();
  return samples * speed_.cost(item.rect) / speed_.samples_per_second;
}

void SimulatedWorker::render_next() {
  if (rendering_) return;
  const auto next =
      std::find_if(leases_.begin(), leases_.end(), [](const HeldLease& held) { return !held.todo.empty(); });
  if (next == leases_.end()) return;
  next->rendering = next->todo.front();
  next->todo.pop_front();
  rendering_ = true;
  if (!std::exchange(has_rendered_, true))
    world_.tally.note([](Counts& counts) { counts.first_renders.push_back(Clock::now()); });
  const double seconds = speed_.takes_time ? seconds_for(*next->rendering) : 0;
  later(seconds, [id = next->id](SimulatedWorker& worker) { worker.rendered(id); });
}

void SimulatedWorker::rendered(std::uint64_t lease_id) {
  HeldLease& held = *find(lease_id);
  const proto::WorkItem item = *std::exchange(held.rendering, std::nullopt);
  const double seconds = seconds_for(item);
  world_.tally.note([&](Counts& counts) { counts.rendering_seconds += seconds; });
  held.ready.push_back(item);
  held.ready_seconds += seconds;
  rendering_ = false;
  render_next();
  deliver_next();
}

// ---- Delivery ----

void SimulatedWorker::deliver_next() {
  if (delivering_) return;
  const auto next =
      std::find_if(leases_.begin(), leases_.end(), [](const HeldLease& held) { return !held.ready.empty(); });
  if (next == leases_.end()) return;
  auto call = std::make_shared<SubmitCall>();
  v1::SubmitResultRequest& request = call->request;
  const std::size_t count = std::min(next->ready.size(), kMaxItemsPerDelivery);
  const auto end = next->ready.begin() + static_cast<std::ptrdiff_t>(count);
  next->delivering.assign(next->ready.begin(), end);
  next->ready.erase(next->ready.begin(), end);
  for (const proto::WorkItem& item : next->delivering)
    *request.add_items() = world_.tiles.rendered(item, ++delivered_items_);
  request.set_worker_id(id_);
  request.set_version("simulated");
  request.set_determinism_fingerprint(kArithmetic);
  request.set_job_id(next->job_id);
  request.set_lease_id(next->id);
  request.set_lease_token(next->token);
  request.set_lease_finished(next->is_finished());
  if (request.lease_finished())
    for (const HeldLease& other : leases_)
      if (other.id != next->id) request.add_held_lease_ids(other.id);
  const double seconds = std::exchange(next->ready_seconds, 0);
  request.mutable_render_time()->set_seconds(static_cast<std::int64_t>(seconds));
  request.mutable_render_time()->set_nanos(
      static_cast<std::int32_t>(1e9 * (seconds - static_cast<double>(static_cast<std::int64_t>(seconds)))));
  if (request.lease_finished() && !waiting_since_) waiting_since_ = Clock::now();
  delivering_ = true;
  submit(std::move(call));
}

void SimulatedWorker::submit(std::shared_ptr<SubmitCall> call) {
  submit_call_ = call;
  call->worker = shared_from_this();
  stub_->async()->SubmitResult(&call->context, &call->request, &call->response,
                               [call](const grpc::Status& status) {
                                 const std::lock_guard lock(call->worker->mutex_);
                                 call->worker->delivered(call, status);
                               });
}

void SimulatedWorker::delivered(const std::shared_ptr<SubmitCall>& call, const grpc::Status& status) {
  if (stopped_) return;
  if (!status.ok()) {
    world_.tally.note([](Counts& counts) { ++counts.failed_calls; });
    auto again = std::make_shared<SubmitCall>();
    again->request = call->request;
    again->started = call->started;
    return later(kRetrySeconds, [again](SimulatedWorker& worker) { worker.submit(again); });
  }
  world_.tally.note([&](Counts& counts) {
    ++counts.results;
    counts.items += call->response.accepted_items();
    counts.dropped_items += call->response.dropped_items();
    for (const v1::RenderedItem& item : call->request.items()) counts.samples += item.counters().samples();
    counts.leases += call->request.lease_finished() ? 1 : 0;
    counts.sent_bytes += call->request.ByteSizeLong();
    counts.received_bytes += call->response.ByteSizeLong();
    counts.submit_seconds.push_back(seconds_since(call->started));
  });
  delivering_ = false;
  const std::uint64_t id = call->request.lease_id();
  for (const proto::WorkItem& item : find(id)->delivering) world_.tally.note_counted(item.rect);
  find(id)->delivering.clear();
  if (call->request.lease_finished()) {
    just_finished_.insert(id);
    std::erase_if(leases_, [&](const HeldLease& held) { return held.id == id; });
  }
  for (const v1::JobSpec& job : call->response.jobs()) known_jobs_.insert(job.job_id());
  for (const v1::Lease& lease : call->response.new_leases())
    if (add_lease(lease)) just_given_.insert(lease.id());
  if (call->response.new_leases_size() > 0) note_next_lease();
  render_next();
  deliver_next();
}

}  // namespace tessera::bench
