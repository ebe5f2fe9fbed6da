// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/watch_hub.hpp"

#include <chrono>

namespace tessera::rpc {

namespace {

constexpr std::size_t kEventsAtOnce = 256;

}  // namespace

WatchHub::WatchHub(events::EventLog& log) : log_(log), thread_([this] { run(); }) {}

WatchHub::~WatchHub() {
  close();
  {
    const core::MutexLock lock(mutex_);
    stopping_ = true;
  }
  stop_.notify_all();
  log_.wake();
  thread_.join();
}

void WatchHub::add(Watcher& watcher) {
  watchers_.add(watcher);
  if (closed_) return watcher.close();
  if (watcher.notify(true)) request_round();
}

void WatchHub::request_round() {
  log_.wake();
}

void WatchHub::close() {
  closed_ = true;
  watchers_.for_each([](Watcher& watcher) { watcher.close(); });
}

void WatchHub::run() {
  for (;;) {
    const std::uint64_t wakes = log_.wakes();
    std::set<std::string> jobs;
    const bool any_changed = read_events(jobs);
    const bool again = notify_all(any_changed, jobs);
    pause();
    {
      const core::MutexLock lock(mutex_);
      if (stopping_) return;
    }
    if (!again) log_.wait(cursor_, wakes);
  }
}

bool WatchHub::read_events(std::set<std::string>& jobs) {
  bool any = false;
  for (bool is_last = false; !is_last;) {
    const events::EventLog::Page page = log_.read(cursor_, kEventsAtOnce);
    for (const events::Subject& subject : page.subjects)
      if (subject.kind == events::SubjectKind::kJob) jobs.insert(subject.id);
    any = any || page.next != cursor_;
    cursor_ = page.next;
    is_last = page.is_last;
  }
  return any;
}

bool WatchHub::notify_all(bool any_changed, const std::set<std::string>& jobs) {
  bool again = false;
  watchers_.for_each([&](Watcher& watcher) {
    const std::string& id = watcher.job_id();
    again |= watcher.notify(id.empty() ? any_changed : jobs.contains(id));
  });
  return again;
}

void WatchHub::pause() {
  core::MutexLock lock(mutex_);
  stop_.wait_for(lock.native(), kShortestRound, [this]() TESSERA_REQUIRES(mutex_) { return stopping_; });
}

}  // namespace tessera::rpc
