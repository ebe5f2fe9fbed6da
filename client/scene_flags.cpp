// SPDX-License-Identifier: Apache-2.0
#include "client/scene_flags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "client/example_scenes.hpp"
#include "core/base/printable.hpp"
#include "core/base/suggestion.hpp"
#include "core/image/encode.hpp"
#include "core/scene/import/scene_format.hpp"
#include "core/scene/import/selection.hpp"

namespace tessera::client {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxSeed = std::numeric_limits<std::uint64_t>::max();

// That a folder is no scene, and what in it may be one, scenes before meshes.
std::string why_no_folder(const std::string& folder) {
  std::vector<std::pair<core::SceneFormat, std::string>> scenes;
  std::error_code error;
  for (fs::directory_iterator file(folder, error), end; !error && file != end; file.increment(error)) {
    std::error_code unknown;
    const std::string path = file->path().string();
    if (const auto format = core::format_by_ending(path); format && file->is_regular_file(unknown))
      scenes.emplace_back(*format, path);
  }
  constexpr std::size_t kMaxShown = 3;
  std::ranges::sort(scenes);
  std::string text = core::in_quotes(folder) + " is a folder: give a scene file";
  for (std::size_t i = 0; i < std::min(scenes.size(), kMaxShown); ++i)
    text += (i == 0 ? ", such as " : ", ") + core::in_quotes(scenes[i].second);
  return text;
}

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

void parse_size(const std::string& text, core::RenderOverrides& overrides) {
  constexpr auto kMaxSide = static_cast<std::uint64_t>(core::kMaxImageSidePx);
  const std::size_t cross = std::min(text.find('x'), text.size());
  const std::uint64_t width = whole_number(text.substr(0, cross)).value_or(0);
  const std::uint64_t height = cross == text.size() ? 0 : whole_number(text.substr(cross + 1)).value_or(0);
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    throw CLI::ValidationError(
        "--size", fmt::format("must be WIDTHxHEIGHT in pixels, each from 1 to {}, such as 640x480; got '{}'",
                              kMaxSide, text));
  }
  if (width * height > static_cast<std::uint64_t>(core::kMaxImagePixels)) {
    throw CLI::ValidationError(
        "--size", fmt::format("must be at most {} pixels in all; got '{}'", core::kMaxImagePixels, text));
  }
  overrides.width_px = static_cast<int>(width);
  overrides.height_px = static_cast<int>(height);
}

core::Integrator parse_integrator(const std::string& text) {
  const std::optional<core::Integrator> integrator = core::integrator_from_name(text);
  if (!integrator) {
    throw CLI::ValidationError("--integrator",
                               fmt::format("must be naive, nee, mis or whitted; got '{}'", text));
  }
  return *integrator;
}

core::Heuristic parse_heuristic(const std::string& text) {
  const std::optional<core::Heuristic> heuristic = core::heuristic_from_name(text);
  if (!heuristic) {
    throw CLI::ValidationError("--heuristic", fmt::format("must be balance or power; got '{}'", text));
  }
  return *heuristic;
}

// tessera info lists the names and numbers.
constexpr std::pair<std::string_view, const char*> kSelections[] = {
    {core::kSelectCamera, "Camera of a glTF or Mitsuba file, by name or number from 0 [default: the first]"},
    {core::kSelectScene, "Scene of a glTF file [default: the file's]"},
    {core::kSelectVariant, "Variant of the materials of a glTF file [default: none]"},
    {core::kSelectAnimation, "Animation of a glTF file, all or none [default: the first]"}};

double parse_seconds(const std::string& flag, const std::string& text) {
  const char* end = text.data() + text.size();
  double seconds = 0;
  const auto [stopped, error] = std::from_chars(text.data(), end, seconds);
  constexpr double kMaxSeconds = 1e9;
  if (error != std::errc() || stopped != end || !(seconds >= 0 && seconds <= kMaxSeconds)) {
    throw CLI::ValidationError(flag, fmt::format("must be a number of seconds from 0; got '{}'", text));
  }
  return seconds;
}

float parse_clamp(const std::string& text) {
  const char* end = text.data() + text.size();
  float limit = 0;
  const auto [stopped, error] = std::from_chars(text.data(), end, limit);
  if (error != std::errc() || stopped != end || !(limit >= 0 && std::isfinite(limit))) {
    throw CLI::ValidationError("--clamp-indirect",
                               fmt::format("must be a positive number, or 0 for no limit; got '{}'", text));
  }
  return limit;
}

