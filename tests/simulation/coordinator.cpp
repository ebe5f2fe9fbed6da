// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/coordinator.hpp"

#include <algorithm>
#include <utility>

#include "tests/simulation/model_sums.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

constexpr double kParkSeconds = 3.0;
constexpr double kLookSeconds = 0.5;

}  // namespace

bool is_liar(const WorkerId& worker) {
  return worker.value.starts_with(kLiar);
}

namespace {

// A token cannot be made without this number, which liars do not know.
LeaseToken sign(LeaseId lease, const WorkerId& holder, const JobId& job) {
  constexpr std::uint64_t kSecret = 0x5eC4e7;
  return std::to_string(
      std::hash<std::string>{}(fmt::format("{} {} {} {}", kSecret, lease.value, holder.value, job.value)));
}

Options with_signatures(Options options) {
  options.sign = sign;
  return options;
}

}  // namespace

Coordinator::Coordinator(World& world, const Options& options)
    : world_(world), disk_(world), options_(with_signatures(options)), referee_(world, films_, options_) {}

void Coordinator::start() {
  if (up()) return;
  ++run_;
  world_.note(fmt::format("coordinator starts, epoch {}", run_));
  Options options = options_;
  options.epoch = run_;
  options.audit_secret = run_;
  scheduler_ = std::make_unique<Scheduler>(options);
  latest_ = {};
  referee_.restarted(run_);
  for (const Disk::StoredJob& job : disk_.jobs())
    if (!released_.contains(job.id)) restore(job);
  for (const Producer& producer : quarantine_.entries()) handle(Distrust{producer});
  checkpoint(run_);
  look_around(run_);
}

void Coordinator::restore(const Disk::StoredJob& job) {
  films_[job.id] = job.film;
  // Tiles are written before the row that has their number of samples.
  JobShape shape = job.row.shape;
  std::uint32_t most = 0;
  for (int tile = 0; tile < job.film.tile_count(); ++tile) {
    const IntervalSet done = job.film.done(tile);
    if (!done.empty() && done.ranges().back().end > shape.target(tile))
      most = std::max(most, done.ranges().back().end);
  }
  if (most > 0) shape.raise(std::max(most, shape.spp));
  films_[job.id].set_targets(shape);
  RestoreJob event{job.id,          shape, job.row.priority,    job.row.state,
                   job.row.failure, {},    job.row.max_workers, {}};
  for (const auto& [tile, provenance] : job.provenance)
    event.provenance.insert(event.provenance.end(), provenance.begin(), provenance.end());
  for (int tile = 0; tile < job.film.tile_count(); ++tile) event.done.push_back(job.film.done(tile));
  referee_.entered(job.id, job.row.state);
  const Actions actions = handle(event);
  if (!actions.status) world_.fail("a stored job was refused");
  referee_.settled(actions, *scheduler_, clock());
  for (int tile = 0; tile < job.film.tile_count(); ++tile) compare(job.id, tile);
}

void Coordinator::crash() {
  world_.note("coordinator crashes");
  disk_.coordinator_crashed();
  scheduler_.reset();
  parked_.clear();
  films_.clear();
  quarantine_.crashed();
  to_reopen_.clear();
  next_tick_.reset();
  stalled_until_ = {};
}

void Coordinator::stall(Duration duration) {
  world_.note(
      fmt::format("coordinator stalls for {:.1f} s", std::chrono::duration<double>(duration).count()));
  stalled_until_ = std::max(stalled_until_, world_.now() + duration);
}

void Coordinator::clock_jumps(Duration by) {
  world_.note(
      fmt::format("the coordinator's clock jumps by {:.1f} s", std::chrono::duration<double>(by).count()));
  clock_error_ += by;
  next_tick_.reset();
  if (up()) tick_when_due();
}

// Whether the event must wait; if so, it is repeated after the stall.
bool Coordinator::delayed(const std::function<void()>& again) {
  if (world_.now() >= stalled_until_) return false;
  world_.after(stalled_until_ - world_.now(), again);
  return true;
}

