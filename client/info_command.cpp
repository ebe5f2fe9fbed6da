// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "client/commands.hpp"
#include "client/console.hpp"
#include "client/observed_assets.hpp"
#include "client/scene_flags.hpp"
#include "core/base/printable.hpp"
#include "core/scene/import/scene_bounds.hpp"
#include "core/scene/import/scene_counts.hpp"
#include "core/scene/import/scene_format.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/loader/scene_keys.hpp"

namespace tessera::client {
namespace {

using Json = nlohmann::ordered_json;

const cli::HelpText kInfoHelp{
    .notes =
        R"(Reads the scene as 'tessera render' does, and prints what is in it. Memory is an estimate of what the
scene takes while it is rendered, without the image.)",
    .exit_statuses = {{kExitOk, "done"},
                      {kExitFailed, "the scene cannot be rendered"},
                      {kExitUsage, "wrong command line"},
                      {kExitInterrupted, "interrupted"}},
    .examples = {"tessera info scene.json", "tessera info model.glb --json"}};

struct InfoOptions {
  SceneFlags scene;
  bool json = false;
};

Json to_json(core::Vec3 v) {
  return {v.x, v.y, v.z};
}

Json to_json(const std::map<std::string_view, std::uint64_t>& counts) {
  Json json = Json::object();
  for (const auto& [name, count] : counts) json[std::string(name)] = count;
  return json;
}

Json camera_json(const core::CameraDescription& camera) {
  Json json = {{"type", core::scene_keys::kCameraTypes[static_cast<std::size_t>(camera.type)]},
               {"position", to_json(camera.position)},
               {"look_at", to_json(camera.look_at)}};
  if (camera.type == core::CameraType::kPerspective)
    json["vertical_fov_degrees"] = camera.vertical_fov_degrees;
  if (camera.type == core::CameraType::kOrthographic) json["view_height"] = camera.view_height;
  return json;
}

Json textures_json(const core::SceneDescription& scene) {
  Json json = Json::array();
  std::set<const core::TextureImage*> seen;
  for (const core::Texture& texture : scene.textures)
    if (texture.image && seen.insert(texture.image.get()).second)
      json.push_back({{"width", texture.image->width()},
                      {"height", texture.image->height()},
                      {"bytes", core::image_bytes(*texture.image)}});
  return json;
}

Json names_json(const std::vector<std::string>& names) {
  Json json = Json::array();
  for (const std::string& name : names) json.push_back(name);
  return json;
}

// What can be chosen by --camera, --scene, --variant and --animation; a list without entries is left out.
Json contents_json(const core::SceneContents& contents) {
  Json json = Json::object();
  if (!contents.cameras.empty()) json["cameras"] = names_json(contents.cameras);
  if (!contents.scenes.empty()) json["scenes"] = names_json(contents.scenes);
  if (!contents.variants.empty()) json["variants"] = names_json(contents.variants);
  for (const auto& [name, seconds] : contents.animations)
    json["animations"].push_back({{"name", name}, {"seconds", seconds}});
  return json;
}

// What moves or changes from frame to frame; nothing if all stands still.
Json motion_json(const core::SceneDescription& scene) {
  const core::Animation& animation = scene.animation;
  Json json = Json::object();
  if (scene.camera.shutter_open != scene.camera.shutter_close)
    json["shutter"] = {scene.camera.shutter_open, scene.camera.shutter_close};
  if (core::is_animated(animation.camera)) json["camera"] = 1;
  const auto count = [&json](const char* what, std::size_t number) {
    if (number > 0) json[what] = number;
  };
  count("instances", animation.instances.size());
  count("lights", animation.lights.size());
  count("materials", animation.materials.size());
  count("media", animation.media.size());
  count("environment", animation.environment.empty() ? 0 : 1);
  return json;
}

// All that is told of a scene that was read.
Json scene_json(const core::SceneDescription& scene) {
  const core::SceneCounts counts = core::count_scene(scene);
  const core::Aabb bounds = core::scene_bounds(scene);
  Json json;
  if (!bounds.empty()) json["bounds"] = {{"lower", to_json(bounds.lower)}, {"upper", to_json(bounds.upper)}};
  json["camera"] = camera_json(scene.camera);
  json["contents"] = contents_json(scene.contents);
  json["width"] = scene.settings.width_px;
  json["height"] = scene.settings.height_px;
  json["spp"] = scene.settings.spp;
  json["triangles"] = counts.triangles;
  json["triangles_with_instances"] = counts.triangles_with_instances;
  if (counts.deforming_triangles > 0) json["deforming_triangles"] = counts.deforming_triangles;
  if (counts.curve_segments > 0) json["curve_segments"] = counts.curve_segments;
  json["shapes"] = to_json(counts.shapes);
  json["objects"] = scene.objects.size();
  json["lights"] = to_json(counts.lights);
  json["emissive_shapes"] = counts.emissive_shapes;
  json["environment"] = scene.environment.has_value();
  json["materials"] = to_json(counts.materials);
  json["textures"] = textures_json(scene);
  json["media"] = scene.media.size();
  json["motion"] = motion_json(scene);
  json["memory_bytes"] = counts.memory_bytes;
  return json;
}

std::string plain(const Json& vector) {
  return fmt::format("({:g}, {:g}, {:g})", vector[0].get<float>(), vector[1].get<float>(),
                     vector[2].get<float>());
}

// "2 mesh, 3 sphere"
std::string plain_counts(const Json& counts) {
  std::string text;
  for (const auto& [name, count] : counts.items())
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count.get<std::uint64_t>(), name);
  return text.empty() ? "none" : text;
}

