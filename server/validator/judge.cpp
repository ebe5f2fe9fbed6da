#include "server/validator/judge.hpp"

#include <exception>
#include <new>
#include <string>
#include <utility>

#include "core/scene/loader/loader.hpp"
#include "core/scene/validation.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"

namespace tessera::validator {

using core::ErrorCode;

namespace {

// To whoever submits a scene, an asset that is missing from its bundle is a mistake of the scene like any
// other.
core::Error as_mistake(core::Error error) {
  if (error.code == ErrorCode::kNotFound) error.code = ErrorCode::kInvalidArgument;
  return error;
}

core::Result<Verdict::Approval> load(const Question& question) {
  core::BundleAssets assets({question.files().begin(), question.files().end()});
  const std::string& path = question.bundle().scene_path();
  const auto scene = core::load_scene(assets, path, path);
  if (!scene) return core::fail(as_mistake(scene.error()));
  const auto overrides = proto::from_proto(question.overrides());
  if (!overrides) return core::fail(overrides.error());
  const auto settings = core::resolve_settings(scene->settings, *overrides);
  if (!settings) return core::fail(settings.error());
  if (auto valid = core::validate_scene(*scene); !valid) return core::fail(valid.error().within(path));
  Verdict::Approval approval;
  *approval.mutable_settings() = proto::to_proto(*settings);
  *approval.mutable_display() = proto::to_proto(scene->display);
  return approval;
}

core::Result<Verdict::Approval> load_safely(const Question& question) {
  try {
    return load(question);
  } catch (const std::bad_alloc&) {
    return core::fail(
        ErrorCode::kResourceExhausted,
        "loading the scene takes more memory than this farm allows: use smaller meshes and textures");
  } catch (const std::exception& error) {
    return core::fail(ErrorCode::kInternal, error.what());
  }
}

}  // namespace

Verdict judge(const Question& question) {
  Verdict verdict;
  auto approval = load_safely(question);
  if (approval) {
    *verdict.mutable_approval() = std::move(*approval);
  } else {
    verdict.mutable_refusal()->set_code(static_cast<int>(approval.error().code));
    verdict.mutable_refusal()->set_message(approval.error().message);
  }
  return verdict;
}

}  // namespace tessera::validator
