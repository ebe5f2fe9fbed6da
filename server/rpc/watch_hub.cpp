#include "server/rpc/watch_hub.hpp"

namespace tessera::rpc {

namespace {

constexpr auto kPeriod = std::chrono::milliseconds(100);

}  // namespace

WatchHub::WatchHub(coordinator::Coordinator& coordinator)
    : coordinator_(coordinator), teller_(kPeriod, [this] {
        const std::lock_guard lock(mutex_);
        for (Watcher* watcher : watchers_) tell(*watcher);
      }) {}

WatchHub::~WatchHub() {
  close();
}

void WatchHub::add(Watcher& watcher) {
  const std::lock_guard lock(mutex_);
  watchers_.insert(&watcher);
  tell(watcher);
}

void WatchHub::remove(Watcher& watcher) {
  const std::lock_guard lock(mutex_);
  watchers_.erase(&watcher);
}

void WatchHub::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  for (Watcher* watcher : watchers_) tell(*watcher);
}

void WatchHub::tell(Watcher& watcher) {
  if (closed_)
    return watcher.tell(core::fail(core::ErrorCode::kUnavailable, "the coordinator is stopping: try again"));
  watcher.tell(coordinator_.job_without_bundle(watcher.job_id()));
}

}  // namespace tessera::rpc
