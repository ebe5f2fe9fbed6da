// SPDX-License-Identifier: Apache-2.0
// Whether every event names the jobs and workers that it has changed.
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "tests/simulation/referee.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

std::string text_of(const JobView& job) {
  return fmt::format("{} of {}x{} {} spp, {} in all, priority {}, {}: {}; at most {}", job.shape.images,
                     job.shape.window.width(), job.shape.window.height(), job.shape.spp, job.samples_total,
                     job.priority, job_state_name(job.state), job.failure, job.max_workers);
}

// The end of a cooldown is a matter of time.
std::string text_of(const WorkerView& worker) {
  return fmt::format("{} {} {} {} {} {}{}{}{}{}", worker.info.name, worker.info.version, worker.info.threads,
                     worker.info.machine, worker.info.origin, worker.info.principal,
                     worker.draining ? ", draining" : "", worker.drain_requested ? ", asked to" : "",
                     worker.silent ? ", silent" : "", worker.stuck ? ", stuck" : "");
}

std::string progress_of(const JobView& job) {
  return fmt::format("{} {} {}", job.samples_done, job.samples_to_verify, job.active_workers);
}

// The leases of ended jobs are taken from their holders with later events.
std::string progress_of(const WorkerView& worker) {
  return fmt::format("{}", worker.samples_accepted);
}

template <typename Views, typename IdOf, typename TextOf>
auto texts_of(const Views& views, const IdOf& id_of, const TextOf& text) {
  std::map<std::decay_t<decltype(id_of(views.front()))>, std::string> texts;
  for (const auto& view : views) texts[id_of(view)] = text(view);
  return texts;
}

// An id that was named twice, or not although what is known of it has changed; empty if there is none.
template <typename Id>
std::string wrongly_named(const std::map<Id, std::string>& before, const std::map<Id, std::string>& after,
                          const std::vector<Id>& named) {
  const std::set<Id> all(named.begin(), named.end());
  if (all.size() != named.size()) return named.front().value;
  const auto differs = [&](const auto& entry, const std::map<Id, std::string>& from) {
    const auto found = from.find(entry.first);
    return (found == from.end() || found->second != entry.second) && !all.contains(entry.first);
  };
  for (const auto& entry : before)
    if (differs(entry, after)) return entry.first.value;
  for (const auto& entry : after)
    if (differs(entry, before)) return entry.first.value;
  return "";
}

}  // namespace

namespace {

// The first of `before` and `after` whose change was not named; empty if there is none. Those that come or go
// are changed, and may have progressed; `gone`: those that went, and may have come again.
template <typename View, typename IdOf, typename Id>
std::string not_named(const std::vector<View>& before, const std::vector<View>& after, const IdOf& id_of,
                      const std::vector<Id>& changed, const std::vector<Id>& progressed,
                      const std::set<Id>& gone = {}) {
  const auto text = [](const View& view) { return text_of(view); };
  const auto progress = [](const View& view) { return progress_of(view); };
  const std::string wrong =
      wrongly_named(texts_of(before, id_of, text), texts_of(after, id_of, text), changed);
  if (!wrong.empty()) return wrong + " has changed";
  auto was = texts_of(before, id_of, progress), is = texts_of(after, id_of, progress);
  std::erase_if(was,
                [&](const auto& entry) { return !is.contains(entry.first) || gone.contains(entry.first); });
  std::erase_if(is, [&](const auto& entry) { return !was.contains(entry.first); });
  const std::string late = wrongly_named(was, is, progressed);
  return late.empty() ? "" : late + " has progressed";
}

}  // namespace

void Referee::changed(const std::vector<JobView>& before, const std::vector<JobView>& after,
                      const Actions& actions) {
  const std::string wrong = not_named(
      before, after, [](const JobView& job) { return job.id; }, actions.changed_jobs,
      actions.progressed_jobs);
  if (!wrong.empty()) world_.fail(fmt::format("job {}, and was not named once", wrong));
}

void Referee::changed(const std::vector<WorkerView>& before, const std::vector<WorkerView>& after,
                      const Actions& actions) {
  const std::set<WorkerId> named(actions.changed_workers.begin(), actions.changed_workers.end());
  std::set<WorkerId> gone;  // forgotten, and registered again by the same event
  for (const WorkerView& now : after) {
    const auto was = std::find_if(before.begin(), before.end(),
                                  [&](const WorkerView& worker) { return worker.info.id == now.info.id; });
    if (was != before.end() && now.samples_accepted < was->samples_accepted && named.contains(now.info.id))
      gone.insert(now.info.id);
  }
  const std::string wrong = not_named(
      before, after, [](const WorkerView& worker) { return worker.info.id; }, actions.changed_workers,
      actions.progressed_workers, gone);
  if (!wrong.empty()) world_.fail(fmt::format("worker {}, and was not named once", wrong));
}

}  // namespace tessera::simulation
