#include "server/rpc/watch_hub.hpp"

namespace tessera::rpc {

namespace {

constexpr auto kPeriod = std::chrono::milliseconds(100);

}  // namespace

WatchHub::WatchHub(coordinator::Coordinator& coordinator)
    : coordinator_(coordinator), teller_(kPeriod, [this] {
        const std::lock_guard lock(mutex_);
        tell_all();
      }) {}

WatchHub::~WatchHub() {
  close();
}

void WatchHub::add(Watcher& watcher) {
  const std::lock_guard lock(mutex_);
  watchers_.insert(&watcher);
  Known known;
  tell(watcher, known);
}

void WatchHub::remove(Watcher& watcher) {
  const std::lock_guard lock(mutex_);
  watchers_.erase(&watcher);
}

void WatchHub::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  tell_all();
}

void WatchHub::tell_all() {
  Known known;
  for (Watcher* watcher : watchers_) tell(*watcher, known);
}

void WatchHub::tell(Watcher& watcher, Known& known) {
  if (closed_)
    return watcher.tell(core::fail(core::ErrorCode::kUnavailable, "the coordinator is stopping: try again"));
  const std::string& id = watcher.job_id();
  auto job = known.find(id);
  if (job == known.end()) job = known.emplace(id, coordinator_.job_without_bundle(id)).first;
  watcher.tell(job->second);
}

}  // namespace tessera::rpc
