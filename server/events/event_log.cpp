// SPDX-License-Identifier: Apache-2.0
#include "server/events/event_log.hpp"

#include <algorithm>
#include <utility>

namespace tessera::events {

Revision EventLog::append(Subject subject, bool has_ended) {
  const core::MutexLock lock(mutex_);
  const Revision revision = counter_.next();  // under the lock: the log is in the order of revisions
  Entry& entry = entries_[subject];
  if (entry.revision == 0) {
    order_.emplace_hint(order_.end(), revision, std::move(subject));
  } else {
    auto moved = order_.extract(entry.revision);
    moved.key() = revision;
    order_.insert(order_.end(), std::move(moved));
  }
  if (entry.has_ended) --ended_count_;
  if (has_ended) {
    ++ended_count_;
    ended_.push_back(revision);
  }
  entry = {revision, has_ended};
  forget_ended();
  if (waiting_ > 0) appended_.notify_all();
  return revision;
}

bool EventLog::has_ended_at(Revision revision) const {
  const auto found = order_.find(revision);
  return found != order_.end() && entries_.at(found->second).has_ended;
}

void EventLog::forget_ended() {
  while (!ended_.empty() && (ended_count_ > kept_ended_ || !has_ended_at(ended_.front()))) {
    const Revision revision = ended_.front();
    ended_.pop_front();
    if (!has_ended_at(revision)) continue;
    const auto oldest = order_.find(revision);
    entries_.erase(oldest->second);
    order_.erase(oldest);
    --ended_count_;
    forgotten_ = std::max(forgotten_, revision);
  }
}

EventLog::Page EventLog::read(const Cursor& cursor, std::size_t most) const {
  Page page;
  const core::MutexLock lock(mutex_);
  page.reset = cursor.revision < forgotten_ && cursor.forgotten != forgotten_;
  page.next = page.reset ? Cursor{0, forgotten_} : cursor;
  auto next = order_.upper_bound(page.next.revision);
  for (; next != order_.end() && page.subjects.size() < most; ++next) {
    page.next.revision = next->first;
    page.subjects.push_back(next->second);
  }
  page.is_last = next == order_.end();
  if (page.is_last) page.next.revision = std::max(page.next.revision, forgotten_);
  return page;
}

bool EventLog::has_changes_after(const Cursor& cursor) const {
  const core::MutexLock lock(mutex_);
  return is_behind(cursor);
}

std::uint64_t EventLog::wakes() const {
  const core::MutexLock lock(mutex_);
  return wakes_;
}

void EventLog::wait(const Cursor& cursor, std::uint64_t wakes) {
  core::MutexLock lock(mutex_);
  ++waiting_;
  appended_.wait(lock.native(),
                 [&]() TESSERA_REQUIRES(mutex_) { return wakes_ != wakes || is_behind(cursor); });
  --waiting_;
}

void EventLog::wake() {
  const core::MutexLock lock(mutex_);
  ++wakes_;
  appended_.notify_all();
}

}  // namespace tessera::events
