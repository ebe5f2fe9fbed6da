// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/watch_hub.hpp"

namespace tessera::rpc {

namespace {

constexpr auto kPeriod = std::chrono::milliseconds(100);

}  // namespace

WatchHub::WatchHub(server::Coordinator& coordinator)
    : coordinator_(coordinator), teller_(kPeriod, [this] { tell_all(); }) {}

WatchHub::~WatchHub() {
  close();
}

// Tells the watcher before it is in the list, so that a later round cannot overtake this first state.
void WatchHub::add(Watcher& watcher) {
  Known known;
  tell(watcher, known);
  watchers_.add(watcher);
  if (closed_) tell(watcher, known);
}

void WatchHub::close() {
  closed_ = true;
  tell_all();
}

void WatchHub::tell_all() {
  Known known;
  watchers_.for_each([&](Watcher& watcher) { tell(watcher, known); });
}

void WatchHub::tell(Watcher& watcher, Known& known) {
  if (closed_)
    return watcher.tell(core::fail(core::ErrorCode::kUnavailable, "the coordinator is stopping: try again"));
  const std::string& id = watcher.job_id();
  auto job = known.find(id);
  if (job == known.end()) job = known.emplace(id, coordinator_.jobs().get_without_bundle(id)).first;
  watcher.tell(job->second);
}

}  // namespace tessera::rpc
