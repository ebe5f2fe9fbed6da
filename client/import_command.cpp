// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "client/commands.hpp"
#include "client/console.hpp"
#include "client/scene_flags.hpp"
#include "core/base/printable.hpp"
#include "core/base/suggestion.hpp"
#include "core/image/file_io.hpp"
#include "core/scene/cache/scene_digest.hpp"
#include "core/scene/import/scene_format.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/writer/scene_writer.hpp"

namespace tessera::client {
namespace {

namespace fs = std::filesystem;

struct ImportOptions {
  SceneFlags scene;
  std::string output_path;
  bool report = false;
  bool json = false;
};

core::Status write_one(const fs::path& folder, const std::string& name, std::string_view bytes) {
  const fs::path path = folder / name;
  std::error_code error;
  fs::create_directories(path.parent_path().empty() ? fs::path(".") : path.parent_path(), error);
  if (error)
    return core::fail(core::ErrorCode::kUnavailable,
                      fmt::format("{}: {}", path.parent_path().string(), error.message()));
  return core::write_file_atomically(path.string(), bytes);
}

struct Digests {
  core::SceneDigest scene;
  std::vector<core::Checksum> materials;
};

// Names are no part of what is rendered.
Digests digests_without_names(core::SceneDescription& scene) {
  for (core::Material& material : scene.materials) material.name.clear();
  for (core::MediumDescription& medium : scene.media) medium.name.clear();
  for (core::ObjectDescription& object : scene.objects) {
    object.name.clear();
    object.shape_names.clear();
  }
  return {core::digest_of(scene), core::digests_of_materials(scene)};
}

// Names the first material that differs. If there is none, a medium or an animation does.
std::string material_that_differs(const Digests& a, const Digests& b, const std::vector<std::string>& names) {
  const std::size_t count = std::min({a.materials.size(), b.materials.size(), names.size()});
  for (std::size_t i = 0; i < count; ++i)
    if (a.materials[i] != b.materials[i]) return "the material " + core::in_quotes(names[i]);
  return "a material or a medium";
}

// What differs between the scenes, whose materials have these names; empty if they render alike.
std::string part_that_differs(const Digests& original, const Digests& written,
                              const std::vector<std::string>& names) {
  const core::SceneDigest &a = original.scene, &b = written.scene;
  if (a.camera != b.camera) return "the camera";
  if (a.textures != b.textures) return "a texture";
  if (a.materials != b.materials) return material_that_differs(original, written, names);
  if (a.shapes != b.shapes) return "a shape";
  if (a.lights != b.lights) return "a light";
  return a.environment == b.environment ? "" : "the environment";
}

// `written`: gets the paths of the files.
core::Status write_and_compare(core::SceneDescription scene, const std::string& output_path,
                               std::vector<std::string>& written) {
  const fs::path output(output_path);
  const auto write = [&](const std::string& name, std::string_view bytes) {
    written.push_back((output.parent_path() / name).string());
    return write_one(output.parent_path(), name, bytes);
  };
  if (auto status = core::write_scene(scene, output.stem().string(), write); !status) return status;
  const core::RenderSettings settings = scene.settings;
  const Digests original = digests_without_names(scene);
  scene = {};  // frees it
  auto again = core::load_scene_file(output_path);
  if (!again) return core::fail(again.error().within("the written scene cannot be read"));
  std::vector<std::string> names;
  for (const core::Material& material : again->materials) names.push_back(material.name);
  const std::string differs = again->settings == settings
                                  ? part_that_differs(original, digests_without_names(*again), names)
                                  : "the render settings";
  if (differs.empty()) return {};
  return core::fail(
      core::ErrorCode::kInternal,
      fmt::format("{}: {} of the written scene differs from the original's", output_path, differs));
}

void print_report(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) print_result(core::printable(warning) + "\n");
  if (warnings.empty()) print_result("everything in the file is read as it is\n");
}

void print_json(const ImportOptions& options, const std::vector<std::string>& warnings,
                const std::vector<std::string>& written) {
  using Json = nlohmann::ordered_json;
  const std::string& path = options.scene.scene_path;
  const std::filesystem::path file(path);
  core::FolderAssets folder(file.parent_path().string());
  const auto format = core::format_of(folder, file.filename().string()).value_or(core::SceneFormat::kTessera);
  const Json json = {{"file", core::printable(path)},
                     {"format", std::string(core::scene_format_name(format))},
                     {"written", written},
                     {"warnings", warnings}};
  print_result(json.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n");
}

int run_import(const ImportOptions& options) {
  core::SceneLimits limits;
  if (options.report) limits.warnings = core::kReportLimits;
  auto scene = core::load_scene_file(options.scene.scene_path, options.scene.parameters, limits);
  if (!scene) return print_error(scene.error());
  const std::vector<std::string> warnings = scene->warnings;
  if (options.report && !options.json) print_report(warnings);
  if (!options.report && !options.json) print_warnings(warnings);
  std::vector<std::string> written;
  if (!options.output_path.empty())
    if (auto status = write_and_compare(std::move(*scene), options.output_path, written); !status)
      return print_error(status.error());
  if (options.json) print_json(options, warnings, written);
  return kExitOk;
}

}  // namespace

void add_import_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "import", "Convert a glTF, pbrt, Mitsuba or mesh file to a scene of Tessera's format");
  const auto options = std::make_shared<ImportOptions>();
  add_scene_argument(*command, options->scene);
  command->add_option("-o,--output", options->output_path, "Scene file to write, with the ending .json")
      ->check([](const std::string& path) {
        return fs::path(path).extension() == ".json" ? std::string() : "the ending must be .json";
      })
      ->type_name("FILE");
  command->add_flag(
      "--report", options->report,
      "Print each parameter that is approximated or ignored, with file and line, and what is done "
      "instead");
  command->add_flag("--json", options->json,
                    "Print one line of JSON, with the warnings; with --report, each place in them");
  add_parameter_option(*command, options->scene.parameters);
  cli::set_help(
      *command,
      {.notes =
           R"(Writes the scene file, and its meshes and images into a folder beside it: scene.files for scene.json. The
written scene is read again and compared with the original, so that both render to the same bytes.)",
       .exit_statuses = kUsualExitStatuses,
       .examples = {"tessera import model.glb -o scene.json", "tessera import room.pbrt --report",
                    "tessera import room.xml -o room.json -D spp=256 --camera 1"}});
  command->callback([options, &exit_code] {
    if (options->output_path.empty() && !options->report) throw CLI::RequiredError("-o FILE or --report");
    exit_code = run_import(*options);
  });
}

}  // namespace tessera::client
