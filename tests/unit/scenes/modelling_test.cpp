// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/sampling/hash.hpp"
#include "scenes/modelling/atlas.hpp"
#include "scenes/modelling/cloth.hpp"
#include "scenes/modelling/files.hpp"
#include "scenes/modelling/lathe.hpp"
#include "scenes/modelling/marching_cubes.hpp"
#include "scenes/modelling/noise.hpp"
#include "scenes/modelling/program.hpp"
#include "tests/unit/scenes/mesh_properties.hpp"

namespace tessera::modelling {
namespace {

Profile half_circle() {
  std::vector<Vec2> points;
  for (int i = 0; i <= 16; ++i) {
    const float angle = core::kPi * static_cast<float>(i) / 16;
    points.push_back({core::sin(angle), -core::cos(angle)});
  }
  points.front() = {0, -1};
  points.back() = {0, 1};
  return Profile(points);
}

TEST(GridMesh, SphereIsClosedAndHasTheVolumeOfABall) {
  const MeshDescription sphere = lathe_mesh(half_circle(), 96, 64);
  EXPECT_EQ(open_edge_count(sphere), 0);
  EXPECT_NEAR(enclosed_volume(sphere), 4.0 / 3 * core::kPi, 0.01);
  // Two triangles for each cell, but for one in those at the poles.
  EXPECT_EQ(sphere.triangles.size(), 2u * 96 * 64 - 2 * 96);
}

TEST(GridMesh, NormalsOfASphereAreItsRadii) {
  const MeshDescription sphere = lathe_mesh(half_circle(), 96, 64);
  for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
    EXPECT_NEAR(length(sphere.normals[i] - normalize(sphere.positions[i])), 0, 0.03) << "vertex " << i;
  }
}

TEST(Displace, KeepsAClosedSurfaceClosedAcrossItsSeam) {
  MeshDescription sphere = lathe_mesh(half_circle(), 48, 32);
  const double before = enclosed_volume(sphere);
  displace(sphere, [](Vec3 p, Vec2) { return 0.1f + 0.05f * noise(p * 5); });
  EXPECT_EQ(open_edge_count(sphere), 0);
  EXPECT_NEAR(enclosed_volume(sphere) / before, 1.331, 0.05);
}

TEST(TubeMesh, IsClosedAndTurnedOutward) {
  const MeshDescription tube = tube_mesh({{{0, 0, 0}, {0, 1, 0}, {0.5f, 2, 0}}, {0.1f, 0.1f, 0.1f}, 16, 24});
  EXPECT_EQ(open_edge_count(tube), 0);
  EXPECT_GT(enclosed_volume(tube), 0.9 * core::kPi * 0.01 * 2);
}

TEST(Append, KeepsBothParts) {
  MeshDescription mesh = lathe_mesh(half_circle(), 8, 8);
  MeshDescription other = mesh;
  for (Vec3& p : other.positions) p += Vec3{5, 0, 0};
  const double volume = enclosed_volume(mesh);
  append(mesh, other);
  EXPECT_EQ(open_edge_count(mesh), 0);
  EXPECT_NEAR(enclosed_volume(mesh), 2 * volume, 1e-3);
}

TEST(Spline, PassesThroughItsPointsAndIsStraightBetweenPointsOnALine) {
  const std::vector<float> values{1, 4, 2, 7};
  for (int i = 0; i < 4; ++i) {
    EXPECT_FLOAT_EQ(spline(values, static_cast<float>(i) / 3), values[static_cast<std::size_t>(i)]);
  }
  EXPECT_FLOAT_EQ(spline(std::vector<float>{0, 1, 2, 3}, 0.5f), 1.5f);
}

TEST(Profile, IsSampledEvenlyByLength) {
  const Profile profile = half_circle();
  EXPECT_NEAR(profile.length(), core::kPi, 0.01);
  EXPECT_EQ(profile.at(0), (Vec2{0, -1}));
  EXPECT_EQ(profile.at(1), (Vec2{0, 1}));
  EXPECT_NEAR(profile.fraction_of_point(4), 0.25, 0.01);
  for (int i = 0; i < 10; ++i) {
    const Vec2 step = profile.at(static_cast<float>(i + 1) / 10) - profile.at(static_cast<float>(i) / 10);
    EXPECT_NEAR(std::sqrt(step.x * step.x + step.y * step.y), 2 * core::sin(core::kPi / 20), 0.01);
  }
}

TEST(Noise, IsZeroOnTheLatticeBoundedAndSmooth) {
  EXPECT_EQ(noise({3, -7, 12}), 0);
  float largest = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = Vec3{random_at(i, 0, 0), random_at(i, 1, 0), random_at(i, 2, 0)} * 50 - Vec3{25, 25, 25};
    const float here = noise(p);
    largest = std::max(largest, std::fabs(here));
    EXPECT_NEAR(noise(p + Vec3{1e-3f, 0, 0}), here, 5e-3);
  }
  EXPECT_LE(largest, 1.1f);
  EXPECT_GT(largest, 0.6f);
}

