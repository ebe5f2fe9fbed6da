// SPDX-License-Identifier: Apache-2.0
// Meshes that deform while the shutter is open: a ray finds, to the bit, what it finds in a mesh that has the
// shape of its time.
#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/surface_points.hpp"
#include "tests/unit/core_geometry/batches.hpp"

namespace tessera::core {
namespace {

constexpr FrameInterval kExposure{1.25f, 3.5f};

// A mesh with everything that belongs to it, whose vertices wander.
struct Wandering {
  test::Mesh mesh;
  std::vector<Vec2> uvs;
  std::vector<MeshStep> steps;

  // At the end of `primitives`.
  void add_to(Primitives& primitives) const {
    const std::uint32_t first = primitives.triangle_count();
    primitives.add_mesh(steps[0].positions, steps[0].normals, uvs, mesh.triangles, {0});
    primitives.deform_last_mesh(steps, first);
  }
  // In its shape at a frame.
  void add_still_to(Primitives& primitives, float frame) const {
    const VertexMotion motion(steps);
    std::vector<Vec3> positions, normals;
    for (std::size_t v = 0; v < motion.vertex_count(); ++v) {
      positions.push_back(motion.position(v, motion.at(frame)));
      if (motion.has_normals()) normals.push_back(motion.normal(v, motion.at(frame)));
    }
    primitives.add_mesh(positions, normals, uvs, mesh.triangles, {0});
  }
};

Wandering wandering(test::Random& random, std::vector<float> frames, float by, bool with_normals) {
  const Vec3 center = random.in_box(0.5f);
  Wandering w{test::icosphere(2, center, 0.6f), {}, {}};
  for (const Vec3 p : w.mesh.positions) w.uvs.push_back({p.x, p.y});
  for (const float frame : frames) {
    MeshStep step{frame, w.mesh.positions, {}};
    const Vec3 shift = random.in_box(by);
    for (Vec3& p : step.positions) p += shift + random.in_box(by / 8);
    for (std::size_t i = 0; with_normals && i < step.positions.size(); ++i)
      step.normals.push_back(w.mesh.positions[i] - center + random.in_box(0.1f));
    w.steps.push_back(std::move(step));
  }
  return w;
}

// Two meshes that deform behind one that does not, an object with such a mesh among spheres, and instances of
// it, some of which move.
struct DeformingScene {
  std::vector<Wandering> own;
  Wandering in_object;
  std::vector<Transform> placements;
  std::vector<MotionStep> motion;

  explicit DeformingScene(test::Random& random)
      : own{wandering(random, {1, 2.5f, 3, 4}, 1, false), wandering(random, {2, 3}, 0.5f, false)},
        in_object(wandering(random, {0, 1.5f, 5}, 0.5f, false)),
        motion{TranslationMotion{{{1, 3}, {{0, 0, 0}, {1, 0.5f, 0}}}}} {
    for (int i = 0; i < 3; ++i) placements.push_back(test::random_transform(random, 1.5f));
  }

  Primitives deforming() const {
    return with([](const Wandering& mesh, Primitives& all) { mesh.add_to(all); },
                [&](Primitives& all) {
                  all.deform(0, kExposure);
                  all.move_instance(3, {motion, kExposure});
                });
  }
  Primitives still_at(float frame) const {
    return with([frame](const Wandering& mesh, Primitives& all) { mesh.add_still_to(all, frame); },
                [&](Primitives& all) { all.place_instance(3, Placement(transform_at(motion, frame))); });
  }

