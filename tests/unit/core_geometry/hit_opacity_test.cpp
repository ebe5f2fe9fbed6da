// SPDX-License-Identifier: Apache-2.0
// Surfaces that rays pass where they are transparent: rays together find, bit for bit, what each finds alone,
// and both what asking every primitive finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "core/geometry/object_ray.hpp"
#include "tests/unit/core_geometry/batches.hpp"

namespace tessera::core {
namespace {

// By a hash of all that a hit is, but of shapes that a ray can meet twice, which are asked once, the same all
// over. The opacities of materials are those that hits of them may have.
class HashedOpacity final : public accel::HitOpacity {
 public:
  HashedOpacity(const Primitives& primitives, std::vector<accel::MaterialOpacity> of_materials)
      : primitives_(primitives), of_materials_(std::move(of_materials)) {}

  accel::Opacity at(const Hit& hit) const override {
    switch (of_materials_[primitives_.material(hit)]) {
      case accel::MaterialOpacity::kOpaque:
        return accel::Opacity::kOpaque;
      case accel::MaterialOpacity::kPartial:
        return accel::Opacity::kPartial;
      case accel::MaterialOpacity::kCutOut:
        break;
    }
    const bool is_triangle = primitives_.owner(hit).is_triangle(hit.primitive);
    std::uint32_t hash = hit.primitive * 0x9e3779b9u ^ hit.instance * 0x85ebca6bu;
    for (const float value : {hit.b1, hit.b2, hit.time})
      if (is_triangle) hash = (hash ^ std::bit_cast<std::uint32_t>(value)) * 0xc2b2ae35u;
    hash ^= hash >> 15;
    return static_cast<accel::Opacity>(hash % 3);
  }
  const std::vector<accel::MaterialOpacity>& of_materials() const { return of_materials_; }

