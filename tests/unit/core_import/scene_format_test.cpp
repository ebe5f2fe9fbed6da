// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/scene_format.hpp"

#include <gtest/gtest.h>

namespace tessera::core {
namespace {

TEST(SceneFormat, IsKnownByTheEnding) {
  EXPECT_EQ(format_by_ending("a/b.json"), SceneFormat::kTessera);
  EXPECT_EQ(format_by_ending("b.GLB"), SceneFormat::kGltf);
  EXPECT_EQ(format_by_ending("b.gltf"), SceneFormat::kGltf);
  EXPECT_EQ(format_by_ending("b.pbrt"), SceneFormat::kPbrt);
  EXPECT_EQ(format_by_ending("b.xml"), SceneFormat::kMitsuba);
  EXPECT_EQ(format_by_ending("b.ply.gz"), SceneFormat::kPly);
  EXPECT_EQ(format_by_ending("b.stl"), SceneFormat::kStl);
  EXPECT_EQ(format_by_ending("b.obj"), SceneFormat::kObj);
  EXPECT_EQ(format_by_ending("b.gz"), std::nullopt);
  EXPECT_EQ(format_by_ending("json"), std::nullopt);
}

TEST(SceneFormat, IsKnownByTheContent) {
  EXPECT_EQ(format_by_content("glTF\2"), SceneFormat::kGltf);
  EXPECT_EQ(format_by_content("{\"asset\": {\"version\": \"2.0\"}}"), SceneFormat::kGltf);
  EXPECT_EQ(format_by_content("{\"camera\": {}}"), SceneFormat::kTessera);
  EXPECT_EQ(format_by_content("ply\nformat ascii 1.0\n"), SceneFormat::kPly);
  EXPECT_EQ(format_by_content("solid a\nfacet normal 0 0 1\n"), SceneFormat::kStl);
  EXPECT_EQ(format_by_content("<?xml version=\"1.0\"?>\n<scene version=\"3.0.0\">"), SceneFormat::kMitsuba);
  EXPECT_EQ(format_by_content("# a\nLookAt 0 0 5 0 0 0 0 1 0\nWorldBegin\n"), SceneFormat::kPbrt);
  EXPECT_EQ(format_by_content(""), SceneFormat::kTessera);
}

}  // namespace
}  // namespace tessera::core
