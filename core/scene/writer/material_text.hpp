// SPDX-License-Identifier: Apache-2.0
// Materials as scene files write them. Not thread-safe.
#pragma once

#include <string>
#include <vector>

#include "core/materials/material.hpp"
#include "core/scene/parameter_tracks.hpp"
#include "core/scene/writer/json_text.hpp"

namespace tessera::core {

// The names by which materials refer to other parts of the scene; each is unique among its kind.
struct SceneNames {
  std::vector<std::string> textures, media, materials, objects;
};

// A number or a colour, or its keyframes, with its texture if it has one.
std::string parameter_text(const ColorParameter& parameter, const SceneNames& names,
                           const Track<Rgb>& track = {});
std::string parameter_text(const ScalarParameter& parameter, const SceneNames& names,
                           const Track<float>& track = {});

// Parameters that have their default are left out.
std::string material_text(const Material& material, const SceneNames& names, const ParameterTracks& tracks);

}  // namespace tessera::core
