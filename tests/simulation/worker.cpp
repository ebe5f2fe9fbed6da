// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/worker.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "tests/simulation/model_sums.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

constexpr double kCallTimeoutSeconds = 5.0;
constexpr double kResendSeconds = 1.5;
// How long a machine stays off after the coordinator has told it to stop.
constexpr double kLongestStopSeconds = 20;
// A render checks at this interval whether the machine's speed has changed.
constexpr double kLongestStepSeconds = 1.0;

// Real workers deliver adjacent ranges as one.
std::vector<WorkItem> joined(const std::vector<WorkItem>& items) {
  std::vector<WorkItem> result;
  for (const WorkItem& item : items) {
    const bool continues =
        !result.empty() && result.back().tile == item.tile && result.back().samples.end == item.samples.begin;
    if (continues) {
      result.back().samples.end = item.samples.end;
    } else {
      result.push_back(item);
    }
  }
  return result;
}

}  // namespace

WorkerMachine::WorkerMachine(World& world, Coordinator& coordinator, std::string host,
                             double samples_per_second, std::string name)
    : world_(world),
      coordinator_(coordinator),
      host_(std::move(host)),
      name_(name.empty() ? host_ : std::move(name)),
      samples_per_second_(samples_per_second),
      wanted_leases_(world.random.integer(1, 3)),
      items_per_delivery_(static_cast<std::size_t>(world.random.integer(1, 12))),
      takes_with_answers_(items_per_delivery_ % 4 != 0) {}

