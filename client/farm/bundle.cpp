// SPDX-License-Identifier: Apache-2.0
#include "client/farm/bundle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "client/scene_flags.hpp"
#include "core/base/printable.hpp"
#include "core/scene/light_groups.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/pose.hpp"
#include "core/scene/validation.hpp"
#include "proto/blob.hpp"
#include "proto/text.hpp"

namespace tessera::client {
namespace {

using core::ErrorCode;
using core::fail;

v1::Bundle to_bundle(const std::string& scene_path, const std::map<std::string, proto::Digest>& digests) {
  v1::Bundle bundle;
  bundle.set_scene_path(scene_path);
  for (const auto& [path, digest] : digests) {
    v1::Bundle::Asset& asset = *bundle.add_assets();
    asset.set_path(path);
    *asset.mutable_digest() = proto::to_proto(digest);
  }
  return bundle;
}

core::Status two_files(const std::string& name) {
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("two files would be called '{}' on the farm, where bytes that are not UTF-8 are written "
                  "as \\xNN: rename one of them",
                  name));
}

}  // namespace

core::Result<LocalBundle> bundle_scene(const std::string& scene_path, const SceneChoice& choice) {
  const std::filesystem::path file(scene_path);
  const std::string file_name = file.filename().string();
  LocalBundle local;
  if (const std::string name = scene_name(scene_path); proto::check_text("name", name)) local.name = name;
  local.folder = file.parent_path().string();

  core::FolderAssets folder(local.folder);
  core::OverriddenAssets files(folder, file_name, choice.parameters);
  std::map<std::string, proto::Digest> digests;
  core::Status distinct;
  core::RecordingAssets recording(files, [&](const std::string& path, const std::string& bytes) {
    const std::string name = core::printable(path);
    if (local.paths.emplace(name, path).first->second != path) distinct = two_files(name);
    digests[name] = proto::digest_of(bytes);
    if (path == file_name && !choice.parameters.empty()) local.scene_text = bytes;
  });
  const auto scene = core::load_scene(recording, file_name, scene_path);
  if (!scene) return fail(scene.error());
  if (!distinct) return fail(distinct.error().within(scene_path));
  for (const auto& [path, digest] : digests) {
    if (const core::Status fit = proto::check_text("the name of a file", path, proto::kMaxPathBytes); !fit)
      return fail(fit.error().within(scene_path));
  }
  const auto settings = core::resolve_settings(*scene, choice.overrides);
  if (!settings) return fail(settings.error().within(scene_path));
  if (const core::Status valid = core::validate_scene(*scene); !valid)
    return fail(valid.error().within(scene_path));
  if (const core::Status possible = core::validate_frames(*scene, choice.frames); !possible)
    return fail(possible.error().within(scene_path));
  local.settings = *settings;
  local.gives_light = core::gives_light(*scene);
  local.frames_differ = core::frames_differ(*scene);
  local.ignores_media = settings->integrator == core::Integrator::kWhitted && core::uses_media(*scene);
  local.warnings = scene->warnings;
  local.bundle = to_bundle(core::printable(file_name), digests);
  return local;
}

bool has_warning(const LocalBundle& local, const std::string& warning) {
  const std::string folder = (std::filesystem::path(local.folder) / "").string();
  return std::any_of(local.warnings.begin(), local.warnings.end(), [&](std::string known) {
    for (std::size_t at = 0; !folder.empty() && (at = known.find(folder, at)) != std::string::npos;)
      known.erase(at, folder.size());
    return known == warning;
  });
}

}  // namespace tessera::client
