// SPDX-License-Identifier: Apache-2.0
#include "server/validator/validate.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <exception>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "core/film/cryptomatte.hpp"
#include "core/scene/cache/scene_digest.hpp"
#include "core/scene/light_groups.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/pose.hpp"
#include "core/scene/scene_ids.hpp"
#include "core/scene/validation.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "server/validator/answer_limits.hpp"
#include "server/validator/flags.hpp"

namespace tessera::validator {

using core::ErrorCode;

namespace {

// For the owner of a scene, an asset that is missing from the bundle is an error of the scene like any
// other.
core::Error as_mistake(core::Error error) {
  if (error.code == ErrorCode::kNotFound) error.code = ErrorCode::kInvalidArgument;
  return error;
}

// If no limit of the scene was reached, memory was exhausted.
core::Error explain_memory(core::Error error, const Options& options) {
  const bool names_limit = error.message.find("--max-") != std::string::npos;
  if (error.code != ErrorCode::kResourceExhausted || names_limit) return error;
  error.message += fmt::format("; this farm loads scenes within {} MiB (tessera-coordinator {})",
                               options.sandbox.confinement.memory_mib, kMemoryFlag);
  return error;
}

core::Status add_attributes(const core::SceneDescription& scene, core::LayerSet layers,
                            ValidateResponse::Approval& approval) {
  std::size_t bytes = 0;
  for (auto& [name, value] : core::crypto_attributes(layers, core::crypto_names(scene))) {
    bytes += name.size() + value.size();
    v1::TextAttribute& attribute = *approval.add_attributes();
    attribute.set_name(std::move(name));
    attribute.set_value(std::move(value));
  }
  if (bytes <= kMaxAttributeBytes) return {};
  return core::fail(ErrorCode::kResourceExhausted,
                    fmt::format("layers: the names for Cryptomatte take {} bytes, and a farm keeps {} of a "
                                "job: leave out the crypto layers",
                                bytes, kMaxAttributeBytes));
}

core::Result<ValidateResponse::Approval> load(const ValidateRequest& request, core::AssetSource& assets,
                                              const Options& options) {
  const std::string& path = request.bundle().scene_path();
  const auto scene = core::load_scene(assets, path, path, options.scene);
  if (!scene) return core::fail(as_mistake(scene.error()));
  const auto overrides = proto::from_proto(request.overrides());
  if (!overrides) return core::fail(overrides.error());
  const auto settings = core::resolve_settings(*scene, *overrides);
  if (!settings) return core::fail(settings.error());
  if (auto valid = core::validate_scene(*scene); !valid) return core::fail(valid.error().within(path));
  const std::vector<std::int32_t> frames(request.frames().begin(), request.frames().end());
  if (auto valid = core::validate_frames(*scene, frames); !valid)
    return core::fail(valid.error().within(path));
  ValidateResponse::Approval approval;
  *approval.mutable_settings() = proto::to_proto(*settings);
  *approval.mutable_display() = proto::to_proto(scene->display);
  for (const std::string& warning : scene->warnings) approval.add_warnings(warning);
  const core::SceneDigest digest = core::digest_of(*scene);
  for (const std::int32_t frame : frames.empty() ? std::vector<std::int32_t>{0} : frames)
    approval.add_scene_digests(core::digest_text(core::digest_at_frame(digest, scene->animation, frame)));
  if (auto added = add_attributes(*scene, settings->layers, approval); !added)
    return core::fail(added.error().within(path));
  return approval;
}

core::Result<ValidateResponse::Approval> load_safely(const ValidateRequest& request,
                                                     core::AssetSource& assets, const Options& options) {
  try {
    return load(request, assets, options);
  } catch (const std::bad_alloc&) {
    return core::fail(ErrorCode::kResourceExhausted, "the scene does not fit into memory");
  } catch (const std::exception& error) {
    return core::fail(ErrorCode::kInternal, error.what());
  }
}

}  // namespace

ValidateResponse validate(const ValidateRequest& request, core::AssetSource& assets, const Options& options) {
  ValidateResponse response;
  auto approval = load_safely(request, assets, options);
  if (approval) {
    *response.mutable_approval() = std::move(*approval);
  } else {
    core::Error error = explain_memory(approval.error(), options);
    response.mutable_refusal()->set_code(static_cast<int>(error.code));
    response.mutable_refusal()->set_message(std::move(error.message));
  }
  return response;
}

}  // namespace tessera::validator
