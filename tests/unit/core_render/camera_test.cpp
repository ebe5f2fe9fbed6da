// SPDX-License-Identifier: Apache-2.0
#include "core/camera/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/ray_lanes.hpp"
#include "core/lights/equirectangular.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/sampler.hpp"
#include "tests/support/near.hpp"

namespace tessera::core::integrators {
namespace {

constexpr CameraDescription kAhead{.position = {1, 2, 3}, .look_at = {1, 2, -7}, .vertical_fov_degrees = 90};

TEST(Camera, SeesRightToTheRightAndUpAbove) {
  const Camera camera(kAhead);
  expect_near(camera.ray({100, 50}, 200, 100, {}).direction, {0, 0, -1}, 1e-5f);
  expect_near(camera.ray({100, 0}, 200, 100, {}).direction, normalize({0, 1, -1}), 1e-5f);
  expect_near(camera.ray({200, 50}, 200, 100, {}).direction, normalize({2, 0, -1}), 1e-5f);
  expect_near(camera.ray({0, 100}, 200, 100, {}).direction, normalize({-2, -1, -1}), 1e-5f);
}

std::vector<CameraDescription> lenses() {
  CameraDescription disk = kAhead;
  disk.aperture_radius = 0.5f;
  disk.focus_distance = 4;
  disk.lens_shift = {0.2f, -0.1f};
  CameraDescription blades = disk, parallel = disk;
  blades.aperture_blades = 5;
  blades.aperture_rotation_degrees = 30;
  blades.mirrored = true;
  parallel.type = CameraType::kOrthographic;
  parallel.view_height = 3;
  return {disk, blades, parallel};
}

TEST(Camera, RaysInLanesAreThoseOfScalars) {
  std::vector<CameraDescription> descriptions = lenses();
  descriptions.push_back(kAhead);
  descriptions.push_back(kAhead);
  descriptions.back().type = CameraType::kPanoramic;
  for (const CameraDescription& description : descriptions) {
    const Camera camera(description);
    for (int i = 0; i < 1000; ++i) {
      FloatLanes x, y, u, v;
      for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
        const auto random = sampling::Sampler(4, i, static_cast<int>(lane), 0).pad(0);
        x.set(lane, 200 * random[0]), y.set(lane, 100 * random[1]);
        u.set(lane, random[2]), v.set(lane, random[3]);
      }
      const RayLanes rays(
          camera.ray(Vec2Of<FloatN>{x.all(), y.all()}, 200, 100, Vec2Of<FloatN>{u.all(), v.all()}));
      for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
        const Ray alone = camera.ray({x[lane], y[lane]}, 200, 100, {u[lane], v[lane]});
        ASSERT_EQ(rays[lane].origin, alone.origin);
        ASSERT_EQ(rays[lane].direction, alone.direction);
        ASSERT_EQ(rays[lane].t_max, alone.t_max);
        ASSERT_EQ(rays[lane].time, alone.time);
      }
    }
  }
}

TEST(Camera, KnowsWhereOnTheLensARayComesFrom) {
  for (const CameraDescription& description : lenses()) {
    const Camera camera(description);
    ASSERT_TRUE(camera.has_lens());
    for (int i = 0; i < 1000; ++i) {
      const auto u = sampling::Sampler(3, i, 0, 0).pad(0);
      const Vec2 raster{200 * u[0], 100 * u[1]};
      // Not at the edge, which rounding may put on either side.
      const Ray ray = camera.ray(raster, 200, 100, {0.02f + 0.96f * u[2], 0.02f + 0.96f * u[3]});
      const Vec3 focus = camera.focus(raster, 200, 100);
      const auto origin = camera.lens_point(focus, ray.direction);
      ASSERT_TRUE(origin);
      expect_near(*origin, ray.origin, 5e-6f);
      const DoubleCone cone = camera.lens_cone(focus);
      EXPECT_EQ(cone.apex, focus);
      EXPECT_GE(dot(ray.direction, cone.axis), cone.cosine - 1e-6f);
      EXPECT_FALSE(camera.lens_point(focus, -ray.direction));
    }
  }
}

