// SPDX-License-Identifier: Apache-2.0
#include "server/watch/farm_feed.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <utility>

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

core::Status FarmFeed::add_job(const std::string& id, v1::WatchFarmResponse& message) {
  auto job = jobs_.summary(id);
  if (job) {
    *message.add_jobs() = std::move(*job);
    return {};
  }
  if (job.error().code != core::ErrorCode::kNotFound) return core::fail(job.error());
  message.add_deleted_job_ids(id);
  return {};
}

void FarmFeed::add_worker(const std::string& id, v1::WatchFarmResponse& message) {
  auto worker = dispatcher_.worker(id);
  if (worker) {
    *message.add_workers() = std::move(*worker);
  } else {
    message.add_removed_worker_ids(id);
  }
}

FarmFeed::Update FarmFeed::make(const events::Cursor& cursor) {
  const events::EventLog::Page page = log_.read(cursor, kSubjectsAtOnce);
  auto update = std::make_shared<FarmUpdate>();
  update->next = page.next;
  update->message.set_reset(page.reset);
  update->message.set_resume_token(to_token(page.next));
  update->message.set_is_current(page.is_last);
  for (const events::Subject& subject : page.subjects) {
    if (subject.kind == events::SubjectKind::kWorker) {
      add_worker(subject.id, update->message);
    } else if (auto added = add_job(subject.id, update->message); !added) {
      return core::fail(added.error());
    }
  }
  return update;
}

std::shared_future<FarmFeed::Update> FarmFeed::find_or_enter(const events::Cursor& cursor,
                                                             std::promise<Update>& promise) {
  const core::MutexLock lock(mutex_);
  for (const Shared& each : last_)
    if (each.from == cursor) return each.update;
  last_.push_front({cursor, promise.get_future().share()});
  if (last_.size() > kKeptUpdates) last_.pop_back();
  return {};
}

void FarmFeed::remove(const events::Cursor& cursor) {
  const core::MutexLock lock(mutex_);
  std::erase_if(last_, [&](const Shared& each) { return each.from == cursor; });
}

FarmFeed::Update FarmFeed::after(const events::Cursor& cursor) {
  std::promise<Update> promise;
  if (const auto found = find_or_enter(cursor, promise); found.valid()) return found.get();
  try {
    Update update = make(cursor);
    // Later callers with the cursor find more than nothing, or the store readable.
    if (!update || (*update)->next == cursor || (*update)->message.reset()) remove(cursor);
    promise.set_value(update);
    return update;
  } catch (...) {
    remove(cursor);
    promise.set_exception(std::current_exception());
    throw;
  }
}

}  // namespace tessera::watch
