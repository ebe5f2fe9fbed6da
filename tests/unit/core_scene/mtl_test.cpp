// SPDX-License-Identifier: Apache-2.0
// What MTL files say, and what becomes of it.
#include "core/scene/loader/mtl_reader.hpp"

#include <gtest/gtest.h>

#include "core/scene/loader/mtl_map.hpp"

namespace tessera::core::mtl_test {
namespace {

using Strings = std::vector<std::string>;

MtlMaterial one(const std::string& statements) {
  const MtlFile file = read_mtl("newmtl m\n" + statements);
  EXPECT_EQ(file.materials.size(), 1u);
  return file.materials.empty() ? MtlMaterial{} : file.materials.front();
}

Strings warnings_of(const std::string& text) {
  return read_mtl(text).warnings.messages("x.mtl");
}

TEST(MtlReader, ReadsWhatItKnows) {
  const MtlMaterial m =
      one("Ns 250\nKa 1 0.5 1\nKd 0.8 0.4 0.2\nKs 0.5 0.5 2\nKe 17 0 0\nNi 1.45\nd 1.0\nillum 2\nTf 0.5\nPr "
          "0.25\n"
          "Pm 1\nTr 0.5\n");
  EXPECT_EQ(m.name, "m");
  EXPECT_EQ(m.exponent, 250);
  EXPECT_EQ(m.ambient, (Rgb{1, 0.5f, 1}));
  EXPECT_EQ(m.diffuse, (Rgb{0.8f, 0.4f, 0.2f}));
  EXPECT_EQ(m.specular, (Rgb{0.5f, 0.5f, 2}));
  EXPECT_EQ(m.emission, (Rgb{17, 0, 0}));
  EXPECT_EQ(m.transmission, Rgb::gray(0.5f));
  EXPECT_EQ(m.ior, 1.45f);
  EXPECT_EQ(m.dissolve, 1);
  EXPECT_EQ(m.transparency, 0.5f);
  EXPECT_EQ(m.illum, 2);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.metallic, 1);
  EXPECT_FALSE(one("").diffuse);
}

TEST(MtlReader, KnowsTheMapsByAllTheirNames) {
  EXPECT_EQ(one("map_Kd a.png").diffuse_map->file, "a.png");
  EXPECT_EQ(one("map_Ks a.png").specular_map->file, "a.png");
  EXPECT_EQ(one("map_Ke a.png").emission_map->file, "a.png");
  EXPECT_EQ(one("map_d a.png").dissolve_map->file, "a.png");
  EXPECT_EQ(one("map_Ns a.png").exponent_map->file, "a.png");
  EXPECT_EQ(one("map_Pr a.png").roughness_map->file, "a.png");
  EXPECT_EQ(one("map_Pm a.png").metallic_map->file, "a.png");
  EXPECT_EQ(one("norm a.png").normal_map->file, "a.png");
  for (const std::string name : {"bump", "map_bump", "map_Bump", "bm"}) {
    const MtlMaterial m = one(name + " -bm 0.25 a.png");
    ASSERT_TRUE(m.bump_map.has_value()) << name;
    EXPECT_EQ(m.bump_map->file, "a.png") << name;
    EXPECT_EQ(m.bump_map->bump_multiplier, 0.25f) << name;
  }
  EXPECT_EQ(one("\nmap_Kd a.png").diffuse_map->line, 3);
}

TEST(MtlReader, ReadsThePhysicallyBasedExtension) {
  const std::string text =
      "newmtl m\nPr 0.25\nPm 0.5\nPc 0.75\nPcr 0.125\nPs 0.5 0.25 1\naniso 0.5\nanisor 0.25\n"
      "map_Pr r.png\nmap_Pm m.png\nmap_Pc c.png\nmap_Pcr d.png\nmap_Ps s.png\n";
  const MtlFile file = read_mtl(text);
  EXPECT_TRUE(file.warnings.empty());
  const MtlMaterial& m = file.materials.at(0);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.coat, 0.75f);
  EXPECT_EQ(m.coat_roughness, 0.125f);
  EXPECT_EQ(m.sheen, (Rgb{0.5f, 0.25f, 1}));
  EXPECT_EQ(m.anisotropy, 0.5f);
  EXPECT_EQ(m.anisotropy_rotation, 0.25f);
  EXPECT_EQ(m.coat_map->file, "c.png");
  EXPECT_EQ(m.coat_roughness_map->file, "d.png");
  EXPECT_EQ(m.sheen_map->file, "s.png");
  EXPECT_EQ(one("Ps 0.5").sheen, Rgb::gray(0.5f));
}

