#include "tests/simulation/coordinator.hpp"

#include <algorithm>
#include <utility>

namespace tessera::simulation {

using namespace scheduler;

namespace {

constexpr double kCheckpointSeconds = 2.0;
constexpr double kParkSeconds = 3.0;

}  // namespace

Coordinator::Coordinator(World& world) : world_(world) {}

void Coordinator::start() {
  if (up()) return;
  ++run_;
  world_.note(fmt::format("coordinator starts, epoch {}", run_));
  Options options;
  options.epoch = run_;
  scheduler_ = std::make_unique<Scheduler>(options);
  for (const auto& [id, job] : stored_) {
    films_[id] = job.film;
    RestoreJob restore{id, job.shape, job.priority, job.state, "", {}};
    for (int tile = 0; tile < job.film.tile_count(); ++tile) restore.done.push_back(job.film.done(tile));
    if (!handle(restore).status) world_.fail("a stored job was refused");
  }
  checkpoint_regularly(run_);
}

void Coordinator::crash() {
  world_.note("coordinator crashes");
  scheduler_.reset();
  parked_.clear();
  films_.clear();
  next_tick_.reset();
  stalled_until_ = {};
}

void Coordinator::stall(Duration duration) {
  world_.note(
      fmt::format("coordinator stalls for {:.1f} s", std::chrono::duration<double>(duration).count()));
  stalled_until_ = world_.now() + duration;
}

// Whether the event must wait; if so it comes again when the stall is over.
bool Coordinator::delayed(const std::function<void()>& again) {
  if (world_.now() >= stalled_until_) return false;
  world_.after(stalled_until_ - world_.now(), again);
  return true;
}

void Coordinator::synchronize(const Synchronize& request, const Answer& answer) {
  if (!up() || delayed([=, this] { synchronize(request, answer); })) return;
  const WorkerId id = request.worker.id;
  if (id.value == "liar") {
    for (const LeaseDescription& held : request.held) claimed_.insert(held.id);
  }
  parked_.erase(id);  // answered at once, which its worker does not wait for any more
  const Actions actions = handle(request);
  if (!actions.reply) return world_.fail("Synchronize was not answered");
  if (actions.reply->changed) return answer(*actions.reply);
  const std::uint64_t call = ++calls_;
  parked_[id] = {call, answer};
  world_.after(seconds(kParkSeconds), [=, this] { answer_parked(id, call); });
}

void Coordinator::answer_parked(const WorkerId& worker, std::uint64_t call) {
  const auto parked = parked_.find(worker);
  if (parked == parked_.end() || parked->second.call != call) return;
  if (delayed([=, this] { answer_parked(worker, call); })) return;
  const Answer answer = parked->second.answer;
  parked_.erase(parked);
  const Actions actions = handle(TopUp{worker});
  if (actions.reply) answer(*actions.reply);
}

void Coordinator::wake(const WorkerId& worker) {
  const auto parked = parked_.find(worker);
  if (parked == parked_.end()) return;
  const Actions actions = handle(TopUp{worker});
  if (!actions.reply || !actions.reply->changed) return;
  const Answer answer = parked->second.answer;
  parked_.erase(worker);
  answer(*actions.reply);
}

void Coordinator::submit_result(const SubmitResult& result, const std::function<void()>& answer) {
  if (!up() || delayed([=, this] { submit_result(result, answer); })) return;
  const Actions actions = handle(result);
  if (!actions.status && result.worker.value != "liar" && !claimed_.contains(result.lease))
    world_.fail("an honest result was refused: " + actions.status.error().message);
  if (actions.status && actions.verdicts.size() != result.items.size()) {
    return world_.fail("not every item has a verdict");
  }
  for (std::size_t i = 0; i < actions.verdicts.size(); ++i) {
    if (actions.verdicts[i] == Verdict::kDropped) continue;
    if (!films_[result.job].add(result.items[i])) {
      world_.fail(fmt::format("job {} tile {} samples [{}, {}) counted twice", result.job.value,
                              result.items[i].tile, result.items[i].samples.begin,
                              result.items[i].samples.end));
    }
  }
  answer();
}

bool Coordinator::command(const Event& event) {
  const bool taken = handle(event).status.has_value();
  if (const auto* submit = std::get_if<SubmitJob>(&event); submit != nullptr && taken) {
    films_[submit->id] = ModelFilm(submit->shape);
    stored_.emplace_back(submit->id,
                         Stored{submit->shape, submit->priority, JobState::kRunning, films_[submit->id]});
  }
  if (const auto* extend = std::get_if<ExtendJob>(&event); extend != nullptr && taken) {
    films_[extend->id].extend(extend->spp);
  }
  if (const auto* gone = std::get_if<DeleteJob>(&event); gone != nullptr && taken) {
    films_.erase(gone->id);
    std::erase_if(stored_, [&](const auto& entry) { return entry.first == gone->id; });
  }
  store_jobs();
  return taken;
}

Actions Coordinator::handle(const Event& event) {
  const Actions actions = scheduler_->handle(event, world_.now());
  if (const auto wrong = scheduler_->check_invariants(CheckDepth::kEverySample)) world_.fail(*wrong);
  for (const JobChange& change : actions.job_changes) {
    world_.note(fmt::format("job {} is {}", change.id.value, job_state_name(change.to)));
    if (change.to == JobState::kFailed && !std::holds_alternative<FailJob>(event)) {
      failures_[change.id] = scheduler_->job(change.id, world_.now())->failure;
      world_.note(failures_[change.id]);
    }
  }
  if (!actions.job_changes.empty()) store_jobs();
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
  world_.after(*due - world_.now(), [this, due, run = run_] {
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

// The state and the shape of jobs are stored when they change, films only now and then: a job can be stored
// as done whose film still lacks samples.
void Coordinator::store_jobs() {
  for (auto& [id, job] : stored_) {
    const std::optional<JobView> view = scheduler_->job(id, world_.now());
    if (!view) continue;
    job.state = view->state;
    job.shape = view->shape;
    job.film.extend(view->shape.spp);
  }
}

void Coordinator::checkpoint() {
  for (auto& [id, job] : stored_) {
    job.film = films_.at(id);
    for (int tile = 0; tile < job.film.tile_count(); ++tile) {
      if (job.film.done(tile) == scheduler_->done(id, tile)) continue;
      world_.fail(
          fmt::format("job {} tile {}: the film has other samples than the scheduler", id.value, tile));
    }
  }
}

void Coordinator::checkpoint_regularly(std::uint64_t run) {
  if (!up() || run != run_) return;
  checkpoint();
  world_.after(seconds(kCheckpointSeconds), [=, this] { checkpoint_regularly(run); });
}

bool Coordinator::all_settled() const {
  if (!up()) return false;
  const std::vector<JobView> views = jobs();
  return std::none_of(views.begin(), views.end(), [](const JobView& job) {
    return job.state == JobState::kRunning || job.state == JobState::kPaused;
  });
}

void Coordinator::check_films() {
  for (const JobView& job : jobs()) {
    if (job.state == JobState::kDone && !films_.at(job.id).complete()) {
      world_.fail(fmt::format("job {} is done, but its film lacks samples", job.id.value));
    }
  }
  checkpoint();
}

}  // namespace tessera::simulation
