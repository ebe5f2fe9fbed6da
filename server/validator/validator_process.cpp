// SPDX-License-Identifier: Apache-2.0
#include "server/validator/validator_process.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>

#include "core/base/printable.hpp"
#include "core/sandbox/flags.hpp"
#include "core/sandbox/memory_file.hpp"
#include "core/sandbox/process.hpp"
#include "proto/blob.hpp"
#include "server/validator/answer_limits.hpp"
#include "server/validator/flags.hpp"
#include "server/validator/validate.pb.h"

namespace tessera::validator {

using core::ErrorCode;

namespace {

constexpr const char* kName = "tessera-validator";

ValidateRequest make_request(const SceneToValidate& scene) {
  ValidateRequest request;
  *request.mutable_bundle() = scene.bundle;
  *request.mutable_overrides() = scene.overrides;
  request.mutable_frames()->Add(scene.frames.begin(), scene.frames.end());
  return request;
}

// Opens the files of the bundle's assets.
sandbox::OpenNumbered open_assets(const blobs::BlobStore& blobs, const v1::Bundle& bundle) {
  return [&](std::uint32_t number) -> core::Result<core::OpenFile> {
    if (number >= static_cast<std::uint32_t>(bundle.assets_size()))
      return core::fail(ErrorCode::kInvalidArgument, "the bundle has no such asset");
    const auto digest = proto::from_proto(bundle.assets(static_cast<int>(number)).digest());
    if (!digest) return core::fail(digest.error());
    return sandbox::open_to_send(blobs.path(*digest).string());
  };
}

// CPU time in whole seconds. The timeout has the same length, for a process that waits for a disk.
std::chrono::seconds processor_time(const server::Limits& limits) {
  return std::chrono::ceil<std::chrono::seconds>(limits.validation_time);
}

std::vector<std::string> command_line(const ProcessOptions& options) {
  const server::Limits& limits = options.limits;
  std::vector<std::string> words{kTrianglesFlag,
                                 std::to_string(limits.triangles),
                                 kLightsFlag,
                                 std::to_string(limits.lights),
                                 kTexturePixelsFlag,
                                 std::to_string(limits.texture_pixels),
                                 kSceneTexturePixelsFlag,
                                 std::to_string(limits.scene_texture_pixels),
                                 kMemoryFlag,
                                 std::to_string(limits.validator_mib),
                                 kSecondsFlag,
                                 std::to_string(processor_time(limits).count())};
  if (options.require_sandbox) words.emplace_back(sandbox::kCompleteFlag);
  return words;
}

core::Error stopping() {
  return {ErrorCode::kUnavailable, "the coordinator is stopping: try again"};
}

core::Error takes_too_long(const server::Limits& limits) {
  return {
      ErrorCode::kResourceExhausted,
      fmt::format("the scene could not be validated within {} s, which is all that this farm takes for one "
                  "(tessera-coordinator {})",
                  processor_time(limits).count(), kSecondsFlag)};
}

// `images`: how many the job has.
Approval bounded(const ValidateResponse::Approval& said, int images) {
  Approval approval{said.settings(), said.display(), {}, {}, {}};
  for (int i = 0; i < std::min(said.warnings_size(), kMaxWarnings); ++i)
    approval.warnings.push_back(core::printable(said.warnings(i).substr(0, kMaxWarningBytes)));
  for (int i = 0; i < std::min(said.scene_digests_size(), images); ++i)
    approval.scene_digests.push_back(core::printable(said.scene_digests(i).substr(0, kMaxDigestBytes)));
  std::size_t bytes = 0;
  for (const v1::TextAttribute& attribute : said.attributes()) {
    if (!attribute.name().starts_with(kAttributePrefix)) continue;
    bytes += attribute.name().size() + attribute.value().size();
    if (bytes > kMaxAttributeBytes || approval.attributes.size() == kMaxAttributes) break;
    approval.attributes.push_back(attribute);
  }
  return approval;
}

// The validator may have been taken over by the scene.
core::Error as_error(const ValidateResponse::Refusal& said) {
  const bool known = said.code() >= 0 && said.code() <= static_cast<int>(ErrorCode::kInternal);
  return {known ? static_cast<ErrorCode>(said.code()) : ErrorCode::kInternal,
          core::printable_lines(said.message())};
}

core::Result<Approval> read_verdict(const core::OpenFile& out, const sandbox::Ending& ending,
                                    const server::Limits& limits, int images) {
  if (ending.by_signal(SIGXCPU)) return core::fail(takes_too_long(limits));
  const auto content = sandbox::read_memory_file(out, kMaxResponseBytes);
  if (!content) return core::fail(content.error());
  ValidateResponse response;
  const bool answered = ending.succeeded() && response.ParseFromString(*content);
  if (answered && response.has_approval()) return bounded(response.approval(), images);
  if (answered && response.has_refusal()) return core::fail(as_error(response.refusal()));
  return core::fail(
      ErrorCode::kInvalidArgument,
      fmt::format("the scene could not be validated: {}; render it with `tessera render` to see why",
                  sandbox::describe(ending, "the validator")));
}

}  // namespace

std::string default_validator_path() {
  return sandbox::path_beside_this(kName);
}

core::Status check_validator(const std::string& path) {
  return sandbox::check_program(path, kName, "--validator");
}

core::Result<Approval> validate_scene(const ProcessOptions& options, const blobs::BlobStore& blobs,
                                      const SceneToValidate& scene) {
  if (options.stop.stop_requested()) return core::fail(stopping());
  const auto in = sandbox::create_memory_file("request", make_request(scene).SerializeAsString());
  if (!in) return core::fail(in.error());
  const auto out = sandbox::create_memory_file("verdict");
  if (!out) return core::fail(out.error());
  const sandbox::Program program{.path = options.path,
                                 .arguments = command_line(options),
                                 .timeout = options.limits.validation_time,
                                 .stop = options.stop};
  const auto ending = sandbox::run(program, {*in, *out, open_assets(blobs, scene.bundle)});
  if (!ending) return core::fail(ending.error());
  if (ending->cause == sandbox::Ending::Cause::kStopRequest) return core::fail(stopping());
  if (ending->cause == sandbox::Ending::Cause::kTimeout) return core::fail(takes_too_long(options.limits));
  const auto images = static_cast<int>(std::max<std::size_t>(scene.frames.size(), 1));
  return read_verdict(*out, *ending, options.limits, images);
}

}  // namespace tessera::validator