 private:
  template <typename Add, typename Finish>
  Primitives with(const Add& add, const Finish& finish) const {
    Primitives all = test::icosphere(1, {0.5f, 0, 0}, 0.4f).primitives();
    for (const Wandering& mesh : own) add(mesh, all);
    all.add_sphere({0, 1, 0}, 0.3f, 0);
    Primitives object = test::icosphere(0, {}, 0.2f).primitives();
    add(in_object, object);
    object.add_sphere({0.8f, 0, 0}, 0.3f, 0);
    all.add_object(std::move(object));
    for (const Transform& placement : placements) all.add_instance({Placement(placement), 0});
    all.add_instance({Placement(Transform()), 0});
    finish(all);
    return all;
  }
};

void expect_same_surface(const Primitives& moving, const Primitives& still, const Ray& ray, const Hit& hit,
                         const Hit& still_hit) {
  const SurfacePoint point = moving.surface(ray, hit), same = still.surface(ray, still_hit);
  EXPECT_EQ(point.position, same.position);
  EXPECT_EQ(point.geometric_normal, same.geometric_normal);
  EXPECT_EQ(point.shading_normal, same.shading_normal);
  EXPECT_EQ(point.uv, same.uv);
  EXPECT_EQ(moving.tangents(hit, point).along_u, still.tangents(still_hit, same).along_u);
  EXPECT_EQ(moving.uv_derivatives(hit, point).dp_dv, still.uv_derivatives(still_hit, same).dp_dv);
}

TEST(DeformingMeshes, AreHitInTheShapeOfTheTimeOfTheRay) {
  test::Random random(61);
  const DeformingScene scene(random);
  const Primitives moving = scene.deforming();
  const accel::Bvh bvh = accel::Bvh::build(moving, 1);
  int hits = 0;
  for (int i = 0; i < 24; ++i) {
    const float time = i == 0 ? 0 : i == 1 ? 1 : random.uniform(0, 1);
    const Primitives still = scene.still_at(kExposure.at(time));
    for (Ray ray : test::random_rays({"", still, 2}, random, 200)) {
      ray.time = time;
      const Hit expected = test::brute_force_hit(still, ray), found = bvh.closest_hit(moving, ray);
      ASSERT_TRUE(test::identical(found, expected)) << time << ' ' << test::describe(ray, expected);
      ASSERT_TRUE(test::identical(test::brute_force_hit(moving, ray), expected));
      EXPECT_EQ(bvh.any_hit(moving, ray), expected.found());
      if (!found.found()) continue;
      EXPECT_EQ(found.time, time);
      hits += moving.owner(found).is_moving_triangle(found.primitive);
      expect_same_surface(moving, still, ray, found, expected);
    }
  }
  EXPECT_GT(hits, 500);
}

TEST(DeformingMeshes, AreHitByGroupsAsByEachRayAlone) {
  test::Random random(62);
  for (int i = 0; i < 4; ++i) {
    const test::Soup soup{"deforming", DeformingScene(random).deforming(), 2};
    const accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
    for (const std::size_t count : {9u, 64u, 300u})
      for (test::Rays rays :
           {test::camera_rays(soup, random, count, 1e-3f), test::camera_rays(soup, random, count, 0.1f),
            test::random_rays(soup, random, count)}) {
        for (Ray& ray : rays) ray.time = random.uniform(0, 1);
        ASSERT_NO_FATAL_FAILURE(test::expect_same_answers(bvh, soup.primitives, rays));
      }
  }
}

// Lanes of all kinds together.
TEST(DeformingMeshes, HaveTheSameSurfacesInLanes) {
  test::Random random(63);
  const Primitives moving = DeformingScene(random).deforming();
  const accel::Bvh bvh = accel::Bvh::build(moving, 1);
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  while (rays.size() < 800) {
    for (Ray ray : test::random_rays({"", moving, 2}, random, 64)) {
      ray.time = random.uniform(0, 1);
      const Hit hit = bvh.closest_hit(moving, ray);
      if (!hit.found()) continue;
      rays.push_back(ray);
      hits.push_back(hit);
    }
  }
  const Columns<Ray> all_rays{std::span<const Ray>(rays)};
  const Columns<Hit> all_hits{std::span<const Hit>(hits)};
  for (std::size_t first = 0; first + kLaneCount <= rays.size(); first += kLaneCount) {
    const WordLanes rows = test::rows_from(first);
    const SurfacePoints all(moving.surfaces({all_rays.all(), rows}, {all_hits.all(), rows}));
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const SurfacePoint one = moving.surface(rays[first + lane], hits[first + lane]);
      EXPECT_EQ(all[lane].position, one.position);
      EXPECT_EQ(all[lane].position_error, one.position_error);
      EXPECT_EQ(all[lane].shading_normal, one.shading_normal);
      EXPECT_EQ(all[lane].uv, one.uv);
    }
  }
}

TEST(DeformingMeshes, InterpolateTheirNormals) {
  test::Random random(64);
  const Wandering mesh = wandering(random, {0, 1}, 0.5f, true);
  Primitives moving, still;
  mesh.add_to(moving);
  moving.deform(0, {0, 1});
  mesh.add_still_to(still, 0.5f);
  int hits = 0;
  for (Ray ray : test::random_rays({"", still, 1}, random, 400)) {
    ray.time = 0.5f;
    const Hit hit = test::brute_force_hit(moving, ray);
    if (!hit.found()) continue;
    ++hits;
    const SurfacePoint a = moving.surface(ray, hit), b = still.surface(ray, hit);
    EXPECT_GT(dot(a.shading_normal, b.shading_normal), 0.99f);  // unit vectors and their shorter means
    EXPECT_NE(a.shading_normal, a.geometric_normal);
  }
  EXPECT_GT(hits, 50);
}

// Between equal steps, all is as if nothing moved.
TEST(DeformingMeshes, WithEqualStepsAreHitAsStillOnes) {
  test::Random random(65);
  Wandering mesh = wandering(random, {1, 2, 4}, 0.5f, true);
  for (MeshStep& step : mesh.steps) {
    step.positions = mesh.steps[0].positions;
    step.normals = mesh.steps[0].normals;
  }
  Primitives moving, still;
  mesh.add_to(moving);
  moving.deform(0, kExposure);
  EXPECT_TRUE(moving.has_motion());
  still.add_mesh(mesh.steps[0].positions, mesh.steps[0].normals, mesh.uvs, mesh.mesh.triangles, {0});
  const accel::Bvh of_moving = accel::Bvh::build(moving, 1), of_still = accel::Bvh::build(still, 1);
  for (Ray ray : test::random_rays({"", still, 1}, random, 2000)) {
    ray.time = random.uniform(0, 1);
    const Hit a = of_moving.closest_hit(moving, ray), b = of_still.closest_hit(still, ray);
    ASSERT_TRUE(test::identical(a, b)) << test::describe(ray, b);
    if (a.found()) expect_same_surface(moving, still, ray, a, b);
  }
}

// The tree of an object is built again, others stay.
TEST(DeformingMeshes, AreShownAtAFrameAsStillOnes) {
  test::Random random(66);
  const DeformingScene scene(random);
  Primitives shown = scene.deforming();
  accel::Bvh bvh = accel::Bvh::build(shown, 1);
  for (const float frame : {0.0f, 2.75f, 9.0f}) {
    shown.stop_instances();
    shown.place_instance(3, Placement(transform_at(scene.motion, frame)));
    shown.deform(frame, {frame, frame});
    bvh.rebuild(shown, 1);
    EXPECT_FALSE(shown.has_motion());
    const Primitives still = scene.still_at(frame);
    EXPECT_EQ(bvh, accel::Bvh::build(still, 1)) << frame;
    EXPECT_FALSE(shown.is_moving_triangle(100));
  }
}

TEST(DeformingMeshes, OutsideOfTheirStepsDoNotMove) {
  const VertexMotion motion({{1, {{0, 0, 0}}, {}}, {2, {{1, 0, 0}}, {}}});
  EXPECT_FALSE(motion.moves({0, 1}));
  EXPECT_FALSE(motion.moves({2, 5}));
  EXPECT_FALSE(motion.moves({1.5f, 1.5f}));
  EXPECT_TRUE(motion.moves({0, 1.1f}));
  EXPECT_EQ(motion.position(0, motion.at(-7)), (Vec3{0, 0, 0}));
  EXPECT_EQ(motion.position(0, motion.at(1)), (Vec3{0, 0, 0}));
  EXPECT_EQ(motion.position(0, motion.at(1.25f)), (Vec3{0.25f, 0, 0}));
  EXPECT_EQ(motion.position(0, motion.at(2)), (Vec3{1, 0, 0}));
  EXPECT_EQ(motion.position(0, motion.at(7)), (Vec3{1, 0, 0}));
}

// Bounds are of the interval alone, and of all steps in it.
TEST(DeformingMeshes, HaveBoundsOfWhereTheyAreMeanwhile) {
  const VertexMotion motion({{0, {{0, 0, 0}}, {}}, {1, {{8, 0, 0}}, {}}, {2, {{0, 6, 0}}, {}}});
  const Aabb part = motion.bounds({0, 0, 0}, {0.25f, 0.5f});
  EXPECT_NEAR(part.lower.x, 2, 1e-5f);
  EXPECT_NEAR(part.upper.x, 4, 1e-5f);
  const Aabb bent = motion.bounds({0, 0, 0}, {0.5f, 1.5f});
  EXPECT_NEAR(bent.lower.x, 4, 1e-5f);
  EXPECT_NEAR(bent.upper.x, 8, 1e-5f);
  EXPECT_NEAR(bent.upper.y, 3, 1e-5f);
}

// Large coordinates that cancel: points between are far less exact than a float of their size.
TEST(DeformingMeshes, HaveBoundsThatHoldWhereCoordinatesCancel) {
  test::Random random(67);
  for (int i = 0; i < 2000; ++i) {
    const float far = random.uniform(1e6f, 1e14f);
    const VertexMotion motion({{0, {{far, -far, far}}, {}}, {1, {{-far, far * 0.99f, far}}, {}}});
    const FrameInterval interval{0.5f - random.uniform(0, 1e-6f), 0.5f + random.uniform(1e-7f, 1e-6f)};
    const Aabb box = motion.bounds({0, 0, 0}, interval);
    for (const float time : {0.0f, 0.3f, 0.7f, 1.0f}) {
      const Vec3 p = motion.position(0, motion.at(interval.at(time)));
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_TRUE(p[axis] >= box.lower[axis] && p[axis] <= box.upper[axis]);
    }
  }
}

TEST(DeformingMeshes, NeedSoundSteps) {
  const std::vector<Vec3> one{{0, 0, 0}}, two{{0, 0, 0}, {1, 0, 0}};
  EXPECT_TRUE(are_sound({{0, one, one}, {1, one, one}}, 1, {.normals = true}));
  EXPECT_FALSE(are_sound({{0, one, {}}}, 1, {})) << "one step";
  EXPECT_FALSE(are_sound({{0, one, {}}, {0, one, {}}}, 1, {})) << "equal frames";
  EXPECT_FALSE(are_sound({{0, one, {}}, {std::nanf(""), one, {}}}, 1, {}));
  EXPECT_FALSE(are_sound({{0, one, {}}, {1, two, {}}}, 1, {})) << "another count";
  EXPECT_FALSE(are_sound({{0, one, one}, {1, one, {}}}, 1, {.normals = true})) << "without normals";
  EXPECT_FALSE(are_sound({{0, one, one}, {1, one, one}}, 1, {})) << "with normals";
  EXPECT_FALSE(are_sound({{0, one, {}, {{}}}, {1, one, {}, {}}}, 1, {.tangents = true}))
      << "without tangents";
}

}  // namespace
}  // namespace tessera::core