// The solid angle of the lens at the focus, once as the mean of 1 / density over rays, and once by directions
// that come from the lens.
TEST(Camera, KnowsTheDensityOfItsRays) {
  for (const CameraDescription& description : lenses()) {
    const Camera camera(description);
    constexpr int kSamples = 100'000;
    constexpr Vec2 kRaster{170, 15};
    const Vec3 focus = camera.focus(kRaster, 200, 100);
    const DoubleCone cone = camera.lens_cone(focus);
    const Frame frame = Frame::around(cone.axis);
    double by_rays = 0;
    int from_lens = 0;
    for (int i = 0; i < kSamples; ++i) {
      const auto u = sampling::Sampler(4, i % 500, i / 500, 0).pad(0);
      by_rays +=
          1 / static_cast<double>(camera.lens_pdf(camera.ray(kRaster, 200, 100, {u[0], u[1]}).direction));
      const float z = 1 - u[2] * (1 - cone.cosine), r = std::sqrt(1 - z * z), turns = 2 * kPi * u[3];
      const Vec3 direction = frame.to_world({r * std::cos(turns), r * std::sin(turns), z});
      from_lens += camera.lens_point(focus, direction) ? 1 : 0;
    }
    const double of_cone = static_cast<double>(2 * kPi * (1 - cone.cosine));
    EXPECT_NEAR(by_rays / kSamples, of_cone * from_lens / kSamples, 0.01 * by_rays / kSamples);
  }
}

TEST(Camera, KnowsTheShareOfTheLensThatSomethingFills) {
  const Camera camera(lenses()[0]);  // in focus at z = -1
  const float lens = kPi / 4;
  EXPECT_FLOAT_EQ(camera.share_of_lens(0.01f, {9, 2, -3}, 0), 0.01f * 4 / lens);
  EXPECT_FLOAT_EQ(camera.share_of_lens(0.01f, {9, 2, 1}, 0), 0.01f * 4 / lens) << "before the focus";
  EXPECT_FLOAT_EQ(camera.share_of_lens(0.01f, {9, 2, -3}, 1), 0.01f * 16 / lens);
  EXPECT_EQ(camera.share_of_lens(0.01f, {9, 2, -3}, 2), std::numeric_limits<float>::infinity());
  EXPECT_EQ(camera.share_of_lens(0.01f, {9, 2, 4}, 0.5f), 0) << "behind the lens";
  EXPECT_EQ(camera.share_of_lens(0.01f, {9, 2, 3.1f}, 0.5f), 0) << "around the lens";
  EXPECT_EQ(camera.share_of_lens(0.01f, {9, 2, 2.9f}, 0.5f), 0) << "around the lens";
}

TEST(Camera, HasALensIfItBlurs) {
  EXPECT_FALSE(Camera(kAhead).has_lens());
  CameraDescription all_around = lenses()[0];
  all_around.type = CameraType::kPanoramic;
  EXPECT_FALSE(Camera(all_around).has_lens());
}

TEST(Camera, PinholeRaysStartAtItsPosition) {
  EXPECT_EQ(Camera(kAhead).ray({3, 4}, 20, 10, {0.9f, 0.1f}).origin, kAhead.position);
}

TEST(Camera, EveryLensPointSeesTheSamePointInFocus) {
  CameraDescription description = kAhead;
  description.aperture_radius = 0.5f;
  description.focus_distance = 4;
  const Camera camera(description);
  const Ray sharp = Camera(kAhead).ray({150, 20}, 200, 100, {});
  const Vec3 in_focus = sharp.origin + sharp.direction * (4 / -sharp.direction.z);
  for (const Vec2 lens : {Vec2{0.1f, 0.9f}, {0.5f, 0.2f}, {0.99f, 0.99f}}) {
    const Ray ray = camera.ray({150, 20}, 200, 100, lens);
    expect_near(ray.origin + ray.direction * (4 / -ray.direction.z), in_focus, 1e-5f);
  }
}

// At distance d a lens of radius r focused at f spreads a point over a disk of radius r |d - f| / f.
TEST(Camera, CircleOfConfusionHasItsRadius) {
  CameraDescription description = kAhead;
  description.aperture_radius = 0.5f;
  description.focus_distance = 4;
  const Camera camera(description);
  for (const float d : {1.0f, 3.0f, 6.0f, 20.0f}) {
    float radius = 0;
    for (int i = 0; i < 1000; ++i) {
      const Ray ray = camera.ray({100, 50}, 200, 100,
                                 {static_cast<float>(i % 32) / 31.001f, static_cast<float>(i) / 1000});
      const Vec3 p = ray.origin + ray.direction * (d / -ray.direction.z);
      radius = std::max(radius, std::hypot(p.x - 1, p.y - 2));
    }
    EXPECT_NEAR(radius, 0.5f * std::fabs(d - 4) / 4, 0.01f) << d;
  }
}

