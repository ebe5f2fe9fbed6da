#include <gtest/gtest.h>

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
      one("Ns 250\nKa 1 1 1\nKd 0.8 0.4 0.2\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nd 1.0\nillum 2\n");
  EXPECT_EQ(m.material.name, "m");
  EXPECT_EQ(std::get<Lambert>(m.material.model).albedo.value, (Rgb{0.8f, 0.4f, 0.2f}));
  EXPECT_TRUE(is_black(m.material.emission));
  EXPECT_EQ(m.albedo_file, "");
}

TEST(Mtl, MapsEmission) {
  EXPECT_EQ(one("Ke 17 12 4\n").material.emission, (Rgb{17, 12, 4}));
}

TEST(Mtl, MapsMirrors) {
  for (const auto illum : {"3", "5", "8"})
    EXPECT_EQ(model<Mirror>("Ks 0.9 0.8 2\nillum " + std::string(illum)).reflectance.value,
              (Rgb{0.9f, 0.8f, 1}));
  model<Lambert>("Kd 1 1 1\nKs 0 0 0\nillum 3\n");  // nothing to mirror with
}

TEST(Mtl, MapsGlass) {
  for (const auto illum : {"4", "6", "7", "9"}) {
    const Glass glass = model<Glass>("Ni 1.33\nTf 0.9 1 0.9\nillum " + std::string(illum));
    EXPECT_EQ(glass.ior, 1.33f);
    EXPECT_EQ(glass.transmittance.value, (Rgb{0.9f, 1, 0.9f}));
    EXPECT_EQ(glass.reflectance.value, Rgb::gray(1));
  }
  EXPECT_EQ(model<Glass>("illum 7\n").ior, 1.5f);
  EXPECT_EQ(model<Glass>("d 0.1\nNi 2\n").ior, 2);
  EXPECT_EQ(model<Glass>("Tr 0.9\nNi 2\n").ior, 2);
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
      {"newmtl a\nd 2\n", "2: 'd' must be a number between 0 and 1, got '2'"},
  };
  for (const auto& [text, message] : cases) {
    const auto materials = read_mtl(text, "x.mtl");
    EXPECT_EQ(materials ? "no error" : materials.error().message, "x.mtl:" + message) << text;
  }
}

}  // namespace
}  // namespace tessera::core
