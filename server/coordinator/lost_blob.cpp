// What follows from a blob that the store cannot give back, and from one that nobody wants any more.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "proto/blob.hpp"
#include "server/coordinator/turn.hpp"

namespace tessera::coordinator {

using core::ErrorCode;

namespace {

// Long enough for a client to submit what it has just uploaded.
constexpr std::chrono::seconds kKeepWhenFull = std::chrono::minutes(15);
constexpr std::chrono::seconds kRoomPeriod{5};

// The file that the bundle calls by this digest, or null.
const v1::Bundle::Asset* find_asset(const v1::Bundle& bundle, const proto::Digest& digest) {
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    const auto known = proto::from_proto(asset.digest());
    if (known && *known == digest) return &asset;
  }
  return nullptr;
}

// Anything else may pass by itself.
bool is_lost(const core::Error& error) {
  return error.code == ErrorCode::kDataLoss || error.code == ErrorCode::kNotFound;
}

}  // namespace

void Coordinator::blob_is_lost(const proto::Digest& digest, const core::Error& noticed) {
  if (!is_lost(noticed)) return;
  // It may have been uploaded anew meanwhile, or read wrongly just once.
  const core::Status intact = state_.blobs.verify(digest);
  if (intact || !is_lost(intact.error())) return;
  const core::Error& error = intact.error();
  std::map<std::string, std::string> failures;
  Turn turn(*this);
  for (const auto& [id, record] : jobs_) {
    if (is_finished(scheduler_.job({id}, turn.now())->state)) continue;
    if (const v1::Bundle::Asset* asset = find_asset(record.spec->bundle(), digest)) {
      failures[id] = fmt::format(
          "{}: the coordinator has lost this file ({}): submit the scene again, and look into the "
          "coordinator's disk",
          asset->path(), error.message);
    }
  }
  if (error.code == ErrorCode::kDataLoss) {
    spdlog::error("{}", error.message);
    state_.blobs.discard(digest);
  }
  for (const auto& [id, failure] : failures) fail_job(turn, id, failure);
}

void Coordinator::collect_blobs() {
  collect_blobs_unused_for(options_.keep_unused_blobs);
}

void Coordinator::make_room() {
  {
    const Turn turn(*this);
    if (turn.now() < next_room_) return;
    next_room_ = turn.now() + kRoomPeriod;
  }
  collect_blobs_unused_for(std::min(options_.keep_unused_blobs, kKeepWhenFull));
}

void Coordinator::collect_blobs_unused_for(std::chrono::seconds time) {
  const std::unique_lock nobody_submits(blobs_in_use_, std::try_to_lock);
  if (!nobody_submits) return;
  std::set<std::string> named;
  {
    const Turn turn(*this);
    for (const auto& [id, record] : jobs_) {
      for (const v1::Bundle::Asset& asset : record.spec->bundle().assets()) {
        if (const auto digest = proto::from_proto(asset.digest())) named.insert(digest->hex());
      }
    }
  }
  const std::size_t removed = state_.blobs.collect(named, time);
  if (removed > 0) spdlog::info("removed {} files of scenes that no job names any more", removed);
}

void Coordinator::fail_job(Turn& turn, const std::string& id, const std::string& failure) {
  apply(turn, scheduler_.handle(scheduler::FailJob{{id}, failure}, turn.now()));
}

}  // namespace tessera::coordinator