void Coordinator::synchronize(const Synchronize& request, const Answer& answer) {
  if (!up() || delayed([=, this] { synchronize(request, answer); })) return;
  const WorkerId id = request.worker.id;
  if (is_foreign(id, request.worker.principal) || is_refused(request.worker)) return;
  parked_.erase(id);  // answered already; its worker does not wait any more
  referee_.answered(id);
  Synchronize call = request;
  const bool drains_anew = must_drain_anew(id);
  call.draining |= drains_anew;
  if (drains_anew) drains_[id].is_known = false;
  const Actions actions = handle(call);
  if (!actions.reply) return world_.fail("Synchronize was not answered");
  if (drains_anew) drain(id);
  if (actions.reply->changed) return answer(*actions.reply);
  park(id, *actions.reply, answer);
}

void Coordinator::park(const WorkerId& id, const Reply& reply, const Answer& answer) {
  const std::uint64_t call = ++calls_;
  parked_[id] = {call, answer};
  referee_.parked(id, reply);
  world_.after(seconds(kParkSeconds), [=, this] { answer_parked(id, call); });
}

void Coordinator::answer_now(const WorkerId& worker, const Reply& reply) {
  const Answer answer = parked_.at(worker).answer;
  parked_.erase(worker);
  referee_.answered(worker);
  answer(reply);
}

void Coordinator::answer_parked(const WorkerId& worker, std::uint64_t call) {
  const auto parked = parked_.find(worker);
  if (parked == parked_.end() || parked->second.call != call) return;
  if (delayed([=, this] { answer_parked(worker, call); })) return;
  const Actions actions = handle(TopUp{worker});
  if (actions.reply) return answer_now(worker, *actions.reply);
  parked_.erase(worker);
  referee_.answered(worker);
}

void Coordinator::wake(const WorkerId& worker) {
  const auto parked = parked_.find(worker);
  if (parked == parked_.end()) return;
  const Actions actions = handle(TopUp{worker});
  if (!actions.reply) return;
  if (actions.reply->changed) return answer_now(worker, *actions.reply);
  referee_.parked(worker, *actions.reply);
}

void Coordinator::submit_result(const SubmitResult& result, const ResultAnswer& answer) {
  if (!up() || delayed([=, this] { submit_result(result, answer); })) return;
  if (is_foreign(result.worker, result.principal) || is_refused(result)) return answer({});
  const bool forged = result.token != options_.sign(result.lease, result.worker, result.job);
  const bool lies = is_liar(result.worker) || forged;
  if (!lies && !result.items.empty() && world_.now() < lacks_film_memory_until_) {
    handle(DeferResult{result.worker, result.lease});  // it is sent again
    return;
  }
  if (lies) catch_up();
  const std::string before = lies ? fingerprint(*scheduler_, clock()) : "";
  const Actions actions = handle(result);
  if (!actions.status && !lies)
    world_.fail("an honest result was refused: " + actions.status.error().message);
  if (!actions.status && lies && fingerprint(*scheduler_, clock()) != before)
    world_.fail("a refused result has changed something");
  if (actions.status && actions.verdicts.size() != result.items.size()) {
    return world_.fail("not every item has a verdict");
  }
  if (actions.status && forged && counts(actions)) world_.fail("a forged result has counted");
  if (!actions.status && !forged) note_refusal(result.worker);
  referee_.judged(result, actions);
  empty_tiles(actions);
  for (std::size_t i = 0; i < actions.verdicts.size(); ++i) {
    if (actions.verdicts[i] != Verdict::kAccepted) continue;
    const bool wrong_bits = fingerprint_of(result, i) != honest_sums(result.job, result.items[i]);
    films_.at(result.job).add(result.items[i]);
    if (wrong_bits) films_.at(result.job).spoil(result.items[i].tile, result.worker);
    disk_.accepted(result.job, result.items[i]);
  }
  referee_.settled(actions, *scheduler_, clock());
  if (actions.reply) referee_.told_with_answer(result, *actions.reply);
  // A row may be stored before its samples.
  if (!actions.job_changes.empty() && world_.random.chance(0.2)) disk_.update(result.job, row_of(result.job));
  if (actions.reply && parked_.contains(result.worker)) referee_.parked(result.worker, *actions.reply);
  answer(actions.reply);
}

