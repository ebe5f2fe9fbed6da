// SPDX-License-Identifier: Apache-2.0
#include "server/blobs/scene_files.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "server/blobs/admission.hpp"

namespace tessera::blobs {

namespace {

using FileClock = std::filesystem::file_time_type::clock;

constexpr const char* kNobody = "";

Charge to_charge(base::FairShare::Held held) {
  return std::make_shared<const base::FairShare::Held>(std::move(held));
}

}  // namespace

SceneFiles::SceneFiles(BlobStore blobs, SceneFilesOptions options)
    : blobs_(std::move(blobs)),
      options_(std::move(options)),
      opened_at_(options_.now()),
      room_(options_.limits.store_bytes()),
      claims_(options_.now),
      partial_(options_.now) {
  for (const proto::Digest& file : blobs_.stored())
    blobs_.charge(file, to_charge(room_.note(kNobody, file.size_bytes)));
}

core::Result<BlobClaims::Use> SceneFiles::claim(const std::string& caller, std::vector<proto::Digest> files) {
  auto use = claims_.claim(caller, std::move(files));
  if (!use) return core::fail(too_many_claims(caller));
  return *std::move(use);
}

core::Result<BlobClaims::Use> SceneFiles::use(const std::string& caller, const proto::Digest& file) {
  auto use = claims_.use(caller, file);
  if (!use) return core::fail(too_many_claims(caller));
  return *std::move(use);
}

core::Result<BlobWriter> SceneFiles::write(const std::string& caller, const proto::Digest& file) {
  Charge charge = take_room(caller, file.size_bytes);
  if (!charge) return core::fail(no_room(caller, file.size_bytes));
  return blobs_.write(file, std::move(charge));
}

core::Result<BlobWriter> SceneFiles::write_making_room(const std::string& caller, const proto::Digest& file) {
  if (Charge charge = take_room(caller, file.size_bytes)) return blobs_.write(file, std::move(charge));
  std::vector<Unneeded> removable = unneeded();
  // A submission in progress may need files that were uploaded before a restart.
  if (options_.now() < opened_at_ + BlobClaims::kClaimTime) {
    const auto before = FileClock::now() - BlobClaims::kClaimTime;
    std::erase_if(removable, [&](const Unneeded& each) { return each.last_used > before; });
  }
  std::uint64_t kept_bytes = room_.held() - std::min(room_.held(), partial_.room_bytes());
  for (const Unneeded& each : removable) kept_bytes -= std::min(kept_bytes, each.file.size_bytes);
  const bool without_progress = !check_store_size(kept_bytes, file.size_bytes, options_.limits);
  for (const Unneeded& each : without_progress ? std::vector<Unneeded>() : removable) {
    if (!remove(each.file)) continue;
    if (Charge charge = take_room(caller, file.size_bytes)) return blobs_.write(file, std::move(charge));
  }
  while (!without_progress && partial_.remove_oldest())
    if (Charge charge = take_room(caller, file.size_bytes)) return blobs_.write(file, std::move(charge));
  return core::fail(no_room(caller, file.size_bytes));
}

core::Result<BlobWriter> SceneFiles::continue_partial(const std::string& caller, const proto::Digest& file,
                                                      std::uint64_t offset_bytes) {
  auto writer = partial_.take(caller, file);
  const std::uint64_t kept_bytes = writer ? writer->written_bytes() : 0;
  if (writer && kept_bytes == offset_bytes) return *std::move(writer);
  if (writer) partial_.keep(caller, *std::move(writer));
  return core::fail(core::ErrorCode::kOutOfRange,
                    fmt::format("offset_bytes: {} bytes of blob {} are here, got {}: continue there",
                                kept_bytes, file.hex(), offset_bytes));
}

void SceneFiles::charge_to(const std::string& owner, const v1::Bundle& bundle) {
  const std::string caller = owner.empty() ? kNobody : base::caller_key(owner);
  for (const proto::Digest& file : files_of(bundle))
    blobs_.charge(file, to_charge(room_.note(caller, file.size_bytes)));
}

void SceneFiles::collect() {
  partial_.collect();
  const auto before = FileClock::now() - options_.keep_unused;
  std::size_t removed = 0;
  for (const Unneeded& each : unneeded()) {
    if (each.last_used >= before) break;
    if (remove(each.file)) ++removed;
  }
  if (removed > 0) spdlog::info("removed {} files of scenes that no job names any more", removed);
}

void SceneFiles::note_stored(const v1::Bundle& bundle) {
  mark(bundle);
}

void SceneFiles::note_deleted() {
  const core::MutexLock lock(marks_mutex_);
  is_outdated_ = true;
}

void SceneFiles::mark(const v1::Bundle& bundle) {
  const std::vector<proto::Digest> files = files_of(bundle);
  const core::MutexLock lock(marks_mutex_);
  for (const proto::Digest& file : files) marks_[file] = reading_;
}

bool SceneFiles::is_stored(const proto::Digest& file) const {
  const core::MutexLock lock(marks_mutex_);
  return marks_.contains(file);
}

// Jobs that are stored or deleted meanwhile leave too many marks, and never too few.
bool SceneFiles::mark_stored() {
  const core::MutexLock one_at_a_time(marking_);
  {
    const core::MutexLock lock(marks_mutex_);
    if (!is_outdated_) return true;
    is_outdated_ = false;
    ++reading_;
  }
  const core::Status read =
      options_.for_each_stored_bundle([&](const std::string& owner, const v1::Bundle& bundle) {
        mark(bundle);
        charge_to(owner, bundle);
      });
  const core::MutexLock lock(marks_mutex_);
  if (read) {
    std::erase_if(marks_,
                  [&](const auto& mark) TESSERA_REQUIRES(marks_mutex_) { return mark.second < reading_; });
    return true;
  }
  is_outdated_ = true;
  spdlog::error("cannot see which files jobs name, and removes none: {}", read.error().message);
  return false;
}

std::vector<SceneFiles::Unneeded> SceneFiles::unneeded() {
  std::vector<Unneeded> unneeded;
  if (!mark_stored()) return unneeded;
  for (const proto::Digest& file : blobs_.stored()) {
    if (claims_.is_needed(file) || is_stored(file)) continue;
    if (const auto used = blobs_.last_used(file)) unneeded.push_back({*used, file});
  }
  std::sort(unneeded.begin(), unneeded.end(),
            [](const Unneeded& a, const Unneeded& b) { return a.last_used < b.last_used; });
  return unneeded;
}

bool SceneFiles::remove(const proto::Digest& file) {
  std::optional<RemovedBlob> removed;  // its destructor deletes the file outside the lock
  claims_.unless_needed(file, [&] {
    if (!is_stored(file)) removed.emplace(blobs_.take_away(file));
  });
  return removed.has_value();
}

Charge SceneFiles::take_room(const std::string& caller, std::uint64_t bytes) {
  if (bytes > options_.limits.store_bytes()) return nullptr;
  auto held = room_.take(caller, bytes);
  return held ? to_charge(*std::move(held)) : nullptr;
}

core::Error SceneFiles::no_room(const std::string& caller, std::uint64_t bytes) const {
  const auto fits = check_store_size(room_.held(), bytes, options_.limits);
  if (!fits) return fits.error();
  return over_store_share(room_.held_by(caller), bytes, options_.limits);
}

core::Error SceneFiles::too_many_claims(const std::string& caller) const {
  return {
      core::ErrorCode::kResourceExhausted,
      fmt::format("{} files from here wait for the submission of their scenes already, and this farm takes "
                  "at most {} from all callers, some of which it keeps for others: submit the scenes, or "
                  "wait: {} minutes after the last call for a scene its files count no more",
                  claims_.claimed_by(caller), BlobClaims::kMaxFiles, BlobClaims::kClaimTime.count())};
}

}  // namespace tessera::blobs