TEST(RandomAt, IsEvenlyDistributed) {
  double sum = 0, sum_of_squares = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double x = random_at(i % 100, i / 100, -3);
    ASSERT_GE(x, 0);
    ASSERT_LT(x, 1);
    sum += x;
    sum_of_squares += x * x;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 0.005);
  EXPECT_NEAR(sum_of_squares / kCount, 1.0 / 3, 0.005);
}

TEST(CellularNoise, ChangesNoFasterThanPlacesDo) {
  float nearest = 10, farthest = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = Vec3{random_at(i, 0, 9), random_at(i, 1, 9), random_at(i, 2, 9)} * 20;
    const Cell here = cellular_noise(p), there = cellular_noise(p + Vec3{0.01f, 0, 0});
    EXPECT_NEAR(here.nearest, there.nearest, 0.0101f);
    nearest = std::min(nearest, here.nearest);
    farthest = std::max(farthest, here.nearest);
  }
  EXPECT_LT(nearest, 0.1f);
  EXPECT_GT(farthest, 0.8f);
  EXPECT_LT(farthest, 1.8f);
}

Cloth cloth_over_a_beam() {
  Cloth cloth;
  cloth.columns = cloth.rows = 24;
  cloth.spacing = 0.5f;
  cloth.refinement = 1;
  cloth.start = [](float u, float v) { return Vec3{12 * u - 6, 0.5f, 6 - 12 * v}; };
  cloth.push_out = [](Vec3 p) {
    const Vec3 axis{p.x, -3, 0};
    const float distance = length(p - axis);
    return distance < 3 ? axis + (p - axis) * (3 / distance) : p;
  };
  cloth.stiffness_bending = 0.005f;
  cloth.steps = 400;
  return cloth;
}

TEST(Drape, ClothLiesOnTheBeamAndHangsOnBothSides) {
  const MeshDescription mesh = drape(cloth_over_a_beam());
  for (std::size_t i = 0; i <= 24; ++i) {
    EXPECT_NEAR(mesh.positions[12 * 25 + i].y, 0, 0.1);
    EXPECT_LT(mesh.positions[i].y, -3.5f);
    EXPECT_LT(mesh.positions[24 * 25 + i].y, -3.5f);
  }
}

TEST(Drape, ThreadsKeepTheirLength) {
  const MeshDescription mesh = drape(cloth_over_a_beam());
  for (std::size_t j = 0; j < 25; ++j) {
    for (std::size_t i = 0; i < 24; ++i) {
      EXPECT_NEAR(length(mesh.positions[j * 25 + i + 1] - mesh.positions[j * 25 + i]), 0.5, 0.1);
    }
  }
}

TEST(Drape, RefinementPassesThroughTheSimulatedPoints) {
  Cloth cloth = cloth_over_a_beam();
  cloth.steps = 5;
  const MeshDescription coarse = drape(cloth);
  cloth.refinement = 2;
  const MeshDescription fine = drape(cloth);
  ASSERT_EQ(fine.positions.size(), 49u * 49);
  for (std::size_t j = 0; j < 25; ++j) {
    for (std::size_t i = 0; i < 25; ++i) {
      EXPECT_NEAR(length(fine.positions[2 * j * 49 + 2 * i] - coarse.positions[j * 25 + i]), 0, 1e-4);
    }
  }
}

