// SPDX-License-Identifier: Apache-2.0
// Renders of meshes that deform while the shutter is open: the mean of still images at the times of the
// samples, and the bytes of a still image where nothing changes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/film/fixed_point.hpp"
#include "core/integrators/render.hpp"
#include "core/scene/scene.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

using testing::HasSubstr;

constexpr int kSide = 8;

// A flag of 6 x 6 squares whose lower edge stays, with normals and texture coordinates; `bend` moves its
// upper edge.
MeshDescription flag(float bend, std::uint32_t material) {
  constexpr int kParts = 6;
  MeshDescription mesh;
  for (int row = 0; row <= kParts; ++row)
    for (int column = 0; column <= kParts; ++column) {
      const float u = static_cast<float>(column) / kParts, v = static_cast<float>(row) / kParts;
      mesh.positions.push_back({u - 0.5f + bend * v * v, 1.5f * v + 0.2f, -0.2f + 0.4f * bend * u * v});
      mesh.normals.push_back({bend * v, 0, 1});
      mesh.uvs.push_back({u, v});
    }
  const auto at = [](int column, int row) { return static_cast<std::uint32_t>(row * (kParts + 1) + column); };
  for (int row = 0; row < kParts; ++row)
    for (int column = 0; column < kParts; ++column) {
      mesh.triangles.push_back({at(column, row), at(column + 1, row), at(column + 1, row + 1)});
      mesh.triangles.push_back({at(column, row), at(column + 1, row + 1), at(column, row + 1)});
    }
  mesh.triangle_materials = {material};
  return mesh;
}

// Without normals, which between steps are not those of a mesh of its own.
MeshDescription flat(MeshDescription mesh) {
  mesh.normals = {};
  for (MeshStep& step : mesh.steps) step.normals = {};
  return mesh;
}

// With steps at the frames 0, 1, ... in which the flag is bent so much.
MeshDescription waving(const std::vector<float>& bends, std::uint32_t material) {
  MeshDescription mesh = flag(bends[0], material);
  for (std::size_t i = 0; i < bends.size(); ++i) {
    const MeshDescription bent = flag(bends[i], material);
    mesh.steps.push_back({static_cast<float>(i), bent.positions, bent.normals});
  }
  return mesh;
}

// A flag in a room, on its own or as an object's.
SceneDescription room_with(MeshDescription mesh, FrameInterval shutter, bool in_object = false) {
  SceneDescription room = test::room();
  room.animation.deforms = !mesh.steps.empty();
  if (in_object) {
    room.objects = {{"flag", {std::move(mesh)}, {}}};
    room.shapes.push_back(InstanceDescription{0, translation({0.1f, 0, 0.2f}), std::nullopt});
  } else {
    room.shapes.push_back(std::move(mesh));
  }
  room.camera.shutter_open = shutter.begin;
  room.camera.shutter_close = shutter.end;
  room.settings = {.width_px = kSide, .height_px = kSide, .spp = 64};
  return room;
}

// Before a wall, under a lamp and the sky: without what makes noise.
SceneDescription yard_with(MeshDescription mesh, FrameInterval shutter, bool in_object) {
  SceneDescription yard = room_with(std::move(mesh), shutter, in_object);
  std::erase_if(yard.shapes, [](const ShapeDescription& shape) {
    return std::holds_alternative<SphereDescription>(shape) || std::holds_alternative<QuadDescription>(shape);
  });
  yard.shapes.insert(yard.shapes.begin(), QuadDescription{{-3, -1, -1}, {6, 0, 0}, {0, 5, 0}, 0});
  yard.lights = {PointLightDescription{{1, 2, 3}, Rgb::gray(20)}};
  yard.environment = EnvironmentDescription{ColorParameter{Rgb::gray(0.5f)}};
  return yard;
}

FilmTile film_of(const Scene& scene, SampleRange range, int threads = 2) {
  return render(prepare(scene, scene.settings(), threads), {0, 0, kSide, kSide}, range, threads);
}