bool Coordinator::counts(const Actions& actions) {
  return std::any_of(actions.verdicts.begin(), actions.verdicts.end(),
                     [](Verdict verdict) { return verdict != Verdict::kDropped; });
}

bool Coordinator::submit(const SubmitJob& event) {
  if (event.shape.window.empty()) return handle(event).status.has_value();
  const bool is_known = films_.contains(event.id);
  const JobRow row{event.shape, event.priority, event.max_workers, JobState::kRunning, "", ++revisions_};
  if (!is_known && !disk_.insert(event.id, row)) return false;
  if (!is_known) shapes_[event.id] = event.shape;
  if (!is_known) films_[event.id] = ModelFilm(event.shape);
  if (!is_known) referee_.entered(event.id, JobState::kRunning);
  const bool taken = handle(event).status.has_value();
  if (taken == is_known) world_.fail(fmt::format("job {} was submitted twice", event.id.value));
  return taken;
}

bool Coordinator::remove(const DeleteJob& event) {
  if (films_.contains(event.id) && !disk_.remove(event.id)) return false;
  const bool taken = handle(event).status.has_value();
  if (taken != films_.contains(event.id)) world_.fail(fmt::format("job {} is deleted twice", event.id.value));
  films_.erase(event.id);
  referee_.deleted(event.id);
  return taken;
}

bool Coordinator::command(const Event& event) {
  if (const auto* extend = std::get_if<ExtendJob>(&event)) bring_back(extend->id);
  if (const auto* gone = std::get_if<DeleteJob>(&event)) bring_back(gone->id);
  if (const auto* submitted = std::get_if<SubmitJob>(&event)) return submit(*submitted);
  if (const auto* gone = std::get_if<DeleteJob>(&event)) return remove(*gone);
  catch_up();
  const std::string before = fingerprint(*scheduler_, clock());
  const Actions actions = handle(event);
  const bool taken = actions.status.has_value();
  if (!taken && fingerprint(*scheduler_, clock()) != before)
    world_.fail("a refused command has changed something");
  if (const auto* extend = std::get_if<ExtendJob>(&event); extend != nullptr && taken)
    films_.at(extend->id).extend(extend->spp, extend->tiles);
  referee_.settled(actions, *scheduler_, clock());
  bool stored = taken;
  for (const JobView& job : jobs()) {
    const Disk::StoredJob* const known = disk_.stored(job.id);
    if (taken && known != nullptr && !is_stored_as(known->row, job))
      stored &= disk_.update(job.id, row_of(job.id));
  }
  return stored;
}

void Coordinator::dismiss_any() {
  if (!up()) return;
  const std::vector<WorkerView> known = workers();
  if (known.empty()) return;
  const auto chosen = static_cast<std::size_t>(world_.random.integer(0, static_cast<int>(known.size()) - 1));
  world_.note(fmt::format("worker {} is dismissed", known[chosen].info.id.value));
  handle(Dismiss{known[chosen].info.id});
}

// A lease belongs to the worker to which it was granted, in every run of the coordinator.
void Coordinator::check_holders(const Event& event, const Actions& actions) {
  if (!actions.reply) return;
  WorkerId worker;
  if (const auto* call = std::get_if<Synchronize>(&event)) worker = call->worker.id;
  if (const auto* call = std::get_if<TopUp>(&event)) worker = call->worker;
  if (const auto* call = std::get_if<SubmitResult>(&event)) worker = call->worker;
  bool has_new = false;
  for (const LeaseDescription& lease : actions.reply->leases) {
    const auto [holder, is_new] = holders_.try_emplace(lease.id, worker);
    has_new |= is_new;
    if (holder->second != worker)
      world_.fail(fmt::format("lease {} of worker {} is given to worker {}", lease.id.value,
                              holder->second.value, worker.value));
  }
  check_drained(worker, *actions.reply, has_new, std::holds_alternative<SubmitResult>(event));
}