TEST(ObjText, WritesPlacesBeforeTrianglesAndGroupsThemByMaterial) {
  MeshDescription mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1.5f, 0}};
  mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  mesh.triangle_materials = {1, 0};
  EXPECT_EQ(obj_text(mesh, {"a", "b"}, "c.mtl"),
            "mtllib c.mtl\n"
            "v 0.00000 0.00000 0.00000\nv 1.00000 0.00000 0.00000\nv 0.00000 1.50000 0.00000\n"
            "vt 0.00000 0.00000\nvt 1.00000 0.00000\nvt 0.00000 1.00000\n"
            "vn 0.0000 0.0000 1.0000\nvn 0.0000 0.0000 1.0000\nvn 0.0000 0.0000 1.0000\n"
            "usemtl a\nf 1/1/1 3/3/3 2/2/2\nusemtl b\nf 1/1/1 2/2/2 3/3/3\n");
}

TEST(Paint, VRunsUpwards) {
  const core::Image image = paint(2, 4, [](float u, float v) { return core::Rgb{u, v, 0}; });
  EXPECT_EQ(image.at(0, 0), (core::Rgb{0.25f, 0.875f, 0}));
  EXPECT_EQ(image.at(1, 3), (core::Rgb{0.75f, 0.125f, 0}));
}

TEST(Srgb, ReadsHexadecimalColours) {
  EXPECT_EQ(srgb(0xff0000), (core::Rgb{1, 0, 0}));
  EXPECT_EQ(srgb(0x0000ff), (core::Rgb{0, 0, 1}));
  EXPECT_NEAR(srgb(0xbcbcbc).g, 0.5029f, 1e-3);
}

std::uint64_t hash_of(const std::string& text) {
  std::uint64_t value = 0;
  for (const char c : text) value = core::sampling::hash(value, static_cast<unsigned char>(c));
  return value;
}

TEST(Modelling, IsTheSameBytesOnEveryMachine) {
  MeshDescription mesh = lathe_mesh(half_circle(), 32, 32);
  displace(mesh, [](Vec3 p, Vec2) {
    return 0.1f * fractal_noise(p * 2, 4) + 0.1f * cellular_noise(p * 3).nearest;
  });
  append(mesh, drape(cloth_over_a_beam()));
  const Field shape = carve(unite(ellipsoid({{0, 0, 0}, {1, 0.6f, 0.8f}}), ball({0.6f, 0.5f, 0}, 0.5f), 0.3f),
                            limb({-1, 0, 0}, 0.3f, {0, 0.6f, 0}, 0.1f), 0.1f);
  append(mesh, unwrap(marching_cubes(shape, {{-1.2f, -1, -1}, {1.4f, 1.2f, 1}, 0.1f}), 256));
  EXPECT_EQ(hash_of(obj_text(mesh)), 16877812922980363796u);
}

TEST(Program, TakesItsArgumentsButNoOptions) {
  struct Case {
    std::vector<std::string> arguments;
    int status, runs;
  };
  const Program program{"generate", "FOLDER [ORIGINALS]", "Writes.", 1, 2};
  for (const auto& [arguments, status, runs] : std::vector<Case>{{{"out"}, 0, 1},
                                                                 {{"out", "from"}, 0, 1},
                                                                 {{"broken"}, 1, 1},
                                                                 {{"--help"}, 0, 0},
                                                                 {{"-h"}, 0, 0},
                                                                 {{"--output"}, 2, 0},
                                                                 {{}, 2, 0},
                                                                 {{"a", "b", "c"}, 2, 0}}) {
    std::vector<std::string> words{"generate"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    int ran = 0;
    const auto generate = [&](std::span<const std::string> given) -> core::Status {
      ++ran;
      if (given[0] == "broken") return core::fail(core::ErrorCode::kInvalidArgument, "broken");
      return {};
    };
    EXPECT_EQ(run_program(program, static_cast<int>(argv.size()), argv.data(), generate), status)
        << testing::PrintToString(arguments);
    EXPECT_EQ(ran, runs) << testing::PrintToString(arguments);
  }
}

}  // namespace
}  // namespace tessera::modelling