FilmTile film_of(const SceneDescription& scene, SampleRange range, int threads = 2) {
  return film_of(Scene::build(scene, threads).value(), range, threads);
}

std::vector<double> means_of(const FilmTile& tile, double samples) {
  std::vector<double> means;
  for (std::size_t i = 0; i < tile.sums.size(); ++i)
    means.push_back(static_cast<double>(tile.sums[i]) * kFilmUnit / samples);
  return means;
}

// The flag as it is at a frame, without steps.
MeshDescription flag_at(const MeshDescription& mesh, float frame) {
  MeshDescription still = mesh;
  still.steps = {};
  const VertexMotion motion(mesh.steps);
  for (std::size_t v = 0; v < motion.vertex_count(); ++v) {
    still.positions[v] = motion.position(v, motion.at(frame));
    if (motion.has_normals()) still.normals[v] = motion.normal(v, motion.at(frame));
  }
  return still;
}

TEST(Deformation, IsTheMeanOfStillImages) {
  constexpr std::uint32_t kTimes = 64, kSamples = 16;
  for (const bool in_object : {false, true}) {
    const MeshDescription mesh = waving({-0.6f, 0.5f, 0.1f}, 1);
    const auto blurred = means_of(
        film_of(yard_with(mesh, {0.25f, 1.75f}, in_object), {0, kTimes * kSamples}, 1), kTimes * kSamples);
    std::vector<double> sum(blurred.size()), squares(blurred.size());
    for (std::uint32_t i = 0; i < kTimes; ++i) {
      const float frame = FrameInterval{0.25f, 1.75f}.at((static_cast<float>(i) + 0.5f) / kTimes);
      const auto one = means_of(
          film_of(yard_with(flag_at(mesh, frame), {}, in_object), {kSamples * i, kSamples * (i + 1)}, 1),
          kSamples);
      for (std::size_t p = 0; p < one.size(); ++p) sum[p] += one[p], squares[p] += one[p] * one[p];
    }
    double total = 0, expected_total = 0, worst = 0;
    for (std::size_t p = 0; p < sum.size(); ++p) {
      const double mean = sum[p] / kTimes, variance = squares[p] / kTimes - mean * mean;
      // Both are means of as many samples. What passes a pixel between two stills is missing in their
      // variance.
      worst =
          std::max(worst, std::abs(blurred[p] - mean) / (std::sqrt(2 * variance / kTimes) + 0.005 * mean));
      total += blurred[p];
      expected_total += mean;
    }
    EXPECT_LT(worst, 5) << in_object;
    EXPECT_NEAR(total, expected_total, 0.02 * expected_total) << in_object;
  }
}

TEST(Deformation, HasTheSameBytesWithAnyNumberOfThreads) {
  for (const bool in_object : {false, true}) {
    const SceneDescription scene = room_with(waving({-0.6f, 0.5f}, 4), {0, 1}, in_object);
    EXPECT_EQ(film_of(scene, {0, 16}, 1).sums, film_of(scene, {0, 16}, 4).sums);
  }
}

// Also through the code of triangles that move.
TEST(Deformation, BetweenEqualStepsHasTheBytesOfAStillMesh) {
  for (const bool in_object : {false, true}) {
    const Scene moving =
        Scene::build(room_with(waving({0.4f, 0.4f, 0.4f}, 1), {0.25f, 1.5f}, in_object), 1).value();
    EXPECT_TRUE(moving.has_motion());
    EXPECT_EQ(film_of(moving, {0, 16}).sums, film_of(room_with(flag(0.4f, 1), {}, in_object), {0, 16}).sums)
        << in_object;
  }
}

TEST(Deformation, IsShownAtAnInstant) {
  const MeshDescription mesh = flat(waving({-0.6f, 0.5f}, 1));
  EXPECT_EQ(film_of(room_with(mesh, {0.3f, 0.3f}), {0, 4}).sums,
            film_of(room_with(flag_at(mesh, 0.3f), {}), {0, 4}).sums);
}

