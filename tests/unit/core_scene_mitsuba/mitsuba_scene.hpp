// SPDX-License-Identifier: Apache-2.0
// Mitsuba scenes in memory, for tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "core/scene/description.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core::test {

// Loads `text`, called "scene.xml", with other files beside it.
Result<SceneDescription> load_xml(const std::string& text, const MemoryAssets::Files& files = {});
// A <scene version="3.0.0"> with the given content, from its second line on, and a sphere if `with_sphere`.
std::string xml_scene(const std::string& content, bool with_sphere = true);
// The scene of the content; a failure of the test if it cannot be read.
SceneDescription scene_of(const std::string& content, const MemoryAssets::Files& files = {});
// The error's message, or "no error".
std::string error_of(const std::string& content, const MemoryAssets::Files& files = {});
// All warnings, one on each line.
std::string warnings_of(const SceneDescription& scene);
// A sphere with this inside of it is the only shape; its material.
Material material_of(const std::string& inside, const MemoryAssets::Files& files = {});

}  // namespace tessera::core::test
