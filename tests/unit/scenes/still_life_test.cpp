// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "scenes/still_life/fruit.hpp"
#include "scenes/still_life/mosaic_vase.hpp"
#include "scenes/still_life/pottery.hpp"
#include "scenes/still_life/table.hpp"
#include "tests/unit/scenes/mesh_properties.hpp"

namespace tessera::still_life {
namespace {

struct Expectation {
  const char* name;
  Model (*make)();
  bool closed, textured, stands_at_zero;
  std::size_t least_triangles;
};
void PrintTo(const Expectation& e, std::ostream* out) {
  *out << e.name;
}

class StillLifeModel : public testing::TestWithParam<Expectation> {};

void expect_sound(const core::MeshDescription& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    ASSERT_TRUE(is_finite(mesh.positions[i])) << "vertex " << i;
    ASSERT_NEAR(length(mesh.normals[i]), 1, 1e-5) << "vertex " << i;
    ASSERT_TRUE(mesh.uvs[i].x >= 0 && mesh.uvs[i].x <= 1 && mesh.uvs[i].y >= 0 && mesh.uvs[i].y <= 1)
        << "vertex " << i;
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    ASSERT_LT(std::max({a, b, c}), mesh.positions.size());
  }
}

TEST_P(StillLifeModel, IsWhatItsHeaderSays) {
  const auto& [name, make, closed, textured, stands_at_zero, least_triangles] = GetParam();
  const Model model = make();
  EXPECT_GE(model.mesh.triangles.size(), least_triangles);
  expect_sound(model.mesh);
  if (closed) {
    EXPECT_EQ(modelling::open_edge_count(model.mesh), 0);
    EXPECT_GT(modelling::enclosed_volume(model.mesh), 0);
  }
  if (stands_at_zero) {
    float lowest = 1;
    for (const core::Vec3 p : model.mesh.positions) lowest = std::min(lowest, p.y);
    EXPECT_NEAR(lowest, 0, 0.05);
  }
  EXPECT_EQ(!model.texture.pixels.empty(), textured);
  for (const core::Rgb c : model.texture.pixels) {
    ASSERT_TRUE(is_finite(c));
    ASSERT_TRUE(std::min({c.r, c.g, c.b}) >= 0 && max_component(c) < 1.2f);
  }
}

INSTANTIATE_TEST_SUITE_P(All, StillLifeModel,
                         testing::Values(Expectation{"vase", mosaic_vase, true, true, true, 50000},
                                         Expectation{"bottle", stoneware_bottle, true, true, true, 10000},
                                         Expectation{"bowl", speckled_bowl, true, true, true, 10000},
                                         Expectation{"goblet", goblet, true, false, true, 10000},
                                         Expectation{"orange", orange, true, true, true, 10000},
                                         Expectation{"lemon", lemon, true, true, true, 10000},
                                         Expectation{"pear", pear, true, true, true, 10000},
                                         Expectation{"table", table, false, true, false, 1000},
                                         Expectation{"linen", linen, false, true, false, 10000}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(MosaicVase, HasStonesAndGold) {
  const core::MeshDescription mesh = mosaic_vase().mesh;
  ASSERT_EQ(mesh.triangle_materials.size(), mesh.triangles.size());
  const auto gold = std::count(mesh.triangle_materials.begin(), mesh.triangle_materials.end(), 1u);
  EXPECT_GT(gold, 1000);
  EXPECT_LT(static_cast<std::size_t>(gold), mesh.triangles.size() / 4);
}

TEST(Linen, LiesOnTheTableAndFallsOverItsEdge) {
  const core::MeshDescription mesh = linen().mesh;
  float lowest = 0;
  for (const core::Vec3 p : mesh.positions) {
    lowest = std::min(lowest, p.y);
    if (p.z < 30) {
      EXPECT_GT(p.y, 0) << "at x = " << p.x << ", z = " << p.z;
    }
  }
  EXPECT_LT(lowest, -5);
}

}  // namespace
}  // namespace tessera::still_life
