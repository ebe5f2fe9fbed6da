// SPDX-License-Identifier: Apache-2.0
#include "server/watch/farm_feed.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace tessera::watch {

namespace {

// Some hundred kilobytes.
constexpr std::size_t kSubjectsAtOnce = 512;
constexpr std::size_t kKeptUpdates = 8;

}  // namespace

std::string to_token(const events::Cursor& cursor) {
  const std::uint64_t numbers[] = {cursor.revision, cursor.forgotten};
  std::string token(sizeof numbers, '\0');
  std::memcpy(token.data(), numbers, sizeof numbers);
  return token;
}

events::Cursor from_token(const std::string& token) {
  std::uint64_t numbers[2];
  if (token.size() != sizeof numbers) return {};
  std::memcpy(numbers, token.data(), sizeof numbers);
  return {numbers[0], numbers[1]};
}

void FarmFeed::add_job(const std::string& id, v1::WatchFarmResponse& message) {
  auto job = jobs_.summary(id);
  if (job) {
    *message.add_jobs() = std::move(*job);
  } else if (job.error().code == core::ErrorCode::kNotFound) {
    message.add_deleted_job_ids(id);
  }
}

void FarmFeed::add_worker(const std::string& id, v1::WatchFarmResponse& message) {
  auto worker = dispatcher_.worker(id);
  if (worker) {
    *message.add_workers() = std::move(*worker);
  } else {
    message.add_removed_worker_ids(id);
  }
}

std::shared_ptr<const FarmUpdate> FarmFeed::after(const events::Cursor& cursor) {
  const core::MutexLock lock(mutex_);
  for (const auto& [from, update] : last_)
    if (from == cursor) return update;
  const events::EventLog::Page page = log_.read(cursor, kSubjectsAtOnce);
  auto update = std::make_shared<FarmUpdate>();
  update->next = page.next;
  update->message.set_reset(page.reset);
  update->message.set_resume_token(to_token(page.next));
  update->message.set_is_current(page.is_last);
  for (const events::Subject& subject : page.subjects) {
    subject.kind == events::SubjectKind::kJob ? add_job(subject.id, update->message)
                                              : add_worker(subject.id, update->message);
  }
  if (update->next != cursor && !page.reset) {
    last_.emplace_front(cursor, update);
    if (last_.size() > kKeptUpdates) last_.pop_back();
  }
  return update;
}

}  // namespace tessera::watch
