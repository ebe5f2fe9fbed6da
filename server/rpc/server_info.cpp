// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/server_info.hpp"

#include <array>
#include <string_view>

#include "core/base/version.hpp"
#include "server/farm/wire.hpp"

namespace tessera::rpc {
namespace {

// docs/protocol.md describes each.
constexpr std::array<std::string_view, 17> kFeatures{
    "admin-service",    "batch-upload", "error-details", "image-region",   "images",           "job-events",
    "job-labels",       "job-pages",    "layers",        "queued-jobs",    "resumable-upload", "tile-targets",
    "validating-state", "watch-farm",   "watch-tiles",   "worker-filters", "worker-pages"};

}  // namespace

v1::GetServerInfoResponse server_info(const ServerFacts& facts, const server::Limits& limits,
                                      const auth::Principal& caller) {
  v1::GetServerInfoResponse info;
  info.set_version(std::string(core::version()));
  info.mutable_determinism_fingerprints()->Add(facts.fingerprints.begin(), facts.fingerprints.end());
  *info.mutable_started_at() = farm::timestamp_from_ms(facts.started_ms);
  for (const std::string_view feature : kFeatures) info.add_features(std::string(feature));
  info.set_principal(caller.name);
  if (!facts.is_open) info.set_role(std::string(role_name(caller.role)));
  auto& told = *info.mutable_limits();
  told.set_message_bytes(static_cast<std::uint64_t>(limits.message_mib) * server::kMib);
  told.set_blob_bytes(limits.blob_bytes());
  told.set_bundle_bytes(limits.bundle_bytes());
  told.set_bundle_files(limits.bundle_files);
  told.set_image_pixels(limits.image_pixels);
  told.set_spp(limits.spp);
  told.set_images(limits.images);
  return info;
}

}  // namespace tessera::rpc