void Coordinator::catch_up() {
  do {
    handle(Tick{});
  } while (!world_.failure() && scheduler_->next_deadline().value_or(Time::max()) <= latest_);
}

Actions Coordinator::handle(const Event& event) {
  std::vector<JobView> jobs_before = jobs();
  const std::vector<WorkerView> workers_before = workers();
  latest_ = std::max(latest_, clock());
  const Actions actions = scheduler_->handle(event, clock());
  // To leave the scheduler is no change of a job.
  if (const auto* left = std::get_if<ReleaseJob>(&event); left != nullptr && actions.status)
    std::erase_if(jobs_before, [&](const JobView& job) { return job.id == left->id; });
  digest_.add(event, clock(), actions);
  check_holders(event, actions);
  referee_.counted(jobs_before, jobs());
  referee_.changed(jobs_before, jobs(), actions);
  referee_.changed(workers_before, workers(), actions);
  if (const auto wrong = scheduler_->check_invariants(CheckDepth::kEverySample)) world_.fail(*wrong);
  referee_.handled(event, actions, clock());
  follow_audits(actions);
  check_quarantined();
  for (const std::string& stalled : actions.stalled) world_.note(stalled);
  for (const JobChange& change : actions.job_changes) {
    world_.note(fmt::format("job {} is {}", change.id.value, job_state_name(change.to)));
    if (change.to == JobState::kFailed && !std::holds_alternative<FailJob>(event)) {
      failures_[change.id] = scheduler_->job(change.id, clock())->failure;
      world_.note(failures_[change.id]);
    }
  }
  for (const WorkerId& worker : actions.wake) {
    world_.after({}, [this, worker, run = run_] {
      if (up() && run == run_) wake(worker);
    });
  }
  tick_when_due();
  return actions;
}

void Coordinator::tick_when_due() {
  const std::optional<Time> due = scheduler_->next_deadline();
  if (!due || (next_tick_ && *next_tick_ <= *due)) return;
  next_tick_ = due;
  world_.after(*due - clock(), [this, due, run = run_] {
    if (!up() || run != run_ || next_tick_ != due) return;
    next_tick_.reset();
    if (delayed([this, run] {
          if (up() && run == run_) handle(Tick{});
        })) {
      return;
    }
    handle(Tick{});
  });
}

// A stalled coordinator checks nothing, and has some time to catch up.
void Coordinator::look_around(std::uint64_t run) {
  if (!up() || run != run_) return;
  if (world_.now() > stalled_until_ + seconds(kLookSeconds)) referee_.look_around(*scheduler_, clock());
  world_.after(seconds(kLookSeconds), [=, this] { look_around(run); });
}

bool Coordinator::all_settled() const {
  if (!up() || !to_reopen_.empty()) return false;
  const bool has_backlog = scheduler_->next_deadline().value_or(Time::max()) <= latest_;
  if (has_backlog) return false;
  const std::vector<JobView> views = jobs();
  return std::none_of(views.begin(), views.end(), [](const JobView& job) {
    return job.state == JobState::kRunning || job.state == JobState::kPaused;
  });
}

void Coordinator::check_films() {
  referee_.look_around(*scheduler_, clock());
  check_bits();
  for (const auto& [id, film] : films_) {
    for (int tile = 0; tile < film.tile_count(); ++tile) compare(id, tile);
  }
}

void Coordinator::compare(const JobId& id, int tile) {
  if (films_.at(id).done(tile) == scheduler_->done(id, tile)) return;
  world_.fail(fmt::format("job {} tile {}: the film has other samples than the scheduler", id.value, tile));
}

}  // namespace tessera::simulation