TEST(MtlReader, ReadsColorsOfOneNumberAndComments) {
  EXPECT_EQ(one("Kd 0.5 # gray\n").diffuse, Rgb::gray(0.5f));
  EXPECT_EQ(one("Kd 1 0.5 0#c\n# Kd 2\n").diffuse, (Rgb{1, 0.5f, 0}));
  EXPECT_EQ(one("d -halo 0.5\n").dissolve, 0.5f);
}

TEST(MtlReader, ReadsSeveralMaterialsAndAnyLineEnds) {
  const auto materials =
      read_mtl("\xef\xbb\xbf# c\r\nnewmtl  first one \r\nKd 1 0 0\r\n\r\nnewmtl two\r\n\tKd 0 1 0").materials;
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(materials[0].name, "first one");
  EXPECT_EQ(materials[1].name, "two");
  EXPECT_EQ(materials[1].diffuse, (Rgb{0, 1, 0}));
  EXPECT_TRUE(read_mtl("").materials.empty());
}

TEST(MtlReader, ReadsUtf16) {
  std::string wide = "\xff\xfe";
  for (const char c : std::string("newmtl a\nKd 1 0 0\n")) wide += {c, '\0'};
  const auto materials = read_mtl(wide).materials;
  ASSERT_EQ(materials.size(), 1u);
  EXPECT_EQ(materials[0].diffuse, (Rgb{1, 0, 0}));
}

TEST(MtlReader, ClampsOrIgnoresValuesOutOfRange) {
  EXPECT_EQ(one("Kd 1.000001 0.8 -1").diffuse, (Rgb{1, 0.8f, 0}));
  EXPECT_EQ(one("Kd 1 0.8 0.8 1").diffuse, (Rgb{1, 0.8f, 0.8f}));
  EXPECT_EQ(one("Kd spectral a.rfl 1").diffuse, Rgb::gray(0.5f));
  EXPECT_EQ(one("Tf 2 1 1").transmission, Rgb::gray(1));
  EXPECT_EQ(one("d 1.0001").dissolve, 1);
  EXPECT_EQ(one("Tr -0.0001").transparency, 0);
  EXPECT_FALSE(one("Ni -1").ior);
  EXPECT_FALSE(one("illum 11").illum);
  EXPECT_FALSE(one("Ns").exponent);
  EXPECT_FALSE(one("Ke nan 1 1").emission);
}

TEST(MtlReader, TakesAMaterialThatNobodyCouldSeeForOpaque) {
  EXPECT_FALSE(one("Tr 1").transparency);
  EXPECT_EQ(one("Tr 0.9").transparency, 0.9f);
  EXPECT_EQ(one("d 1\nTr 1").transparency, 1);
  EXPECT_EQ(one("Tr 1\nmap_d a.png").transparency, 1);
}

