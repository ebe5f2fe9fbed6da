#include <gtest/gtest.h>

#include "core/scene/loader/mtl_map.hpp"
#include "core/scene/loader/mtl_reader.hpp"

namespace tessera::core {
namespace {

MtlMaterial one(const std::string& statements) {
  const auto materials = read_mtl("newmtl m\n" + statements, "x.mtl");
  EXPECT_TRUE(materials.has_value()) << materials.error().message;
  EXPECT_EQ(materials->size(), 1u);
  return materials && !materials->empty() ? materials->front() : MtlMaterial{};
}

template <typename Model>
Model model(const std::string& statements) {
  const auto material = one(statements).material;
  const auto* found = std::get_if<Model>(&material.model);
  EXPECT_NE(found, nullptr) << statements;
  return found == nullptr ? Model{} : *found;
}

TEST(Mtl, MapsMattMaterials) {
  const MtlMaterial m =
      one("Ns 250\nKa 1 1 1\nKd 0.8 0.4 0.2\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nd 1.0\nillum 1\n");
  EXPECT_EQ(m.material.name, "m");
  EXPECT_EQ(std::get<Lambert>(m.material.model).albedo.value, (Rgb{0.8f, 0.4f, 0.2f}));
  EXPECT_TRUE(is_black(m.material.emission.value));
  EXPECT_EQ(m.albedo_file, "");
}

TEST(Mtl, MapsEmission) {
  EXPECT_EQ(one("Ke 17 12 4\n").material.emission.value, (Rgb{17, 12, 4}));
}

TEST(Mtl, MapsMirrors) {
  for (const auto illum : {"3", "5", "8"})
    EXPECT_EQ(model<Mirror>("Ks 0.9 0.8 2\nillum " + std::string(illum)).reflectance.value,
              (Rgb{0.9f, 0.8f, 1}));
  model<Lambert>("Kd 1 1 1\nKs 0 0 0\nillum 3\n");  // nothing to mirror with
}

TEST(Mtl, MapsHighlights) {
  const Phong phong = model<Phong>("Ns 250\nKd 0.5 0.25 0\nKs 0.25 0.25 0.5\nillum 2\n");
  EXPECT_EQ(phong.diffuse.value, (Rgb{0.5f, 0.25f, 0}));
  EXPECT_EQ(phong.specular.value, (Rgb{0.25f, 0.25f, 0.5f}));
  EXPECT_EQ(phong.exponent.value, 250);
  EXPECT_EQ(model<Phong>("Ns 1e9\nKs 1 1 1\nillum 2\n").exponent.value, 1e5f);
  // Without a highlight, without a sharpness, and where the file asks for none.
  model<Lambert>("Ns 250\nKd 1 0 0\nKs 0 0 0\nillum 2\n");
  model<Lambert>("Ns -1.960784\nKd 1 0 0\nKs 1 1 1\nillum 2\n");
  model<Lambert>("Kd 1 0 0\nKs 1 1 1\nillum 2\n");
  model<Lambert>("Ns 250\nKd 1 0 0\nKs 1 1 1\nillum 1\n");
}

TEST(Mtl, DimsHighlightsThatReflectMoreThanTheSurfaceGets) {
  const Phong phong = model<Phong>("Ns 10\nKd 0.75 0.5 0\nKs 0.5 0.5 1\nillum 2\n");
  EXPECT_EQ(phong.diffuse.value, (Rgb{0.75f, 0.5f, 0}));
  EXPECT_EQ(phong.specular.value, (Rgb{0.25f, 0.25f, 0.5f}));
  EXPECT_EQ(model<Phong>("Ns 10\nKd 0 0 0\nKs 9 9 9\nillum 2\n").specular.value, Rgb::gray(1));
  const Phong textured = model<Phong>("Ns 10\nKs 0.5 0.5 0.5\nmap_Kd a.png\nillum 2\n");
  EXPECT_EQ(textured.diffuse.value, Rgb::gray(1));
  EXPECT_EQ(textured.specular.value, Rgb::gray(0.5f));
}

TEST(Mtl, MapsGlass) {
  for (const auto illum : {"4", "6", "7", "9"}) {
    const Glass glass = model<Glass>("Ni 1.33\nTf 0.9 1 0.9\nillum " + std::string(illum));
    EXPECT_EQ(glass.ior.value, 1.33f);
    EXPECT_EQ(glass.transmittance.value, (Rgb{0.9f, 1, 0.9f}));
    EXPECT_EQ(glass.reflectance.value, Rgb::gray(1));
  }
  EXPECT_EQ(model<Glass>("illum 7\n").ior.value, 1.5f);
  EXPECT_EQ(model<Glass>("d 0.1\nNi 2\n").ior.value, 2);
  EXPECT_EQ(model<Glass>("Tr 0.9\nNi 2\n").ior.value, 2);
  model<Lambert>("d 0.1\n");  // without an index of refraction it is a cut-out, not glass
}

TEST(Mtl, MapsTextures) {
  const MtlMaterial m =
      one("Kd 0.5 0.5 0.5\nmap_Kd -clamp on -s 2 3 1 -o 0.25 0.5 0 my textures\\wood 1.png \n");
  EXPECT_EQ(m.albedo_file, "my textures/wood 1.png");
  EXPECT_EQ(m.wrap, Wrap::kClamp);
  EXPECT_EQ(m.scale, (Vec2{2, 3}));
  EXPECT_EQ(m.offset, (Vec2{0.25f, 0.5f}));
  EXPECT_EQ(std::get<Lambert>(m.material.model).albedo.value, Rgb::gray(0.5f));
  EXPECT_EQ(model<Lambert>("Kd 0 0 0\nmap_Kd a.png").albedo.value, Rgb::gray(1));
}

TEST(Mtl, ReadsColorsOfOneNumberAndComments) {
  EXPECT_EQ(model<Lambert>("Kd 0.5 # gray\n").albedo.value, Rgb::gray(0.5f));
  EXPECT_EQ(model<Lambert>("Kd 1 0.5 0#c\n# Kd 2\n").albedo.value, (Rgb{1, 0.5f, 0}));
}

TEST(Mtl, BelievesDRatherThanTr) {
  model<Lambert>("d 1\nTr 1\nNi 1.5\n");
  model<Lambert>("Tr 1\nd 1\nNi 1.5\n");
  model<Glass>("d -halo 0.5\nNi 1.5\n");
}

TEST(Mtl, ReadsTheOptionsOfMaps) {
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
      {"-blendu on -blendv off -cc on -imfchan r -type sphere -colorspace sRGB a.png", {.file = "a.png"}},
      {"-bm 1 -boost 2 -mm 0 1 -texres 512 -t 1 1 1 C:\\maps\\a b.png", {.file = "C:/maps/a b.png"}},
      {"\"a b.png\"", {.file = "a b.png"}},
      {"a-s.png -s", {.file = "a-s.png -s"}},
  };
  for (const auto& [line, expected] : cases) {
    const auto map = read_mtl_map("map_Kd", line);
    ASSERT_TRUE(map.has_value()) << line << ": " << map.error().message;
    EXPECT_EQ(*map, expected) << line << ": " << map->file;
  }
}

TEST(Mtl, PassesOverWhatItDoesNotKnow) {
  const MtlMaterial m =
      one("Ka spectral x.rfl\nmap_Ks -foo x.png\nPr 0.5\nsharpness\nrefl -type sphere x.hdr\n\xff\xfe\nKd 1 "
          "0 0\n");
  EXPECT_EQ(std::get<Lambert>(m.material.model).albedo.value, (Rgb{1, 0, 0}));
}

TEST(Mtl, ReadsSeveralMaterialsAndAnyLineEnds) {
  const auto materials =
      read_mtl("\xef\xbb\xbf# c\r\nnewmtl  first one \r\nKd 1 0 0\r\n\r\nnewmtl two\r\n\tKd 0 1 0", "x.mtl");
  ASSERT_TRUE(materials.has_value());
  ASSERT_EQ(materials->size(), 2u);
  EXPECT_EQ((*materials)[0].material.name, "first one");
  EXPECT_EQ((*materials)[1].material.name, "two");
  EXPECT_EQ(std::get<Lambert>((*materials)[1].material.model).albedo.value, (Rgb{0, 1, 0}));
  EXPECT_TRUE(read_mtl("", "x.mtl")->empty());
}

TEST(Mtl, ReportsMistakesWithTheirLine) {
  const std::pair<std::string, std::string> cases[] = {
      {"newmtl \n", "1: 'newmtl' needs a name"},
      {"newmtl a\nKd 1 0\n", "2: 'Kd' must be 3 numbers between 0 and 1, got '1 0'"},
      {"newmtl a\nKd red\n", "2: 'Kd' must be 3 numbers between 0 and 1, got 'red'"},
      {"newmtl a\nKd 1 1 1.5\n", "2: 'Kd' must be 3 numbers between 0 and 1, got '1 1 1.5'"},
      {"newmtl a\nKd 1 1 1 1\n", "2: 'Kd' must be 3 numbers between 0 and 1, got '1 1 1 1'"},
      {"newmtl a\nKd spectral a.rfl\n", "2: 'Kd' must be 3 numbers between 0 and 1, got 'spectral a.rfl'"},
      {"newmtl a\n\nKe 1 -1 1\n", "3: 'Ke' must be 3 numbers between 0 and 1e+30, got '1 -1 1'"},
      {"newmtl a\nKe nan 1 1\n", "2: 'Ke' must be 3 numbers between 0 and 1e+30, got 'nan 1 1'"},
      {"newmtl a\nNi 20\n", "2: 'Ni' must be a number between 0 and 10, got '20'"},
      {"newmtl a\nillum\n", "2: 'illum' must be a number between 0 and 10, got ''"},
      {"newmtl # a\n", "1: 'newmtl' needs a name"},
      {"# a\nKd 1 1 1\n", "2: 'Kd' belongs to no material; a 'newmtl' must come before it"},
      {"map_Kd a.png\n", "1: 'map_Kd' belongs to no material; a 'newmtl' must come before it"},
      {"newmtl a\nKd\n", "2: 'Kd' must be 3 numbers between 0 and 1, got ''"},
      {"newmtl a\nd halo 1\n", "2: 'd' must be a number between 0 and 1, got 'halo 1'"},
      {"newmtl a\nNi 1.5 1.5\n", "2: 'Ni' must be a number between 0 and 10, got '1.5 1.5'"},
      {"newmtl a\nmap_Kd\n", "2: 'map_Kd' needs the name of a picture"},
      {"newmtl a\nmap_Kd -clamp on\n", "2: 'map_Kd' needs the name of a picture"},
      {"newmtl a\nmap_Kd # a.png\n", "2: 'map_Kd' needs the name of a picture"},
      {"newmtl a\nmap_Kd -s a.png\n",
       "2: '-s' must be followed by a number and the name of a picture, got 'a.png'"},
      {"newmtl a\nmap_Kd -mm 1 a.png\n",
       "2: '-mm' must be followed by 2 numbers and the name of a picture, got 'a.png'"},
      {"newmtl a\nmap_Kd -bm\n", "2: '-bm' must be followed by a number and the name of a picture, got ''"},
      {"newmtl a\nmap_Kd -clamp a.png\n", "2: '-clamp' must be followed by on or off, got 'a.png'"},
      {"newmtl a\nmap_Kd -scale 2 a.png\n", "2: '-scale' is not an option of 'map_Kd'"},
      {"newmtl a\nd 2\n", "2: 'd' must be a number between 0 and 1, got '2'"},
  };
  for (const auto& [text, message] : cases) {
    const auto materials = read_mtl(text, "x.mtl");
    EXPECT_EQ(materials ? "no error" : materials.error().message, "x.mtl:" + message) << text;
  }
}

}  // namespace
}  // namespace tessera::core
