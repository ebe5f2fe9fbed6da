// SPDX-License-Identifier: Apache-2.0
#include "client/farm/bundle.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <set>
#include <utility>

#include "core/base/printable.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/validation.hpp"
#include "proto/blob.hpp"
#include "proto/status.hpp"
#include "proto/text.hpp"

namespace tessera::client {
namespace {

using core::ErrorCode;
using core::fail;

v1::Bundle to_bundle(const std::string& scene_name, const std::map<std::string, proto::Digest>& digests) {
  v1::Bundle bundle;
  bundle.set_scene_path(scene_name);
  for (const auto& [path, digest] : digests) {
    v1::Bundle::Asset& asset = *bundle.add_assets();
    asset.set_path(path);
    *asset.mutable_digest() = proto::to_proto(digest);
  }
  return bundle;
}

// More than a client sends before the coordinator checks the data (proto/channel.cpp).
constexpr std::uint64_t kSurelyTakenBytes = std::uint64_t{2} << 20;

core::Status upload(Farm& farm, const proto::Digest& digest, const std::string& bytes, bool& progress) {
  grpc::ClientContext context;
  v1::UploadBlobResponse response;
  const auto stream = farm.stub().UploadBlob(&context, &response);
  v1::UploadBlobRequest request;
  std::uint64_t sent_bytes = 0;
  proto::for_each_chunk(digest, bytes, [&](const v1::BlobChunk& chunk) {
    *request.mutable_chunk() = chunk;
    sent_bytes += chunk.data().size();
    return stream->Write(request);
  });
  stream->WritesDone();
  const grpc::Status status = stream->Finish();
  progress = progress || status.ok() || sent_bytes > kSurelyTakenBytes;
  return status.ok() ? core::Status{} : fail(farm.explain(status, context));
}

core::Status upload_asset(Farm& farm, const LocalBundle& local, const v1::Bundle::Asset& asset,
                          bool& progress) {
  const auto digest = proto::from_proto(asset.digest());
  if (!digest) return fail(digest.error());
  core::FolderAssets files(local.folder);
  const auto bytes = files.read(local.paths.at(asset.path()));
  if (!bytes) return fail(bytes.error());
  if (proto::digest_of(*bytes) != *digest)
    return fail(ErrorCode::kFailedPrecondition,
                fmt::format("'{}' has changed since the scene was read: submit it again", asset.path()));
  const core::Status done = upload(farm, *digest, *bytes, progress);
  return done ? core::Status{} : fail(done.error().within(fmt::format("uploading '{}'", asset.path())));
}

// Returns the SHA-256 of missing files. From now on the coordinator keeps the files of the bundle that it
// has.
core::Result<std::set<std::string>> find_missing(Farm& farm, const v1::Bundle& bundle) {
  v1::FindMissingBlobsRequest request;
  for (const v1::Bundle::Asset& asset : bundle.assets()) *request.add_digests() = asset.digest();
  const auto response = farm.call(&Farm::Stub::FindMissingBlobs, request);
  if (!response) return fail(response.error());
  std::set<std::string> missing;
  for (const v1::Digest& digest : response->missing()) missing.insert(digest.sha256());
  return missing;
}

core::Status two_files(const std::string& name) {
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("two files would be called '{}' on the farm, where bytes that are not UTF-8 are written "
                  "as \\xNN: rename one of them",
                  name));
}

}  // namespace

core::Result<LocalBundle> bundle_scene(const std::string& scene_path,
                                       const core::RenderOverrides& overrides) {
  const std::filesystem::path file(scene_path);
  const std::string scene_name = file.filename().string();
  LocalBundle local;
  local.folder = file.parent_path().string();

  core::FolderAssets files(local.folder);
  std::map<std::string, proto::Digest> digests;
  core::Status distinct;
  core::RecordingAssets recording(files, [&](const std::string& path, const std::string& bytes) {
    const std::string name = core::printable(path);
    if (local.paths.emplace(name, path).first->second != path) distinct = two_files(name);
    digests[name] = proto::digest_of(bytes);
  });
  const auto scene = core::load_scene(recording, scene_name, scene_path);
  if (!scene) return fail(scene.error());
  if (!distinct) return fail(distinct.error().within(scene_path));
  for (const auto& [path, digest] : digests) {
    if (const core::Status fit = proto::check_text("the name of a file", path, proto::kMaxPathBytes); !fit)
      return fail(fit.error().within(scene_path));
  }
  const auto settings = core::resolve_settings(scene->settings, overrides);
  if (!settings) return fail(settings.error().within(scene_path));
  if (const core::Status valid = core::validate_scene(*scene); !valid)
    return fail(valid.error().within(scene_path));
  local.settings = *settings;
  local.gives_light = core::gives_light(*scene);
  local.warnings = scene->warnings;
  local.bundle = to_bundle(core::printable(scene_name), digests);
  return local;
}

core::Status upload_missing(Farm& farm, const LocalBundle& local) {
  const auto done = patiently<bool>(farm, [&](bool& progress) -> core::Result<bool> {
    // Asks at each attempt, because a restarted coordinator keeps files only for clients that ask again.
    auto missing = find_missing(farm, local.bundle);
    if (!missing) return fail(missing.error());
    for (const v1::Bundle::Asset& asset : local.bundle.assets()) {
      if (!missing->contains(asset.digest().sha256())) continue;
      if (core::Status sent = upload_asset(farm, local, asset, progress); !sent) return fail(sent.error());
      missing->erase(asset.digest().sha256());
    }
    return true;
  });
  return done ? core::Status{} : fail(done.error());
}

}  // namespace tessera::client