void WorkerMachine::start() {
  start_again_ = running_ && (stop_pending_ || stopping_);
  if (running_) return;
  ++process_;
  // Sorts at random, as real ids do.
  const std::string process = fmt::format("{}.{}", host_, process_);
  id_ = fmt::format("{:04}.{}", std::hash<std::string>{}(process) % 10'000, process);
  world_.note(fmt::format("{}.{} starts", host_, process_));
  running_ = true;
  stop_pending_ = stopping_ = false;
  rendering_.reset();
  hung_until_ = stuck_until_ = {};
  fetching_.clear();
  held_.clear();
  outbox_.clear();
  coordinator_.introduce(info());
  synchronize();
}

WorkerInfo WorkerMachine::info() const {
  return {.id = {id_},
          .name = name_,
          .version = "0.1.0",
          .threads = 1,
          .machine = host_,
          .origin = principal_,
          .principal = principal_,
          .individual = !principal_.empty(),
          .capabilities = {.names_images = true, .renders_layers = renders_layers_}};
}

void WorkerMachine::crash() {
  if (running_) world_.note(fmt::format("{}.{} crashes", host_, process_));
  running_ = false;
}

void WorkerMachine::die_of(const JobId& job, const WorkItem& item) {
  deadly_.push_back({job, item});
}

void WorkerMachine::never_ends(const JobId& job, const WorkItem& item) {
  endless_.push_back({job, item});
}

bool WorkerMachine::any_holds(const std::vector<Trap>& traps, const JobId& job, const WorkItem& item) {
  return std::any_of(traps.begin(), traps.end(), [&](const Trap& trap) {
    return trap.job == job && trap.item.tile == item.tile && trap.item.samples.begin < item.samples.end &&
           item.samples.begin < trap.item.samples.end;
  });
}

void WorkerMachine::hang(Duration duration) {
  world_.note(fmt::format("{}.{} hangs for {:.1f} s", host_, process_,
                          std::chrono::duration<double>(duration).count()));
  hung_until_ = world_.now() + duration;
}

void WorkerMachine::get_stuck(Duration duration) {
  world_.note(fmt::format("{}.{} renders nothing for {:.1f} s", host_, process_,
                          std::chrono::duration<double>(duration).count()));
  stuck_until_ = world_.now() + duration;
}

void WorkerMachine::slow_down(double factor, Duration duration) {
  world_.note(fmt::format("{} is {:.0f} times slower for {:.1f} s", host_, factor,
                          std::chrono::duration<double>(duration).count()));
  slowness_ = factor;
  slow_until_ = world_.now() + duration;
}

void WorkerMachine::cut_off(Duration duration) {
  world_.note(
      fmt::format("{} is cut off for {:.1f} s", host_, std::chrono::duration<double>(duration).count()));
  cut_off_until_ = world_.now() + duration;
}

void WorkerMachine::send(const std::function<void()>& deliver) {
  if (world_.now() >= cut_off_until_) world_.send(deliver);
}

void WorkerMachine::later(Duration delay, std::function<void()> what) {
  world_.after(delay, [this, what = std::move(what), process = process_] {
    if (!running_ || process != process_) return;
    if (world_.now() < hung_until_) return later(hung_until_ - world_.now(), what);
    what();
  });
}

void WorkerMachine::synchronize() {
  Synchronize request{info(), {}, wanted_leases_, stopping_};
  for (const Held& held : held_) {
    if (stopping_) break;
    LeaseDescription lease{held.id, held.job, held.sent, held.token};
    lease.items.insert(lease.items.end(), held.rendered.begin(), held.rendered.end());
    lease.items.insert(lease.items.end(), held.to_render.begin(), held.to_render.end());
    if (!lease.items.empty()) request.held.push_back(std::move(lease));
  }
  request.fetching = fetching();
  if (rendering_) request.rendering = {rendering_->lease, rendering_->job, rendering_->item};
  just_given_.clear();
  just_finished_.clear();
  const std::uint64_t call = ++call_;
  const auto answer = [=, this, process = process_](const Reply& reply) {
    send([=, this] {
      if (process == process_) later({}, [=, this] { take_reply(call, reply); });
    });
  };
  send([=, this] { coordinator_.synchronize(request, answer); });
  later(seconds(kCallTimeoutSeconds), [=, this] {
    if (call == call_) synchronize();
  });
}

void WorkerMachine::take_reply(std::uint64_t call, const Reply& reply) {
  if (call != call_) return;
  if (reply.stop && !stopping_) return stop_as_told();
  const auto wanted = [&](const Held& held) {
    return just_given_.contains(held.id) || std::any_of(reply.leases.begin(), reply.leases.end(),
                                                        [&](const auto& l) { return l.id == held.id; });
  };
  // Results that were sent are sent again; other unwanted samples are dropped.
  std::erase_if(held_, [&](const Held& held) { return !wanted(held); });
  take_new(reply);
  if (!stopping_) synchronize();
  render_next();
}

// Its operator starts it again after a while.
void WorkerMachine::stop_as_told() {
  stop();
  world_.after(seconds(world_.random.real(1, kLongestStopSeconds)), [this] { start(); });
}

void WorkerMachine::take_new(const Reply& reply) {
  for (const LeaseDescription& lease : reply.leases) {
    if (find(lease.id) != nullptr || just_finished_.contains(lease.id)) continue;
    if (!renders_layers_ && coordinator_.has_layers(lease.job))
      world_.fail(fmt::format("{} was given layers, which it does not render", host_));
    held_.push_back({lease.id, lease.job, in_pieces(lease.items), {}, {}, 0, 0, false, lease.token});
    just_given_.insert(lease.id);
  }
  fetch_what_is_new();
}

// Fetching continues after the leases went to others.
void WorkerMachine::fetch_what_is_new() {
  for (const Held& held : held_) {
    const JobId job = held.job;
    if (is_here(job) || !fetching_.insert(job).second) continue;
    later(fetch_time_, [=, this] {
      fetching_.erase(job);
      here_.insert(job);
      render_next();
    });
  }
}

std::set<JobId> WorkerMachine::fetching() const {
  if (!feigns_) return fetching_;
  std::set<JobId> jobs;
  for (const Held& held : held_) jobs.insert(held.job);
  return jobs;
}

void WorkerMachine::render_next() {
  if (rendering_ || stopping_ || feigns_) return;
  const auto next = std::find_if(held_.begin(), held_.end(), [this](const Held& held) {
    return !held.to_render.empty() && is_here(held.job);
  });
  if (next == held_.end()) return;
  if (unbuildable_.contains(next->job)) return give_back(*next);
  const WorkItem item = next->to_render.front();
  if (any_holds(deadly_, next->job, item)) {
    crash();
    return world_.after(seconds(world_.random.real(0.5, 5)), [this] { start(); });
  }
  rendering_ = {next->id,
                next->job,
                item,
                world_.random.real(0.8, 1.3),
                coordinator_.tile_pixels(next->job, item.tile) * item.samples.count(),
                0,
                any_holds(endless_, next->job, item),
                next->token};
  if (rendering_->endless) {
    has_been_at_no_end_ = true;
    return world_.note(fmt::format("{}.{} comes to no end", host_, process_));
  }
  render_on();
}

void WorkerMachine::render_on() {
  const double slowness = world_.now() < slow_until_ ? slowness_ : 1;
  const double speed = samples_per_second_ / slowness / rendering_->factor;
  const double step = std::min(kLongestStepSeconds, rendering_->samples_left / speed);
  later(seconds(step), [=, this] {
    if (stopping_) return;
    if (world_.now() < stuck_until_) return later(stuck_until_ - world_.now(), [this] { render_on(); });
    rendering_->spent_seconds += step;
    rendering_->samples_left -= step * speed;
    rendering_->samples_left < 1 ? rendered() : render_on();
  });
}

void WorkerMachine::rendered() {
  const Rendering done = *std::exchange(rendering_, std::nullopt);
  if (Held* const held = find(done.lease)) {
    std::erase(held->to_render, done.item);
    held->rendered.push_back(done.item);
    held->render_seconds += done.spent_seconds;
    held->lease_seconds += done.spent_seconds;
    if (held->to_render.empty())
      longest_lease_seconds_ = std::max(longest_lease_seconds_, held->lease_seconds);
    if (held->to_render.empty() || held->rendered.size() >= items_per_delivery_) {
      deliver(*held, held->to_render.empty());
    }
  } else if (world_.random.chance(0.5)) {
    // It is no longer wanted, but may still be missing.
    Held late{done.lease, done.job, {}, {done.item}, {}, done.spent_seconds, 0, false, done.token};
    deliver(late, false);
  }
  render_next();
}

void WorkerMachine::give_back(Held& held) {
  held.to_render.clear();
  deliver(held, true, "material 'stone': there is no such file");
}

void WorkerMachine::deliver(Held& held, bool finished, const std::string& decline_reason) {
  const std::uint64_t delivery = ++deliveries_;
  if (splits_) held.rendered = joined(held.rendered);
  outbox_[delivery] = {{id_},          held.job,      held.id, held.rendered, held.render_seconds, finished,
                       decline_reason, sums_of(held), {},      held.token};
  outbox_[delivery].principal = principal_;
  // Real workers deliver one result after the other.
  const bool takes = finished && takes_with_answers_ && decline_reason.empty() && outbox_.size() == 1;
  if (takes && !stopping_) outbox_[delivery].held = held_besides(held);
  held.sent.insert(held.sent.end(), held.rendered.begin(), held.rendered.end());
  held.rendered.clear();
  held.render_seconds = 0;
  held.finished = finished;
  send_until_heard(delivery);
}

std::vector<LeaseId> WorkerMachine::held_besides(const Held& held) const {
  std::vector<LeaseId> others;
  for (const Held& other : held_)
    if (other.id != held.id) others.push_back(other.id);
  return others;
}

std::vector<Fingerprint> WorkerMachine::sums_of(const Held& held) {
  std::vector<Fingerprint> sums;
  for (const WorkItem& item : held.rendered) {
    const bool lie = lies_ > 0 && world_.random.chance(lies_);
    const int flipped = lie ? world_.random.integer(1, 1'000'000'000) : 0;
    sums.push_back(wrong_sums(held.job, item, static_cast<std::uint64_t>(flipped)));
  }
  return sums;
}

std::deque<WorkItem> WorkerMachine::in_pieces(const std::vector<WorkItem>& items) {
  std::deque<WorkItem> pieces;
  for (WorkItem item : items) {
    if (splits_ && item.samples.count() > 1 && world_.random.chance(0.3)) {
      const auto first =
          static_cast<std::uint32_t>(world_.random.integer(1, static_cast<int>(item.samples.count()) - 1));
      pieces.push_back({item.tile, {item.samples.begin, item.samples.begin + first}});
      item.samples.begin += first;
    }
    pieces.push_back(item);
  }
  return pieces;
}

void WorkerMachine::send_until_heard(std::uint64_t delivery) {
  const auto result = outbox_.find(delivery);
  if (result == outbox_.end()) return;
  const auto answer = [=, this, process = process_](const std::optional<Reply>& reply) {
    send([=, this] {
      if (process == process_) later({}, [=, this] { heard(delivery, reply); });
    });
  };
  send([=, this, message = result->second] { coordinator_.submit_result(message, answer); });
  later(seconds(kResendSeconds), [=, this] { send_until_heard(delivery); });
}

void WorkerMachine::heard(std::uint64_t delivery, const std::optional<Reply>& reply) {
  const auto result = outbox_.find(delivery);
  if (result == outbox_.end()) return;
  if (Held* const held = find(result->second.lease)) {
    for (const WorkItem& item : result->second.items) std::erase(held->sent, item);
    if (result->second.lease_finished)
      std::erase_if(held_, [&](const Held& h) { return h.id == result->second.lease; });
  }
  const bool finished = result->second.lease_finished;
  const std::vector<LeaseId> named = result->second.held;
  if (finished) just_finished_.insert(result->second.lease);
  outbox_.erase(result);
  if (stopping_) return exit_if_idle();
  if (reply) {
    Reply news = *reply;
    std::erase_if(news.leases, [&](const LeaseDescription& lease) {
      return std::find(named.begin(), named.end(), lease.id) != named.end();
    });
    take_new(news);
    return render_next();
  }
  if (finished && !takes_with_answers_) synchronize();
}

void WorkerMachine::stop() {
  if (!running_ || stopping_) return;
  stop_pending_ = world_.now() < hung_until_;
  if (stop_pending_) return later({}, [this] { stop(); });
  world_.note(fmt::format("{}.{} stops", host_, process_));
  stopping_ = true;
  if (rendering_) hand_back_current_range();
  for (Held& held : held_) {
    if (!held.finished) deliver(held, true);
  }
  synchronize();
  exit_if_idle();
}

// As many samples of the current range as there was time for.
void WorkerMachine::hand_back_current_range() {
  Held* const current = find(rendering_->lease);
  if (current == nullptr) return;
  WorkItem part = rendering_->item;
  const double pixels = coordinator_.tile_pixels(rendering_->job, part.tile);
  const double samples = part.samples.count() - rendering_->samples_left / pixels;
  part.samples.end = part.samples.begin + static_cast<std::uint32_t>(std::max(samples, 0.0));
  if (part.samples.empty()) return;
  current->rendered.push_back(part);
  current->render_seconds += rendering_->spent_seconds;
}

void WorkerMachine::exit_if_idle() {
  if (!outbox_.empty()) return;
  running_ = false;
  if (start_again_) start();
}

WorkerMachine::Held* WorkerMachine::find(LeaseId id) {
  const auto found =
      std::find_if(held_.begin(), held_.end(), [&](const Held& held) { return held.id == id; });
  return found == held_.end() ? nullptr : &*found;
}

}  // namespace tessera::simulation
