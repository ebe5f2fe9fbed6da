// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/image/file_io.hpp"
#include "core/math/elementary.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/scene.hpp"
#include "scenes/go/furniture.hpp"
#include "scenes/go/setting.hpp"
#include "scenes/go/sgf.hpp"
#include "scenes/go/stones.hpp"
#include "scenes/modelling/surface.hpp"
#include "tests/unit/scenes/mesh_properties.hpp"

namespace tessera::go {
namespace {

using core::MeshDescription;
using core::Vec2;
using core::Vec3;

const std::string kFolder = TESSERA_SCENES_DIR "/go/";

Position shipped_position() {
  const std::string path = kFolder + "lee_sedol_alphago_4.sgf";
  return replay(parse_sgf(core::read_file(path).value(), path).value(), 94, path).value();
}

TEST(StoneMesh, IsAClosedLensOfTheShapeAskedFor) {
  for (const StoneShape& shape : {kSlate, kShell}) {
    const MeshDescription mesh = stone_mesh(shape, {}, 96, 64);
    EXPECT_EQ(modelling::open_edge_count(mesh), 0);
    Vec3 most;
    for (const Vec3 p : mesh.positions) most = max(most, abs(p));
    EXPECT_NEAR(most.x, shape.radius, 2e-3);
    EXPECT_NEAR(most.y, shape.half_thickness, 1e-5);
    // More than two cones of this size, less than a cylinder.
    const double cylinder =
        2 * static_cast<double>(core::kPi) * shape.radius * shape.radius * shape.half_thickness;
    EXPECT_GT(modelling::enclosed_volume(mesh), cylinder / 3);
    EXPECT_LT(modelling::enclosed_volume(mesh), cylinder);
  }
}

TEST(StoneMesh, HasTheNormalsOfItsSurface) {
  const Pose pose{{3, 2, 1}, normalize(Vec3{0.2f, 1, -0.4f}), 0.3f};
  MeshDescription mesh = stone_mesh(kShell, pose, 128, 96);
  const std::vector<Vec3> exact = mesh.normals;
  modelling::smooth_normals(mesh);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_NEAR(length(exact[i]), 1, 1e-5);
    EXPECT_GT(dot(exact[i], mesh.normals[i]), 0.99f) << "vertex " << i;
  }
}

float distance(const PlacedStone& a, const PlacedStone& b) {
  return length(a.pose.center - b.pose.center);
}

TEST(LayOut, CrowdedStonesMakeRoomForEachOther) {
  Board board(19);
  for (int row = 0; row < 19; ++row) {
    for (int column = 0; column < 19; ++column)
      board.set_up({column, row}, (row + column) % 2 == 0 ? Stone::kBlack : Stone::kWhite);
  }
  const std::vector<PlacedStone> stones = lay_out(board, {-1, -1});
  ASSERT_EQ(stones.size(), 361u);
  for (std::size_t i = 0; i < stones.size(); ++i) {
    const Point p{static_cast<int>(i) % 19, static_cast<int>(i) / 19};
    EXPECT_LT(length(stones[i].pose.center - intersection(p, 19)), 1.1f) << p.column << ", " << p.row;
    EXPECT_FLOAT_EQ(stones[i].pose.center.y, shape_of(stones[i].color).half_thickness);
    for (std::size_t j = 0; j < i; ++j) {
      const float together = shape_of(stones[i].color).radius + shape_of(stones[j].color).radius;
      EXPECT_GT(distance(stones[i], stones[j]), together - 2e-3f) << i << " and " << j;
    }
  }
}

TEST(LayOut, ThePreciseStoneLiesWhereItsLinesMeet) {
  const Position position = shipped_position();
  int found = 0;
  for (const PlacedStone& stone : lay_out(position.board, *position.last_white)) {
    const Vec3 off = stone.pose.center - intersection(*position.last_white, 19);
    if (off.x == 0 && off.z == 0) ++found;
  }
  EXPECT_EQ(found, 1);
}

TEST(HeapUp, StonesStayInTheVesselAndApart) {
  const Heap heap{kSlate, 50, 5, [](float) { return 1.0f; }, 7};
  const std::vector<Pose> poses = heap_up(heap);
  ASSERT_EQ(poses.size(), 50u);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vec3 p = poses[i].center;
    EXPECT_LE(std::sqrt(p.x * p.x + p.z * p.z), heap.inner_radius - kSlate.radius + 1e-3f);
    EXPECT_GT(p.y, 1 + kSlate.half_thickness - 0.01f);
    EXPECT_LT(p.y, 5);
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GT(length(p - poses[j].center), 2 * kSlate.half_thickness - 0.02f);
  }
}

TEST(LidFloor, RisesFromTheMiddleToTheRim) {
  const auto floor = lid_floor();
  float below = floor(0);
  EXPECT_NEAR(below, 0.42f, 0.01f);
  for (float radius = 0.25f; radius < 5.5f; radius += 0.25f) {
    EXPECT_GE(floor(radius), below - 1e-3f) << radius;
    below = floor(radius);
  }
  EXPECT_GT(below, 1);
}

