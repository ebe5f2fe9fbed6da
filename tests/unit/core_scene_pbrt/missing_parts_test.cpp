// SPDX-License-Identifier: Apache-2.0
// Files and directives of pbrt scenes that are missing, or are found by another name.
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

// Of a scene without warnings but for this one.
std::string only_warning(const std::string& world, const MemoryAssets::Files& files = {}) {
  return warnings_of(pbrt_world(world + "\n" + kPbrtTriangle, files));
}

TEST(PbrtMissingParts, EndsOfDirectives) {
  const SceneDescription scene = pbrt_world("AttributeBegin\nTransformBegin Shape \"sphere\"");
  EXPECT_EQ(scene.shapes.size(), 1u);
  EXPECT_EQ(warnings_of(scene),
            "scene.pbrt:2: AttributeBegin has no end; it ends with the file\n"
            "scene.pbrt:3: TransformBegin has no end; it ends with the file\n");
  EXPECT_EQ(only_warning(kPbrtTriangle + "ObjectBegin \"o\""),
            "scene.pbrt:3: ObjectBegin has no end; it ends with the file\n");
}

TEST(PbrtMissingParts, EndsOfDirectivesInImportedFiles) {
  const SceneDescription scene =
      pbrt_world("AttributeBegin Import \"part.pbrt\" AttributeEnd Shape \"sphere\"",
                 {{"part.pbrt", "ObjectBegin \"o\"\nTransformBegin Shape \"sphere\""}});
  EXPECT_EQ(warnings_of(scene),
            "part.pbrt:1: ObjectBegin has no end; it ends with the file\n"
            "part.pbrt:2: TransformBegin has no end; it ends with the file\n");
  EXPECT_EQ(scene.shapes.size(), 1u);
}

}  // namespace
}  // namespace tessera::core::test