std::string plain_bytes(std::uint64_t bytes) {
  constexpr std::uint64_t kKilo = 1000, kMega = 1000 * kKilo;
  if (bytes < kKilo) return fmt::format("{} bytes", bytes);
  if (bytes < kMega) return fmt::format("{:.1f} kB", static_cast<double>(bytes) / kKilo);
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / kMega);
}

std::string plain_camera(const Json& camera) {
  std::string text = fmt::format("{} at {}, looking at {}", camera["type"].get<std::string>(),
                                 plain(camera["position"]), plain(camera["look_at"]));
  if (camera.contains("vertical_fov_degrees"))
    text += fmt::format(", {:g} degrees", camera["vertical_fov_degrees"].get<float>());
  return text;
}

std::string plain_lights(const Json& json) {
  std::string text = plain_counts(json["lights"]);
  if (json["emissive_shapes"] > 0)
    text += fmt::format(", {} emissive shapes", json["emissive_shapes"].get<std::uint64_t>());
  return json["environment"].get<bool>() ? text + ", environment" : text;
}

// "shutter 0 to 0.5 frames, 1 camera, 2 instances"
std::string plain_motion(Json motion) {
  std::string text;
  if (motion.contains("shutter"))
    text = fmt::format("shutter {:g} to {:g} frames", motion["shutter"][0].get<float>(),
                       motion["shutter"][1].get<float>());
  motion.erase("shutter");
  if (!motion.empty()) text += fmt::format("{}{}", text.empty() ? "" : ", ", plain_counts(motion));
  return text;
}

std::string plain_textures(const Json& textures) {
  if (textures.empty()) return "none";
  std::string text;
  for (const Json& texture : textures)
    text += fmt::format("{}{} x {} ({})", text.empty() ? "" : ", ", texture["width"].get<int>(),
                        texture["height"].get<int>(), plain_bytes(texture["bytes"].get<std::uint64_t>()));
  return text;
}

// "0 Front, 1 Back", or "0 Walk (0.7 s)"
std::string plain_choices(const Json& list) {
  std::string text;
  std::size_t number = 0;
  for (const Json& entry : list) {
    const Json& name = entry.is_object() ? entry["name"] : entry;
    text += fmt::format("{}{} {}", number == 0 ? "" : ", ", number, name.get<std::string>());
    if (text.ends_with(' ')) text.pop_back();
    if (entry.is_object()) text += fmt::format(" ({:g} s)", entry["seconds"].get<float>());
    ++number;
  }
  return text;
}

