// SPDX-License-Identifier: Apache-2.0
// Handles blobs that the store has lost.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <map>

#include "proto/blob.hpp"
#include "server/farm/steps.hpp"
#include "server/jobs/job_service.hpp"

namespace tessera::jobs {

using core::ErrorCode;
using farm::StateLock;

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

std::vector<std::shared_ptr<const v1::Job>> unfinished_jobs(farm::Farm& farm) {
  std::vector<std::shared_ptr<const v1::Job>> specs;
  farm::visit_in_steps(farm, &farm::State::jobs,
                       [&](const StateLock&, const std::string&, const farm::JobRecord& record) {
                         if (record.is_open) specs.push_back(record.spec);
                       });
  return specs;
}

}  // namespace

void JobService::blob_is_lost(const proto::Digest& digest, const core::Error& noticed) {
  if (!is_lost(noticed)) return;
  // It may have been uploaded again meanwhile, or a single read may have failed.
  const core::Status intact = state_.blobs.verify(digest);
  if (intact || !is_lost(intact.error())) return;
  const core::Error& error = intact.error();
  std::map<std::string, std::string> failures;
  for (const auto& spec : unfinished_jobs(farm_)) {
    if (const v1::Bundle::Asset* asset = find_asset(spec->bundle(), digest)) {
      failures[spec->id()] = fmt::format(
          "{}: the coordinator has lost this file ({}): submit the scene again, and look into the "
          "coordinator's disk",
          asset->path(), error.message);
    }
  }
  if (error.code == ErrorCode::kDataLoss) {
    spdlog::error("{}", error.message);
    state_.blobs.discard(digest);
  }
  for (const auto& [id, failure] : failures)
    StateLock(farm_).handle(
        scheduler::FailJob{{id}, failure, {scheduler::FailureReason::kFileLost, std::nullopt, {}}});
}

}  // namespace tessera::jobs
