// SPDX-License-Identifier: Apache-2.0
// The flags that select the scene and its settings, shared by `render` and `submit`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/image/display.hpp"
#include "core/scene/loader/parameter_override.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {

struct SceneFlags {
  std::string scene_path;
  std::vector<std::string> output_paths;            // in the order given
  std::vector<core::ParameterOverride> parameters;  // replace parameters of the scene file
  core::RenderOverrides overrides;                  // override its settings, after that
  core::DisplayOverrides display;                   // the same for PNG files
};

// Adds SCENE and -o/--output. Values are stored in `flags` while the command line is parsed; `flags` must
// live until then.
void add_scene_argument(CLI::App& command, SceneFlags& flags);
void add_output_option(CLI::App& command, SceneFlags& flags);

// What is wrong with SCENE as far as its name tells: it is a folder's; an image's, most likely because -o is
// missing before it; or a misspelt one of an example scene. Empty for others.
std::string why_no_scene(const std::string& path);

// Adds --spp, --size, --crop, --integrator, --heuristic, --clamp-indirect, --seed and --layers. A bad value
// ends parsing with a sentence that names the flag.
void add_override_options(CLI::App& command, core::RenderOverrides& overrides);

// Adds -D, and the options that choose among what a file holds: --camera, --scene, --variant, --animation,
// --animation-time and --animation-shutter, in the same way.
void add_parameter_option(CLI::App& command, std::vector<core::ParameterOverride>& parameters);

// Adds --exposure and --tone-curve in the same way.
void add_display_options(CLI::App& command, core::DisplayOverrides& overrides);

// The pixels "X0,Y0,X1,Y1", which must not be empty; otherwise throws an exception of CLI11 that names the
// flag. Whether they lie within the image is checked when its size is known.
core::PixelRect parse_rect(const std::string& flag, const std::string& text);

// What a scene is called, on one line: its file's name without the ending, or its folder's if the file is
// just "scene".
std::string scene_name(const std::string& path);

// An integer from `least` to `most`; otherwise throws an exception of CLI11 that names the flag.
std::uint64_t parse_whole_number(const std::string& flag, const std::string& text, std::uint64_t least,
                                 std::uint64_t most);

}  // namespace tessera::client
