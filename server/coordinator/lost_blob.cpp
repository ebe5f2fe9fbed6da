// SPDX-License-Identifier: Apache-2.0
// Handles blobs that the store has lost.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "proto/blob.hpp"
#include "server/coordinator/state_lock.hpp"

namespace tessera::coordinator {

using core::ErrorCode;

namespace {

// The bundle's file with this digest, or null.
const v1::Bundle::Asset* find_asset(const v1::Bundle& bundle, const proto::Digest& digest) {
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    const auto known = proto::from_proto(asset.digest());
    if (known && *known == digest) return &asset;
  }
  return nullptr;
}

// Other errors may be temporary.
bool is_lost(const core::Error& error) {
  return error.code == ErrorCode::kDataLoss || error.code == ErrorCode::kNotFound;
}

}  // namespace

void Coordinator::blob_is_lost(const proto::Digest& digest, const core::Error& noticed) {
  if (!is_lost(noticed)) return;
  // It may have been uploaded again meanwhile, or a single read may have failed.
  const core::Status intact = state_.blobs.verify(digest);
  if (intact || !is_lost(intact.error())) return;
  const core::Error& error = intact.error();
  std::map<std::string, std::string> failures;
  StateLock lock(*this);
  for (const auto& [id, record] : jobs_) {
    if (is_finished(scheduler_.job({id}, lock.now())->state)) continue;
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
  for (const auto& [id, failure] : failures) fail_job(lock, id, failure);
}

void Coordinator::fail_job(StateLock& lock, const std::string& id, const std::string& failure) {
  apply(lock, scheduler_.handle(scheduler::FailJob{{id}, failure}, lock.now()));
}

}  // namespace tessera::coordinator