// One line for each entry of `json`, which is what scene_json() returns.
std::string plain_scene(const Json& json) {
  std::string text;
  const auto line = [&text](std::string_view name, const std::string& value) {
    text += fmt::format("{:<10}  {}\n", name, value);
  };
  if (json.contains("bounds"))
    line("bounds", fmt::format("{} to {}", plain(json["bounds"]["lower"]), plain(json["bounds"]["upper"])));
  line("camera", plain_camera(json["camera"]));
  for (const auto& [what, list] : json["contents"].items()) line(what, plain_choices(list));
  line("image", fmt::format("{} x {} pixels, {} samples each", json["width"].get<int>(),
                            json["height"].get<int>(), json["spp"].get<std::uint32_t>()));
  line("triangles", fmt::format("{} stored, {} with instances", json["triangles"].get<std::uint64_t>(),
                                json["triangles_with_instances"].get<std::uint64_t>()));
  if (json.contains("deforming_triangles"))
    line("deforming", fmt::format("{} of these triangles", json["deforming_triangles"].get<std::uint64_t>()));
  if (json.contains("curve_segments"))
    line("curves", fmt::format("{} segments", json["curve_segments"].get<std::uint64_t>()));
  line("shapes", plain_counts(json["shapes"]));
  line("objects", fmt::format("{}", json["objects"].get<std::uint64_t>()));
  line("lights", plain_lights(json));
  line("materials", plain_counts(json["materials"]));
  line("textures", plain_textures(json["textures"]));
  if (json["media"] > 0) line("media", fmt::format("{}", json["media"].get<std::uint64_t>()));
  if (!json["motion"].empty()) line("motion", plain_motion(json["motion"]));
  line("memory", plain_bytes(json["memory_bytes"].get<std::uint64_t>()));
  return text;
}

std::string plain_files(const ObservedAssets& assets) {
  std::string text;
  for (const auto& [path, bytes] : assets.files())
    text += fmt::format("{:<10}  {} ({})\n", text.empty() ? "files" : "", core::printable(path),
                        plain_bytes(bytes));
  std::string missing;
  for (const std::string& path : assets.missing())
    missing += fmt::format("{:<10}  {}\n", missing.empty() ? "missing" : "", core::printable(path));
  return text + missing;
}

Json files_json(const ObservedAssets& assets) {
  Json json = Json::array();
  for (const auto& [path, bytes] : assets.files())
    json.push_back({{"path", core::printable(path)}, {"bytes", bytes}});
  return json;
}

Json missing_json(const ObservedAssets& assets) {
  Json json = Json::array();
  for (const std::string& path : assets.missing()) json.push_back(core::printable(path));
  return json;
}

int run_info(const InfoOptions& options) {
  const std::filesystem::path file(options.scene.scene_path);
  const std::string name = file.filename().string();
  core::FolderAssets folder(file.parent_path().string());
  core::OverriddenAssets overridden(folder, name, options.scene.parameters);
  ObservedAssets assets(overridden);
  const auto scene = core::load_scene(assets, name, options.scene.scene_path);
  const std::string format(
      core::scene_format_name(core::format_of(folder, name).value_or(core::SceneFormat::kTessera)));
  Json json = {{"file", core::printable(options.scene.scene_path)}, {"format", format}};
  if (scene) json.update(scene_json(*scene));
  json["files"] = files_json(assets);
  json["missing"] = missing_json(assets);
  if (scene) json["warnings"] = scene->warnings;
  if (options.json) {
    print_result(json.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n");
  } else {
    print_result(
        fmt::format("{:<10}  {} ({})\n", "scene", core::printable(options.scene.scene_path), format) +
        (scene ? plain_scene(json) : "") + plain_files(assets));
    if (scene) print_warnings(scene->warnings);
  }
  return scene ? kExitOk : print_error(scene.error());
}

}  // namespace

void add_info_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("info", "Print what is in a scene");
  const auto options = std::make_shared<InfoOptions>();
  add_scene_argument(*command, options->scene);
  add_parameter_option(*command, options->scene.parameters);
  command->add_flag("--json", options->json, "Print one line of JSON");
  cli::set_help(*command, kInfoHelp);
  command->callback([options, &exit_code] { exit_code = run_info(*options); });
}

}  // namespace tessera::client