// A sign is allowed: +1 is a stop brighter.
float parse_exposure(const std::string& text) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  float stops = 0;
  const auto [stopped, error] = std::from_chars(begin, end, stops);
  const bool is_number = begin != end && error == std::errc() && stopped == end;
  if (!is_number || !core::check_display({.exposure_stops = stops})) {
    throw CLI::ValidationError("--exposure",
                               fmt::format("must be a number of stops between -{0} and {0}; got '{1}'",
                                           core::kMaxExposureStops, text));
  }
  return stops;
}

core::LayerSet parse_layers(const std::string& text) {
  const core::Result<core::LayerSet> layers = core::parse_layers(text);
  if (!layers) throw CLI::ValidationError("--layers", layers.error().message);
  return *layers;
}

core::ToneCurve parse_tone_curve(const std::string& text) {
  const std::optional<core::ToneCurve> curve = core::tone_curve_from_name(text);
  if (!curve) {
    throw CLI::ValidationError("--tone-curve", fmt::format("must be none, aces or agx; got '{}'", text));
  }
  return *curve;
}

}  // namespace

void add_scene_argument(CLI::App& command, SceneFlags& flags) {
  command
      .add_option(
          "SCENE", flags.scene_path,
          "Scene file, or the name of an example scene such as cornell. Its ending chooses the format: "
          ".json (Tessera's own), .gltf and .glb (glTF 2.0), .pbrt (pbrt-v4), .xml (Mitsuba 3), or a "
          "mesh: .obj, .ply, .stl")
      ->required()
      ->transform(find_scene)
      ->check(why_no_scene);
}

std::string why_no_scene(const std::string& path) {
  std::error_code no_file;
  if (fs::is_directory(path, no_file)) return why_no_folder(path);
  if (!core::image_format_from_path(path)) return suggest_example(path);
  return fmt::format("{} is an image, and not a scene: give the scene file, and images to write by -o",
                     core::in_quotes(path));
}

void add_output_option(CLI::App& command, SceneFlags& flags) {
  // One value for each -o: "-o a.png scene.json" must not take the scene for a second image.
  command
      .add_option("-o,--output", flags.output_paths,
                  "Image file to write; its ending chooses the format: .png (8-bit sRGB), .exr, .hdr or .pfm "
                  "(linear light). Can be given several times")
      ->allow_extra_args(false)
      ->check([](const std::string& path) {
        const auto format = core::image_format_from_path(path);
        return format ? std::string() : format.error().message;
      })
      ->type_name("FILE");
}

void add_override_options(CLI::App& command, core::RenderOverrides& overrides) {
  command
      .add_option_function<std::string>(
          "--spp",
          [&overrides](const std::string& text) {
            overrides.spp = static_cast<std::uint32_t>(parse_whole_number("--spp", text, 1, core::kMaxSpp));
          },
          "Samples per pixel; four times as many halve the noise")
      ->type_name("N");
  command
      .add_option_function<std::string>(
          "--size", [&overrides](const std::string& text) { parse_size(text, overrides); },
          "Width and height of the image in pixels, such as 1920x1080")
      ->type_name("WxH");
  command
      .add_option_function<std::string>(
          "--crop", [&overrides](const std::string& text) { overrides.crop = parse_rect("--crop", text); },
          "Render only the pixels from (X0, Y0) at the top left to (X1, Y1), which is excluded")
      ->type_name("X0,Y0,X1,Y1");
  command
      .add_option_function<std::string>(
          "--integrator",
          [&overrides](const std::string& text) { overrides.integrator = parse_integrator(text); },
          "Light transport algorithm: mis (multiple importance sampling, the least noise), nee (next-event "
          "estimation), naive (unidirectional paths) or whitted (direct light, mirrors and glass only)")
      ->type_name("mis|nee|naive|whitted");
  command
      .add_option_function<std::string>(
          "--heuristic",
          [&overrides](const std::string& text) { overrides.heuristic = parse_heuristic(text); },
          "Heuristic of mis: balance or power")
      ->type_name("balance|power");
  command
      .add_option_function<std::string>(
          "--clamp-indirect",
          [&overrides](const std::string& text) { overrides.clamp_indirect = parse_clamp(text); },
          "Limit what light that was scattered more than once adds to a sample: less noise in fewer samples, "
          "but darker. 0 sets no limit")
      ->type_name("RADIANCE");
  command
      .add_option_function<std::string>(
          "--seed",
          [&overrides](const std::string& text) {
            overrides.seed = parse_whole_number("--seed", text, 0, kMaxSeed);
          },
          "Random seed; the same seed gives the same bytes")
      ->type_name("N");
  command
      .add_option_function<std::string>(
          "--layers", [&overrides](const std::string& text) { overrides.layers = parse_layers(text); },
          "Channels that .exr files have besides colours: all, none, or some of alpha (also in .png), "
          "direct, "
          "indirect, emission, environment, albedo, normal, depth, position, uv, object_index, "
          "material_index, instance_index, crypto_object, crypto_material, crypto_asset, samples, "
          "standard_error, light_groups and group.NAME")
      ->type_name("NAME,...");
}

