// SPDX-License-Identifier: Apache-2.0
#include "server/watch/farm_feed.hpp"

#include <cstddef>
#include <cstdint>

namespace tessera::watch {

namespace {

// Some hundred kilobytes.
constexpr std::size_t kSubjectsAtOnce = 512;
constexpr std::size_t kKeptUpdates = 8;

void append(std::string& token, std::uint64_t number) {
  for (int shift = 0; shift < 64; shift += 8) token.push_back(static_cast<char>(number >> shift));
}

std::uint64_t number_at(const std::string& token, std::size_t offset) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < 8; ++i)
    number |= std::uint64_t{static_cast<unsigned char>(token[offset + i])} << (8 * i);
  return number;
}

}  // namespace

std::string to_token(const events::Cursor& cursor) {
  std::string token;
  append(token, cursor.revision);
  append(token, cursor.forgotten);
  return token;
}

events::Cursor from_token(const std::string& token) {
  if (token.size() != 16) return {};
  return {number_at(token, 0), number_at(token, 8)};
}

void FarmFeed::add_job(const std::string& id, v1::WatchFarmResponse& message) {
  auto job = jobs_.get_without_bundle(id);
  if (job) {
    job->clear_warnings();
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
  const std::lock_guard lock(mutex_);
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
