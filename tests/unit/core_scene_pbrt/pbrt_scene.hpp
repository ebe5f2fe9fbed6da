// SPDX-License-Identifier: Apache-2.0
// Scenes of pbrt in memory, for tests.
#pragma once

#include <string>

#include "core/scene/description.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core::test {

// Loads `scene`, called "scene.pbrt", with the files beside it.
Result<SceneDescription> load_pbrt(const std::string& scene, const MemoryAssets::Files& files = {});
// The same; a test failure and an empty description if it cannot be loaded.
SceneDescription pbrt_scene(const std::string& scene, const MemoryAssets::Files& files = {});
// The same for what follows WorldBegin, from line 2 on.
SceneDescription pbrt_world(const std::string& world, const MemoryAssets::Files& files = {});
// The error's message, or "no error".
std::string pbrt_error(const std::string& scene, const MemoryAssets::Files& files = {});
// Expects each channel to be close.
void expect_color(Rgb color, Rgb expected, float tolerance = 1e-3f);
// All warnings, one in a line.
std::string warnings_of(const SceneDescription& scene);

// A triangle with the corners (0, 0, 0), (1, 0, 0) and (0, 1, 0).
inline const std::string kPbrtTriangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n";

// The material of a triangle after these directives.
Material pbrt_material(const std::string& directives, const MemoryAssets::Files& files = {});

}  // namespace tessera::core::test
