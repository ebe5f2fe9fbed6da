// SPDX-License-Identifier: Apache-2.0
// Whether every event names the jobs and workers that it has changed.
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
  return fmt::format("{}x{} {} spp, priority {}, {}: {}; at most {}", job.shape.window.width(),
                     job.shape.window.height(), job.shape.spp, job.priority, job_state_name(job.state),
                     job.failure, job.max_workers);
}

// The end of a cooldown is a matter of time.
std::string text_of(const WorkerView& worker) {
  return fmt::format("{} {} {} {} {}{}{}{}", worker.info.name, worker.info.version, worker.info.threads,
                     worker.info.machine, worker.info.principal, worker.draining ? ", draining" : "",
                     worker.silent ? ", silent" : "", worker.stuck ? ", stuck" : "");
}

template <typename Views, typename IdOf>
auto texts_of(const Views& views, const IdOf& id_of) {
  std::map<std::decay_t<decltype(id_of(views.front()))>, std::string> texts;
  for (const auto& view : views) texts[id_of(view)] = text_of(view);
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

void Referee::changed(const std::vector<JobView>& before, const std::vector<JobView>& after,
                      const Actions& actions) {
  const auto id_of = [](const JobView& job) { return job.id; };
  const std::string wrong =
      wrongly_named(texts_of(before, id_of), texts_of(after, id_of), actions.changed_jobs);
  if (!wrong.empty()) world_.fail(fmt::format("job {} has changed, and was not named once", wrong));
}

void Referee::changed(const std::vector<WorkerView>& before, const std::vector<WorkerView>& after,
                      const Actions& actions) {
  const auto id_of = [](const WorkerView& worker) { return worker.info.id; };
  const std::string wrong =
      wrongly_named(texts_of(before, id_of), texts_of(after, id_of), actions.changed_workers);
  if (!wrong.empty()) world_.fail(fmt::format("worker {} has changed, and was not named once", wrong));
}

}  // namespace tessera::simulation