void add_parameter_option(CLI::App& command, std::vector<core::ParameterOverride>& parameters) {
  command
      .add_option_function<std::vector<std::string>>(
          "-D,--define",
          [&parameters](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) {
              auto parsed = core::parse_override(text);
              if (!parsed) throw CLI::ValidationError("-D", parsed.error().message);
              parameters.push_back(*std::move(parsed));
            }
          },
          "Replace a parameter of the scene file, such as camera.position=[0,1,5] or "
          "lights[0].intensity=20. Can be given several times")
      ->allow_extra_args(false)
      ->type_name("PATH=VALUE");
  for (const auto& [what, help] : kSelections)
    command
        .add_option_function<std::string>(
            fmt::format("--{}", what),
            [&parameters, what = what](const std::string& name) {
              parameters.push_back(core::select_by_name(what, name));
            },
            help)
        ->type_name("NAME|N");
  const auto add_seconds = [&](std::string_view what, const auto& select, const char* help) {
    const std::string flag = fmt::format("--animation-{}", what);
    command
        .add_option_function<std::string>(
            flag,
            [&parameters, flag, select](const std::string& text) {
              parameters.push_back(select(parse_seconds(flag, text)));
            },
            help)
        ->type_name("SECONDS");
  };
  add_seconds(core::kSelectTime, core::select_time,
              "Time of the animation of a glTF file [default: its beginning]");
  add_seconds(core::kSelectShutter, core::select_shutter,
              "How long the shutter is open from then on, for motion blur [default: 0]");
}

void add_display_options(CLI::App& command, core::DisplayOverrides& overrides) {
  command
      .add_option_function<std::string>(
          "--exposure",
          [&overrides](const std::string& text) { overrides.exposure_stops = parse_exposure(text); },
          "Exposure of PNG files in stops; 1 doubles the brightness, -1 halves it")
      ->type_name("STOPS");
  command
      .add_option_function<std::string>(
          "--tone-curve",
          [&overrides](const std::string& text) { overrides.tone_curve = parse_tone_curve(text); },
          "Tone curve of PNG files: none (clipped), aces (filmic, high contrast) or agx (softer)")
      ->type_name("none|aces|agx");
}

core::PixelRect parse_rect(const std::string& flag, const std::string& text) {
  constexpr auto kMaxSide = static_cast<std::uint64_t>(core::kMaxImageSidePx);
  std::vector<std::uint64_t> sides;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');)
    sides.push_back(whole_number(part).value_or(kMaxSide + 1));
  const bool four = sides.size() == 4 && std::count(text.begin(), text.end(), ',') == 3;
  if (!four || sides[0] >= sides[2] || sides[1] >= sides[3] || sides[2] > kMaxSide || sides[3] > kMaxSide) {
    throw CLI::ValidationError(
        flag,
        fmt::format("must be X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1, such as 100,40,164,72; got '{}'",
                    text));
  }
  return {static_cast<int>(sides[0]), static_cast<int>(sides[1]), static_cast<int>(sides[2]),
          static_cast<int>(sides[3])};
}

std::uint64_t parse_whole_number(const std::string& flag, const std::string& text, std::uint64_t least,
                                 std::uint64_t most) {
  const std::optional<std::uint64_t> value = whole_number(text);
  if (!value || *value < least || *value > most) {
    throw CLI::ValidationError(
        flag, fmt::format("must be a whole number from {} to {}; got '{}'", least, most, text));
  }
  return *value;
}

std::string scene_name(const std::string& path) {
  std::error_code ignored;  // the path itself will do
  const fs::path file = fs::absolute(path, ignored).lexically_normal();
  const std::string name = file.stem().string(), folder = file.parent_path().filename().string();
  return core::printable(name == "scene" && !folder.empty() ? folder : name);
}

}  // namespace tessera::client