TEST(Deformation, IsOffWhereNothingChangesMeanwhile) {
  const MeshDescription mesh = flat(waving({-0.6f, 0.5f}, 1));
  const SceneDescription later = room_with(mesh, {1, 2});
  EXPECT_FALSE(Scene::build(later, 1).value().has_motion());
  EXPECT_EQ(film_of(later, {0, 4}).sums, film_of(room_with(flag_at(mesh, 1), {}), {0, 4}).sums);
}

TEST(Deformation, FollowsTheFrames) {
  const MeshDescription mesh = flat(waving({-0.6f, 0.5f, 0, 0.3f}, 1));
  for (const bool in_object : {false, true}) {
    Scene shown = Scene::build(room_with(mesh, {}, in_object), 1).value();
    const FilmTile first = film_of(shown, {0, 4});
    ASSERT_TRUE(shown.set_frame(2, 1));
    EXPECT_EQ(film_of(shown, {0, 4}).sums, film_of(room_with(flag_at(mesh, 2), {}, in_object), {0, 4}).sums);
    ASSERT_TRUE(shown.set_frame(0, 1));
    EXPECT_EQ(film_of(shown, {0, 4}).sums, first.sums);
    // With a shutter, frame 1 is frame 0 of a shutter that opens one frame later.
    Scene blurred = Scene::build(room_with(mesh, {0, 0.5f}, in_object), 1).value();
    ASSERT_TRUE(blurred.set_frame(1, 1));
    EXPECT_EQ(film_of(blurred, {0, 4}).sums, film_of(room_with(mesh, {1, 1.5f}, in_object), {0, 4}).sums);
  }
}

// The tree that a scene cache keeps is that of the same description.
TEST(Deformation, TakesATreeBuiltBefore) {
  const SceneDescription scene = room_with(waving({-0.6f, 0.5f}, 1), {0, 1}, true);
  const Scene built = Scene::build(scene, 1).value();
  const Scene again = Scene::build(scene, 1, accel::Bvh::build(built.primitives(), 1)).value();
  EXPECT_EQ(film_of(built, {0, 4}).sums, film_of(again, {0, 4}).sums);
}

std::string why_refused(const SceneDescription& scene) {
  const Result<Scene> built = Scene::build(scene, 1);
  return built ? "" : built.error().message;
}

TEST(Deformation, OfWhatCannotBeRenderedIsRefused) {
  const FrameInterval shutter{0, 1};
  const char* const emits = "a mesh that deforms cannot emit light";
  EXPECT_THAT(why_refused(room_with(waving({0, 1}, 3), shutter)), HasSubstr(emits));
  SceneDescription lit = room_with(waving({0, 1}, 1), shutter, true);
  std::get<InstanceDescription>(lit.shapes.back()).material = 3;
  EXPECT_THAT(why_refused(lit), HasSubstr(emits));
  MeshDescription mesh = waving({0, 1}, 1);
  mesh.steps[1].positions.pop_back();
  EXPECT_THAT(why_refused(room_with(mesh, shutter)), HasSubstr("of equally many vertices"));
  mesh = waving({0, 1}, 1);
  mesh.steps[1].positions[2].x = std::nanf("");
  EXPECT_THAT(why_refused(room_with(mesh, shutter)),
              HasSubstr("frame 1, vertex 3: coordinates must be numbers"));
  mesh = waving({0, 1}, 1);
  mesh.steps[1].frame = 0;
  EXPECT_THAT(why_refused(room_with(mesh, shutter)), HasSubstr("in the order of their frames"));
  SceneDescription unsaid = room_with(waving({0, 1}, 1), shutter);
  unsaid.animation.deforms = false;
  EXPECT_THAT(why_refused(unsaid), HasSubstr("'deforms' must be true if and only if"));
}

}  // namespace
}  // namespace tessera::core::integrators
