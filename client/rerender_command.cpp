// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "client/commands.hpp"
#include "client/console.hpp"
#include "client/image_record.hpp"
#include "client/render_options.hpp"
#include "core/base/available_resources.hpp"
#include "core/base/determinism_fingerprint.hpp"
#include "core/base/printable.hpp"
#include "core/base/version.hpp"

namespace tessera::client {
namespace {

namespace fs = std::filesystem;
using core::ErrorCode;
using core::fail;
using core::Result;

const cli::HelpText kRerenderHelp{
    .notes =
        R"(The header of an .exr file has the settings, the seed, the frame and the digest of the scene.

Without SCENE, the scene is the file beside the image with the image's name, or scene.json there. Parameters
that were replaced (-D) must be replaced again. The digest tells whether the scene is the same.)",
    .exit_statuses = {{kExitOk, "done"},
                      {kExitFailed, "failed"},
                      {kExitUsage, "wrong command line"},
                      {kExitInterrupted, "interrupted"}},
    .examples = {"tessera rerender image.exr -o again.exr",
                 "tessera rerender image.exr cornell -o again.exr -o again.png"},
    .required_arguments = {"IMAGE"}};

// The scene file that belongs to an image by its name.
Result<std::string> scene_beside(const std::string& image) {
  const fs::path path(image);
  std::error_code ignored;
  for (const char* const ending : {".json", ".gltf", ".glb", ".pbrt", ".xml", ".obj", ".ply", ".stl"}) {
    const fs::path scene = fs::path(path).replace_extension(ending);
    if (fs::is_regular_file(scene, ignored)) return scene.string();
  }
  const fs::path scene = path.parent_path() / "scene.json";
  if (fs::is_regular_file(scene, ignored)) return scene.string();
  return fail(ErrorCode::kNotFound, fmt::format("there is no scene beside '{}': give the scene file", image));
}

core::Status check_record(const core::RenderRecord& record, const std::string& image) {
  if (!record.complete)
    return fail(ErrorCode::kFailedPrecondition,
                fmt::format("'{}' was written before its render was complete", image));
  if (record.fingerprint == core::kDeterminismFingerprint) return {};
  return fail(
      ErrorCode::kFailedPrecondition,
      fmt::format("'{}' was rendered by Tessera {}, whose images are not bit-compatible with those of {}",
                  image, core::printable(record.version.substr(0, 100)), core::version()));
}

int run_rerender(const std::string& image, RenderOptions options) {
  auto record = read_image_record(image);
  if (!record) return print_error(record.error());
  if (auto possible = check_record(*record, image); !possible) return print_error(possible.error());
  if (options.scene.scene_path.empty()) {
    auto scene = scene_beside(image);
    if (!scene) return print_error(scene.error());
    options.scene.scene_path = *std::move(scene);
  }
  if (record->frame != 0) options.frames.frames = {record->frame};
  options.record = *std::move(record);
  return run_render(options);
}

}  // namespace

void add_rerender_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("rerender", "Render an image again from what its .exr file says");
  const auto image = std::make_shared<std::string>();
  const auto options = std::make_shared<RenderOptions>();
  options->threads = static_cast<int>(core::available_threads());
  command->add_option("IMAGE", *image, "OpenEXR image, written by 'tessera render'")->required();
  add_scene_argument(*command, options->scene);
  command->get_option("SCENE")->required(false);
  add_output_option(*command, options->scene);
  command->get_option("--output")->required();
  add_parameter_option(*command, options->scene.parameters);
  add_display_options(*command, options->scene.display);
  add_thread_option(*command, options->threads);
  command->add_flag("-q,--quiet", options->quiet, "Print warnings and errors only");
  add_progress_json_option(*command, options->json);
  cli::set_help(*command, kRerenderHelp);
  command->callback([image, options, &exit_code] { exit_code = run_rerender(*image, *options); });
}

}  // namespace tessera::client