// The colour of the board's top where it is `x` and `z` from its middle.
core::Rgb top_color(const Model& top, float half_x, float half_z, float x, float z) {
  const auto pixel = [](float share, int size) { return static_cast<int>(share * static_cast<float>(size)); };
  return top.color.at(pixel((x + half_x) / (2 * half_x), top.color.width),
                      pixel((z + half_z) / (2 * half_z), top.color.height));
}

TEST(BoardTop, HasItsLinesAndStarPointsWhereStonesLie) {
  const Model top = board_top(9);
  Vec3 most;
  for (const Vec3 p : top.mesh.positions) most = max(most, abs(p));
  const auto brightness = [&](Vec3 p) { return luminance(top_color(top, most.x, most.z, p.x, p.z)); };
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 9; ++column) {
      const Vec3 p = intersection({column, row}, 9);
      EXPECT_LT(brightness(p), 0.05f) << column << ", " << row;
      const Vec3 beside = p + Vec3{0.15f, 0, 0.15f};  // on star points still lacquered
      const bool star = (column == 2 || column == 4 || column == 6) && (row == 2 || row == 4 || row == 6);
      EXPECT_EQ(brightness(beside - Vec3{0.02f, 0, 0.02f}) < 0.1f, star) << column << ", " << row;
      EXPECT_GT(brightness(p + Vec3{0.8f, 0, 0.8f}), 0.15f) << column << ", " << row;
    }
  }
  EXPECT_GT(brightness({most.x - 0.3f, 0, 0}), 0.15f);
}

TEST(BoardSides, ReachFromTheTopToTheTable) {
  const MeshDescription top = board_top(9).mesh, sides = board_sides(9).mesh;
  Vec3 top_most, most, least;
  for (const Vec3 p : top.positions) top_most = max(top_most, abs(p));
  for (std::size_t i = 0; i < sides.positions.size(); ++i) {
    const Vec3 p = sides.positions[i], outward{p.x, 0, p.z};
    most = max(most, p);
    least = min(least, p);
    EXPECT_GT(dot(sides.normals[i], outward), 0) << "vertex " << i;
    if (p.y == 0) {
      EXPECT_TRUE(std::fabs(p.x) == top_most.x || std::fabs(p.z) == top_most.z) << "vertex " << i;
    }
  }
  EXPECT_EQ(most.y, 0);
  EXPECT_FLOAT_EQ(least.y, -kBoardHeight);
  EXPECT_FLOAT_EQ(most.x, -least.x);
  EXPECT_GT(most.x, top_most.x);
}

TEST(Setting, ModelsAreSoundAndHaveTheTrianglesOfTheReport) {
  const Position position = shipped_position();
  std::size_t triangles = 0;
  for (const auto& [name, make] : setting(position)) {
    if (name.find("stones") == std::string::npos && name != "bowls" && name != "lids") continue;
    const MeshDescription mesh = make().mesh;
    triangles += mesh.triangles.size();
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << name;
    ASSERT_EQ(mesh.uvs.size(), mesh.positions.size()) << name;
    for (const Vec3 p : mesh.positions) ASSERT_TRUE(is_finite(p)) << name;
    for (const Vec3 n : mesh.normals) ASSERT_NEAR(length(n), 1, 1e-4) << name;
  }
  EXPECT_GE(triangles, 138305u);
}

TEST(Setting, GamesWithoutCapturesOrMovesAreLaidOutToo) {
  const Position position = replay(parse_sgf("(;SZ[9])", "empty.sgf").value(), {}, "empty.sgf").value();
  for (const auto& [name, make] : setting(position)) {
    if (name == "black_stones" || name == "white_stones") {
      EXPECT_FALSE(make().mesh.triangles.empty());
    }
  }
}

TEST(Setting, IsSummedUpForPeople) {
  const GameRecord record = parse_sgf("(;SZ[9]PB[Ann];B[ab];W[aa];B[ba];W[ee])", "game.sgf").value();
  EXPECT_EQ(summary(record, replay(record, 3, "game.sgf").value()),
            "Ann (black), unknown (white): 3 moves; captured 0 black, 1 white");
  EXPECT_EQ(summary(record, replay(record, 4, "game.sgf").value()),
            "Ann (black), unknown (white): 4 moves; captured 0 black, 1 white; the last white stone is at "
            "[0.00, 0.00, 0.00]");
}

TEST(GoScene, IsRead) {
  const core::Result<core::SceneDescription> description = core::load_scene_file(kFolder + "scene.json");
  ASSERT_TRUE(description) << description.error().message;
  std::size_t triangles = 0;
  for (const core::ShapeDescription& shape : description->shapes) {
    if (const auto* mesh = std::get_if<MeshDescription>(&shape)) triangles += mesh->triangles.size();
  }
  EXPECT_GE(triangles, 138305u);
  const auto scene = core::Scene::build(*description, 2);
  EXPECT_TRUE(scene) << scene.error().message;
}

}  // namespace
}  // namespace tessera::go
