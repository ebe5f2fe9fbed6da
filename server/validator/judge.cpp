#include "server/validator/judge.hpp"

#include <exception>
#include <new>
#include <string>

#include "core/scene/loader/loader.hpp"
#include "core/scene/validation.hpp"
#include "proto/convert.hpp"

namespace tessera::validator {

using core::ErrorCode;

namespace {

// To whoever submits a scene, an asset that is missing from its bundle is a mistake of the scene like any
// other.
core::Error as_mistake(core::Error error) {
  if (error.code == ErrorCode::kNotFound) error.code = ErrorCode::kInvalidArgument;
  return error;
}

core::Result<core::RenderSettings> load(const Question& question) {
  core::BundleAssets assets({question.files().begin(), question.files().end()});
  const std::string& path = question.bundle().scene_path();
  const auto scene = core::load_scene(assets, path, path);
  if (!scene) return core::fail(as_mistake(scene.error()));
  const auto overrides = proto::from_proto(question.overrides());
  if (!overrides) return core::fail(overrides.error());
  const auto settings = core::resolve_settings(scene->settings, *overrides);
  if (!settings) return core::fail(settings.error());
  if (auto valid = core::validate_scene(*scene); !valid) return core::fail(valid.error().within(path));
  return settings;
}

core::Result<core::RenderSettings> load_safely(const Question& question) {
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
  const auto settings = load_safely(question);
  if (settings) {
    *verdict.mutable_settings() = proto::to_proto(*settings);
  } else {
    verdict.mutable_refusal()->set_code(static_cast<int>(settings.error().code));
    verdict.mutable_refusal()->set_message(settings.error().message);
  }
  return verdict;
}

}  // namespace tessera::validator