TEST(Camera, CanFocusAtInfinity) {
  CameraDescription description = kAhead;
  description.aperture_radius = 0.5f;
  description.focus_distance = 1e30f;
  const Ray ray = Camera(description).ray({150, 20}, 200, 100, {0.9f, 0.4f});
  expect_near(ray.direction, Camera(kAhead).ray({150, 20}, 200, 100, {}).direction, 1e-5f);
  EXPECT_NE(ray.origin, description.position);
}

TEST(Camera, ShiftMovesTheImageToTheRightAndUp) {
  CameraDescription description = kAhead;
  description.lens_shift = {0.5f, -0.25f};
  const Camera shifted(description), camera(kAhead);
  expect_near(shifted.ray({0, 25}, 200, 100, {}).direction, {0, 0, -1}, 1e-5f);
  expect_near(shifted.ray({30, 40}, 200, 100, {}).direction, camera.ray({130, 65}, 200, 100, {}).direction,
              1e-5f);
}

TEST(Camera, MirrorsItsImage) {
  CameraDescription description = kAhead;
  for (const CameraType type : {CameraType::kPerspective, CameraType::kPanoramic}) {
    description.type = type;
    description.mirrored = false;
    const Vec3 plain = Camera(description).ray({170, 30}, 200, 100, {}).direction;
    description.mirrored = true;
    expect_near(Camera(description).ray({30, 30}, 200, 100, {}).direction, plain, 1e-5f);
  }
}

TEST(Camera, OrthographicRaysAreParallel) {
  CameraDescription description = kAhead;
  description.type = CameraType::kOrthographic;
  description.view_height = 4;
  const Camera camera(description);
  const Ray corner = camera.ray({200, 0}, 200, 100, {});
  expect_near(corner.direction, {0, 0, -1}, 1e-6f);
  expect_near(corner.origin, {1 + 4, 2 + 2, 3}, 1e-5f);
  expect_near(camera.ray({100, 50}, 200, 100, {}).origin, kAhead.position, 1e-5f);
  description.aperture_radius = 0.5f;
  description.focus_distance = 4;
  for (const Vec2 lens : {Vec2{0.1f, 0.9f}, {0.5f, 0.2f}}) {
    const Ray ray = Camera(description).ray({200, 0}, 200, 100, lens);
    EXPECT_NE(ray.origin, corner.origin);
    expect_near(ray.origin + ray.direction * (4 / -ray.direction.z), {5, 4, -1}, 1e-5f);
  }
}

TEST(Camera, PanoramicRaysGoInAllDirections) {
  CameraDescription description = kAhead;
  description.type = CameraType::kPanoramic;
  const Camera camera(description);
  const auto toward = [&](float x, float y) { return camera.ray({x, y}, 360, 180, {}).direction; };
  expect_near(toward(180, 90), {0, 0, -1}, 1e-5f);
  expect_near(toward(270, 90), {1, 0, 0}, 1e-5f);
  expect_near(toward(0, 90), {0, 0, 1}, 1e-5f);
  expect_near(toward(123, 0), {0, 1, 0}, 1e-5f);
  expect_near(toward(123, 180), {0, -1, 0}, 1e-5f);
  const float s = std::sqrt(0.5f);
  expect_near(toward(270, 45), {s, s, 0}, 1e-5f);
  EXPECT_EQ(camera.ray({5, 5}, 360, 180, {}).origin, kAhead.position);
}

// The image of a panoramic camera is the environment that it saw.
TEST(Camera, PanoramicAgreesWithEnvironments) {
  CameraDescription description{.position = {}, .look_at = {0, 0, -1}};
  description.type = CameraType::kPanoramic;
  const Camera camera(description);
  for (const Vec2 at : {Vec2{0.1f, 0.3f}, {0.6f, 0.8f}, {0.9f, 0.55f}}) {
    const Vec2 uv =
        lights::EquirectangularMap(0).uv_of(camera.ray({at.x * 64, at.y * 32}, 64, 32, {}).direction);
    EXPECT_NEAR(uv.x, at.x, 1e-5f);
    EXPECT_NEAR(uv.y, 1 - at.y, 1e-5f);
  }
}

TEST(Camera, FocusesAtWhatItLooksAtByDefault) {
  CameraDescription description = kAhead;
  description.aperture_radius = 0.5f;
  const Ray ray = Camera(description).ray({100, 50}, 200, 100, {0.9f, 0.4f});
  expect_near(ray.origin + ray.direction * (10 / -ray.direction.z), description.look_at, 1e-5f);
}

}  // namespace
}  // namespace tessera::core::integrators
