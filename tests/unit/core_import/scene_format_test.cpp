// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/scene_format.hpp"

#include <gtest/gtest.h>
#include <libdeflate.h>

#include <string>
#include <string_view>

namespace tessera::core {
namespace {

TEST(SceneFormat, IsKnownByTheEnding) {
  EXPECT_EQ(format_by_ending("a/b.json"), SceneFormat::kTessera);
  EXPECT_EQ(format_by_ending("b.GLB"), SceneFormat::kGltf);
  EXPECT_EQ(format_by_ending("b.gltf"), SceneFormat::kGltf);
  EXPECT_EQ(format_by_ending("b.pbrt"), SceneFormat::kPbrt);
  EXPECT_EQ(format_by_ending("b.xml"), SceneFormat::kMitsuba);
  EXPECT_EQ(format_by_ending("b.ply.gz"), SceneFormat::kPly);
  EXPECT_EQ(format_by_ending("b.pbrt.gz"), SceneFormat::kPbrt);
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
  EXPECT_EQ(format_by_content("# a\nmtllib a.mtl\nv 0 1 2\nf 1 1 1\n"), SceneFormat::kObj);
  EXPECT_EQ(format_by_content("\xef\xbb\xbfply\nformat ascii 1.0\n"), SceneFormat::kPly);
  EXPECT_EQ(format_by_content(std::string(80, ' ') + std::string("\1\0\0\0", 4) + std::string(50, '\0')),
            SceneFormat::kStl);
}

std::string gzip(const std::string& text) {
  std::string packed(text.size() + 100, '\0');
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(6);
  packed.resize(libdeflate_gzip_compress(compressor, text.data(), text.size(), packed.data(), packed.size()));
  libdeflate_free_compressor(compressor);
  return packed;
}

TEST(SceneFormat, IsKnownByTheContentOfGzipFiles) {
  EXPECT_EQ(format_by_content(gzip("ply\nformat ascii 1.0\n")), SceneFormat::kPly);
  EXPECT_EQ(format_by_content(gzip("LookAt 0 0 5 0 0 0 0 1 0\nWorldBegin\n")), SceneFormat::kPbrt);
  EXPECT_EQ(format_by_content(gzip("{\"camera\": {}}")), std::nullopt);
  EXPECT_EQ(format_by_content(gzip(gzip("ply\nformat ascii 1.0\n"))), std::nullopt);
  EXPECT_EQ(format_by_content("\x1f\x8b\x08"), std::nullopt);
}

TEST(SceneFormat, IsNotKnownOfOtherContent) {
  for (const std::string_view text :
       {"", "BLENDER-v300", "Kaydara FBX Binary  ", "#usda 1.0\n", "v is for vertex\n", "f 1 2 3\n",
        "v 1 2 3\nand more\n", "solid advice", "<?xml version=\"1.0\"?>\n<COLLADA>WorldBegin</COLLADA>"}) {
    EXPECT_EQ(format_by_content(text), std::nullopt) << text;
    const auto format = format_of("c.blend", text);
    ASSERT_FALSE(format) << text;
    EXPECT_EQ(
        format.error().message,
        "the format is not known; those that can be read are .json, .gltf, .glb, .pbrt, .xml (Mitsuba), "
        ".obj, .ply and .stl");
    EXPECT_EQ(format_of("c.json", text).value(), SceneFormat::kTessera);
  }
}

TEST(SceneFormat, IsThatOfTheContentWhereXmlAndPbrtAreConfused) {
  const std::string_view xml = "<scene version=\"3.0.0\"/>", pbrt = "LookAt 0 0 5 0 0 0 0 1 0\nWorldBegin\n";
  EXPECT_EQ(format_of("a.pbrt", xml).value(), SceneFormat::kMitsuba);
  EXPECT_EQ(format_of("a.xml", pbrt).value(), SceneFormat::kPbrt);
  EXPECT_EQ(format_of("a.pbrt", pbrt).value(), SceneFormat::kPbrt);
  EXPECT_EQ(format_of("a.xml", "").value(), SceneFormat::kMitsuba);
  EXPECT_EQ(format_of("a.xml", "{}").value(), SceneFormat::kMitsuba);
}

}  // namespace
}  // namespace tessera::core
