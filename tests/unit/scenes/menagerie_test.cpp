// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "core/image/file_io.hpp"
#include "scenes/menagerie/cow.hpp"
#include "scenes/menagerie/originals.hpp"
#include "scenes/menagerie/rabbit.hpp"
#include "tests/unit/scenes/mesh_properties.hpp"

namespace tessera::menagerie {
namespace {

using core::Vec3;

constexpr float kCoarse = 0.4f;

struct Box {
  Vec3 low, high;
};

Box bounds(const core::MeshDescription& mesh) {
  Box box{mesh.positions.front(), mesh.positions.front()};
  for (const Vec3 p : mesh.positions) box = {min(box.low, p), max(box.high, p)};
  return box;
}

void expect_animal(const core::MeshDescription& mesh, float height_cm) {
  EXPECT_EQ(modelling::open_edge_count(mesh), 0);
  EXPECT_GT(modelling::enclosed_volume(mesh), 300);
  EXPECT_NEAR(bounds(mesh).low.y, 0, 0.1);
  EXPECT_NEAR(bounds(mesh).high.y, height_cm, 1);
}

TEST(Rabbit, IsAClosedRabbitOnTheGround) {
  expect_animal(rabbit(kCoarse), 20);
}

TEST(Cow, IsAClosedCowOnTheGround) {
  const core::MeshDescription mesh = cow(kCoarse, 512);
  expect_animal(mesh, 19);
  EXPECT_EQ(mesh.uvs.size(), mesh.positions.size());
}

TEST(Cow, IsPatchedAndHasAPinkMuzzle) {
  const core::MeshDescription mesh = cow(kCoarse, 512);
  const core::Image coat = cow_coat(mesh, 512);
  int dark = 0, light = 0, on_muzzle = 0, pink = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const int x = static_cast<int>(mesh.uvs[i].x * 512), y = 511 - static_cast<int>(mesh.uvs[i].y * 512);
    const core::Rgb color = coat.at(x, y);
    dark += color.g < 0.1f;
    light += color.g > 0.6f;
    if (mesh.positions[i].z < 12.9f || mesh.positions[i].y > 12.2f) continue;
    ++on_muzzle;
    pink += color.r > 1.3f * color.g && color.r > 0.5f;
  }
  const auto vertices = static_cast<int>(mesh.positions.size());
  EXPECT_GT(dark, vertices / 6);
  EXPECT_GT(light, vertices / 6);
  EXPECT_GT(on_muzzle, 0);
  EXPECT_GT(pink, on_muzzle / 2);
}

TEST(Originals, AreTurnedScaledAndPutOnTheGround) {
  const std::string path = testing::TempDir() + "original.obj";
  ASSERT_TRUE(core::write_file_atomically(path, "v 1 5 0\nv 4 5 0\nv 4 7 1\nf 1 2 3\n"));
  const auto mesh = read_original(path, {90, 10});
  ASSERT_TRUE(mesh) << mesh.error().message;
  const Box box = bounds(*mesh);
  EXPECT_FLOAT_EQ(box.low.y, 0);
  EXPECT_FLOAT_EQ(box.high.y, 10);
  EXPECT_NEAR(box.low.z, -7.5f, 1e-4);
  EXPECT_NEAR(box.high.z, 7.5f, 1e-4);
  EXPECT_NEAR(box.low.x + box.high.x, 0, 1e-4);
  EXPECT_EQ(mesh->normals.size(), mesh->positions.size());
}

TEST(Originals, MissingOneIsAnErrorThatNamesIt) {
  const auto mesh = read_original("no/such.obj", {0, 1});
  ASSERT_FALSE(mesh);
  EXPECT_NE(mesh.error().message.find("no/such.obj"), std::string::npos);
}

}  // namespace
}  // namespace tessera::menagerie