TEST(MtlReader, TellsWhatItDoesNotTakeAsWritten) {
  const std::pair<std::string, std::string> cases[] = {
      {"newmtl \n", "1: 'newmtl' gives no name; the material is ignored"},
      {"newmtl a\nKd 1 0\n", "2: 'Kd' must be 3 numbers between 0 and 1, got '1 0'; the default is used"},
      {"newmtl a\nKd 1 1 1.5\n", "2: 'Kd' must be 3 numbers between 0 and 1, got '1 1 1.5'; it is clamped"},
      {"newmtl a\nTr 1\nnewmtl b\n",
       "3: 'Tr 1' without 'd' would hide all of the material 'a'; it is taken for opaque"},
      {"newmtl a\nnewmtl b\nnewmtl a\n", "3: the material 'a' is defined again; the last one is used"},
      {"newmtl a\nd 2\n", "2: 'd' must be a number between 0 and 1, got '2'; 1 is used"},
      {"newmtl a\nNi -1\n", "2: 'Ni' must be a number between 0 and 10, got '-1'; the default is used"},
      {"newmtl a\nillum\n", "2: 'illum' must be a number between 0 and 10, got ''; the default is used"},
      {"Kd 1 1 1\n", "1: 'Kd' belongs to no material, because no 'newmtl' comes before it; it is ignored"},
      {"newmtl a\nmap_Kd \n", "2: 'map_Kd' names no image; the line is ignored"},
      {"newmtl a\nmap_Kd # none\n", "2: 'map_Kd' names no image; the line is ignored"},
      {"newmtl a\nbump -bm\n", "2: 'bump' names no image; the line is ignored"},
      {"newmtl a\nrefl a.hdr\nrefl b.hdr\n", "2: 'refl' is not used (2 times)"},
      {"newmtl a\nPc 5\n", "2: 'Pc' must be a number between 0 and 4, got '5'; 4 is used"},
      {"newmtl a\nPs 1 2 0\n", "2: 'Ps' must be 3 numbers between 0 and 1, got '1 2 0'; it is clamped"},
      {"newmtl a\ndisp a.png\n", "2: 'disp' is not used"},
      {"newmtl a\n\xff\n", "2: '\\xff' is not used"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(warnings_of(text), Strings{"x.mtl:" + message}) << text;
  EXPECT_TRUE(warnings_of("newmtl a\nKa 1 1 1\nmap_Ka a.png\nsharpness 60\n").empty());
}

TEST(MtlReader, ReadsTheOptionsOfMaps) {
  const std::pair<std::string, MtlMap> cases[] = {
      {"a.png", {.file = "a.png"}},
      {"a b  c.png\t", {.file = "a b  c.png"}},
      {"-s 2 wood 1.png", {.file = "wood 1.png", .scale = {2, 1}}},
      {"-s 2 3 1.png", {.file = "1.png", .scale = {2, 3}}},
      {"-s 2 3 4 5.png", {.file = "5.png", .scale = {2, 3}}},
      {"-s 2 3 4", {.file = "4", .scale = {2, 3}}},
      {"-o 0.5 a.png", {.file = "a.png", .offset = {0.5f, 0}}},
      {"-o -.5 1e-1 a.png", {.file = "a.png", .offset = {-0.5f, 0.1f}}},
      {"-clamp on -s 2 2 2 a.png", {.file = "a.png", .clamp = true, .scale = {2, 2}}},
      {"-clamp off a.png", {.file = "a.png"}},
      {"-blendu on -blendv off -cc on -imfchan r -type sphere -colorspace sRGB a.png",
       {.file = "a.png", .channel = TextureChannel::kRed}},
      {"-imfchan b a.png", {.file = "a.png", .channel = TextureChannel::kBlue}},
      {"-imfchan l a.png", {.file = "a.png"}},
      {"-bm 1 -boost 2 -mm 0 1 -texres 512 -t 1 1 1 C:\\maps\\a b.png", {.file = "C:\\maps\\a b.png"}},
      {"-bm -0.5 a.png", {.file = "a.png", .bump_multiplier = -0.5f}},
      {"\"a b.png\"", {.file = "a b.png"}},
      {"a-s.png -s", {.file = "a-s.png -s"}},
      {"-a.png", {.file = "-a.png"}},
  };
  FileWarnings warnings;
  for (const auto& [line, expected] : cases) {
    const auto map = read_mtl_map("map_Kd", line, 0, warnings);
    ASSERT_TRUE(map.has_value()) << line;
    EXPECT_EQ(*map, expected) << line << ": " << map->file;
  }
  EXPECT_TRUE(warnings.empty());
}

TEST(MtlReader, PassesOverOptionsOfMapsThatItDoesNotUnderstand) {
  const std::pair<std::string, std::string> cases[] = {
      {"-uvset 1 a.png", "'-uvset' is not an option of 'map_Kd'; it is ignored"},
      {"-clamp a.png", "'-clamp' must be followed by on or off, got 'a.png'; it is ignored"},
      {"-s a.png", "'-s' must be followed by a number and the name of an image; it is ignored"},
  };
  for (const auto& [line, message] : cases) {
    FileWarnings warnings;
    const auto map = read_mtl_map("map_Kd", line, 7, warnings);
    ASSERT_TRUE(map.has_value()) << line;
    EXPECT_EQ(map->file, "a.png");
    EXPECT_EQ(warnings.messages("x.mtl"), Strings{"x.mtl:7: " + message});
  }
}

}  // namespace
}  // namespace tessera::core::mtl_test