 private:
  const Primitives& primitives_;
  std::vector<accel::MaterialOpacity> of_materials_;
};

// Calls what(hit) for the hit of each primitive, also those of instances, on the ray.
template <typename What>
void for_each_hit(const Primitives& primitives, const Ray& ray, const What& what) {
  const auto pass = [&](Hit hit, std::uint32_t instance) {
    hit.instance = instance;
    hit.time = primitives.has_motion() ? ray.time : 0;
    Hit on_ray;
    if (hit.found() && on_ray.improve(ray, hit)) what(hit);
  };
  for (std::uint32_t p = 0; p < primitives.count(); ++p) {
    Hit hit;
    if (!primitives.is_instance(p)) {
      primitives.intersect(p, ray, hit);
      pass(hit, kNoInstance);
      continue;
    }
    const std::uint32_t number = primitives.instance_number(p);
    const Instance& instance = primitives.instance(number);
    const ObjectRay object_ray = primitives.to_object(instance, ray);
    for (std::uint32_t shape = 0; shape < primitives.object_of(instance).count(); ++shape) {
      hit = {};
      primitives.object_of(instance).intersect(shape, object_ray, hit);
      pass(hit, number);
    }
  }
}

struct Answers {
  Hit closest;
  accel::Occlusion occlusion = accel::Occlusion::kNone;
};
Answers brute_force(const Primitives& primitives, const Ray& ray, const accel::HitOpacity& opacity) {
  Answers answers;
  for_each_hit(primitives, ray, [&](const Hit& hit) {
    const accel::Opacity there = opacity.at(hit);
    if (there == accel::Opacity::kTransparent) return;
    answers.closest.improve(ray, hit);
    if (there == accel::Opacity::kOpaque) answers.occlusion = accel::Occlusion::kFull;
    if (answers.occlusion == accel::Occlusion::kNone) answers.occlusion = accel::Occlusion::kPartial;
  });
  return answers;
}

struct Counts {
  int passed = 0, partial = 0, full = 0;
};

void expect_brute_force_answers(const accel::Bvh& bvh, const Primitives& primitives, const test::Rays& rays,
                                const accel::HitOpacity& opacity, Counts& counts) {
  ASSERT_NO_FATAL_FAILURE(test::expect_same_answers(bvh, primitives, rays, &opacity));
  for (const Ray& ray : rays) {
    const Answers expected = brute_force(primitives, ray, opacity);
    const Hit found = bvh.closest_hit(primitives, ray, &opacity);
    ASSERT_TRUE(test::identical(found, expected.closest))
        << "expected " << test::describe(ray, expected.closest) << "\n     got "
        << test::describe(ray, found);
    ASSERT_EQ(bvh.occlusion(primitives, ray, &opacity), expected.occlusion);
    counts.passed += !test::identical(found, bvh.closest_hit(primitives, ray));
    counts.partial += expected.occlusion == accel::Occlusion::kPartial;
    counts.full += expected.occlusion == accel::Occlusion::kFull;
  }
}

void expect_all_answers(const test::Soup& soup, const HashedOpacity& opacity, test::Random& random,
                        Counts& counts) {
  SCOPED_TRACE(soup.name);
  accel::Bvh bvh = accel::Bvh::build(soup.primitives, 1);
  bvh.set_opacities(soup.primitives, opacity.of_materials(), 2);
  for (const std::size_t count : {1u, 9u, 64u, 130u})
    for (test::Rays rays :
         {test::camera_rays(soup, random, count, 0.0f), test::camera_rays(soup, random, count, 0.01f),
          test::camera_rays(soup, random, count, 0.3f), test::lamp_rays(soup, random, count, true),
          test::lamp_rays(soup, random, count, false), test::random_rays(soup, random, count),
          test::parallel_rays(random, count)}) {
      for (Ray& ray : rays) ray.time = random.uniform(0, 1);
      expect_brute_force_answers(bvh, soup.primitives, rays, opacity, counts);
      if (testing::Test::HasFatalFailure()) return;
    }
}

TEST(HitOpacity, IsAskedWhateverIsHit) {
  test::Random random(71);
  for (const std::uint32_t count : {1u, 33u, 300u})
    for (const test::Soup& soup : test::all_soups(count)) {
      Counts counts;
      const bool has_space = count > 1 && soup.name != "identical";  // between some
      const std::vector<accel::MaterialOpacity> all(8, accel::MaterialOpacity::kCutOut);
      expect_all_answers(soup, HashedOpacity(soup.primitives, all), random, counts);
      if (HasFatalFailure()) return;
      if (!has_space) continue;
      EXPECT_GT(counts.passed, 10) << soup.name;
      EXPECT_GT(counts.full, 10) << soup.name;
      EXPECT_GT(counts.partial, 10) << soup.name;
    }
}

// Overlapping sheets of one material each, and spheres.
Primitives sheets(test::Random& random, int count, std::uint32_t materials) {
  Primitives made;
  for (int i = 0; i < count; ++i) {
    test::Mesh mesh;
    const Vec3 corner = random.in_box(1);
    const Vec3 u = 0.3f * random.direction(), v = 0.3f * random.direction();
    for (float x : {0.0f, 1.0f, 2.0f, 3.0f}) {
      mesh.add({corner + x * u, corner + (x + 1) * u, corner + v});
      mesh.add({corner + x * u, corner + (x + 1) * u, corner - v});
    }
    made.add_mesh(mesh.positions, {}, {}, mesh.triangles, {random.below(materials)});
  }
  for (int i = 0; i < count / 4; ++i) made.add_sphere(random.in_box(1), 0.2f, random.below(materials));
  return made;
}

// Materials of all kinds beside each other in leaves and in objects, also such that instances put on objects
// that are opaque; some move.
TEST(HitOpacity, IsAskedWhereMaterialsNeedIt) {
  constexpr accel::MaterialOpacity kOpaque = accel::MaterialOpacity::kOpaque,
                                   kPartial = accel::MaterialOpacity::kPartial,
                                   kCutOut = accel::MaterialOpacity::kCutOut;
  test::Random random(72);
  Counts counts;
  for (int scene = 0; scene < 6; ++scene) {
    Primitives primitives = sheets(random, 30, 4);
    const std::uint32_t first_opaque = primitives.add_object(sheets(random, 30, 1));
    const std::uint32_t mixed = primitives.add_object(sheets(random, 30, 4));
    for (std::uint32_t i = 0; i < 8; ++i) {
      const Transform place = test::random_transform(random, 1);
      const std::uint32_t material = i % 2 == 0 ? kOwnMaterials : random.below(4);
      primitives.add_instance({Placement(place), i % 3 == 0 ? mixed : first_opaque, material});
    }
    if (scene % 2 == 1)
      for (const std::uint32_t i : {1u, 6u})
        primitives.move_instance(
            i, MovingPlacement({TranslationMotion{{{0, 1}, {{0, 0, 0}, {0.5f, 0.25f, 0}}}}}, {0, 1}));
    const test::Soup soup{"materials", std::move(primitives), 1.5f};
    const HashedOpacity opacity(soup.primitives, {kOpaque, kPartial, kCutOut, kOpaque});
    expect_all_answers(soup, opacity, random, counts);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(counts.passed, 200);
  EXPECT_GT(counts.partial, 200);
  EXPECT_GT(counts.full, 1000);
}

// Packets of opaque materials are as if there were no others.
TEST(HitOpacity, IsAskedOnlyWherePacketsNeedIt) {
  test::Random random(73);
  Primitives primitives = sheets(random, 30, 1);
  primitives.add_object(sheets(random, 30, 1));
  primitives.add_object(sheets(random, 30, 1));
  primitives.add_instance({Placement({}), 0});
  primitives.add_instance({Placement({}), 0, 1});
  primitives.add_instance({Placement({}), 1, 2});
  const auto all_are = [](const accel::Bvh::Arrays& arrays, accel::MaterialOpacity opacity) {
    return std::all_of(arrays.packets.begin(), arrays.packets.end(), [&](const accel::BvhPacket& packet) {
      return packet.kind == GeometryKind::kInstance || packet.opacity == opacity;
    });
  };
  const accel::Bvh built = accel::Bvh::build(primitives, 1);
  accel::Bvh bvh = accel::Bvh::build(primitives, 1);
  const std::vector<accel::MaterialOpacity> of_materials{
      accel::MaterialOpacity::kOpaque, accel::MaterialOpacity::kCutOut, accel::MaterialOpacity::kPartial};
  bvh.set_opacities(primitives, of_materials, 2);
  EXPECT_TRUE(all_are(bvh.arrays(), accel::MaterialOpacity::kOpaque));
  EXPECT_TRUE(all_are(bvh.arrays().objects[0], accel::MaterialOpacity::kCutOut));
  EXPECT_TRUE(all_are(bvh.arrays().objects[1], accel::MaterialOpacity::kPartial));
  EXPECT_FALSE(bvh == built);
  bvh.set_opacities(primitives, std::vector<accel::MaterialOpacity>(3), 2);
  EXPECT_EQ(bvh, built);
}

}  // namespace
}  // namespace tessera::core
