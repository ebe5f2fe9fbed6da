// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/core_geometry/batches.hpp"

#include <gtest/gtest.h>

namespace tessera::core::test {

Rays camera_rays(const Soup& soup, Random& random, std::size_t count, float pixel) {
  const Vec3 eye = random.in_box(soup.half_size);
  const Vec3 to_target = point_of(soup.primitives, random) - eye;
  const Vec3 forward =
      length(to_target) > 0 && is_finite(to_target) ? to_target / length(to_target) : random.direction();
  const Vec3 right = normalize(cross(forward, random.direction())), up = cross(right, forward);
  Rays rays;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = static_cast<float>(i % 8 + i / 64 * 8), y = static_cast<float>(i / 8 % 8);
    rays.push_back({eye, forward + right * (pixel * x) + up * (pixel * y)});
  }
  return rays;
}

Rays lamp_rays(const Soup& soup, Random& random, std::size_t count, bool to_lamp) {
  const Vec3 lamp = random.in_box(soup.half_size);
  Rays rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 on_lamp = lamp + random.in_box(0.05f * soup.half_size);
    const Vec3 on_surface = point_of(soup.primitives, random);
    rays.push_back(to_lamp ? Ray{on_surface, on_lamp - on_surface, 1} : Ray{on_lamp, on_surface - on_lamp});
  }
  return rays;
}

Rays random_rays(const Soup& soup, Random& random, std::size_t count) {
  Rays rays;
  for (std::size_t i = 0; i < count; ++i) rays.push_back(random_ray(soup, random));
  return rays;
}

Rays parallel_rays(Random& random, std::size_t count) {
  Vec3 direction;
  const int axis = static_cast<int>(random.below(3));
  direction[axis] = random.below(2) == 0 ? 1.0f : -1.0f;
  Rays rays;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 origin;
    origin[axis] = -3 * direction[axis];
    origin[(axis + 1) % 3] = 0.5f * static_cast<float>(i % 8) - 2;
    origin[(axis + 2) % 3] = 0.5f * static_cast<float>(i / 8 % 8) - 2;
    rays.push_back({origin, direction});
  }
  return rays;
}

std::vector<Hit> closest_hits(const accel::Bvh& bvh, const Primitives& primitives, const Rays& rays,
                              const accel::HitOpacity* opacity) {
  const std::vector<Hit> wrong(rays.size(), Hit{0, 0, 0, 0});
  Columns<Hit> hits{std::span(wrong)};
  bvh.closest_hits(primitives, Columns<Ray>(std::span(rays)).all(), hits.all(), opacity);
  std::vector<Hit> found;
  for (std::size_t i = 0; i < hits.size(); ++i) found.push_back(hits[i]);
  return found;
}

std::vector<accel::Occlusion> occlusions(const accel::Bvh& bvh, const Primitives& primitives,
                                         const Rays& rays, const accel::HitOpacity* opacity) {
  std::vector<accel::Occlusion> occluded(rays.size(), static_cast<accel::Occlusion>(0xff));
  bvh.occlusions(primitives, Columns<Ray>(std::span(rays)).all(), occluded, opacity);
  return occluded;
}

WordLanes rows_from(std::size_t first) {
  WordLanes rows;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    rows.set(lane, static_cast<std::uint32_t>(first + lane));
  return rows;
}

void expect_same_answers(const accel::Bvh& bvh, const Primitives& primitives, const Rays& rays,
                         const accel::HitOpacity* opacity) {
  const std::vector<Hit> hits = closest_hits(bvh, primitives, rays, opacity);
  const std::vector<accel::Occlusion> occluded = occlusions(bvh, primitives, rays, opacity);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit expected = bvh.closest_hit(primitives, rays[i], opacity);
    ASSERT_TRUE(identical(hits[i], expected))
        << i << " of " << rays.size() << "\nexpected " << describe(rays[i], expected) << "\n     got "
        << describe(rays[i], hits[i]);
    ASSERT_EQ(occluded[i], bvh.occlusion(primitives, rays[i], opacity)) << describe(rays[i], expected);
    ASSERT_EQ(occluded[i] != accel::Occlusion::kNone, expected.found()) << describe(rays[i], expected);
  }
}

void expect_same_answers_beside(float bad, const accel::Bvh& bvh, const Soup& soup, Random& random) {
  for (Rays rays : {camera_rays(soup, random, 64, 0.01f), random_rays(soup, random, 64)}) {
    rays[3].direction = {bad, bad, bad};
    rays[8].origin.y = bad;
    rays[30].direction.z = bad;
    rays[31].t_max = bad;
    rays[32].t_max = -1;
    ASSERT_NO_FATAL_FAILURE(expect_same_answers(bvh, soup.primitives, rays)) << bad;
  }
}

}  // namespace tessera::core::test
