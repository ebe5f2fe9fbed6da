#include "core/lights/light.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/lights/light_sampler.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core {
namespace {

struct LightCase {
  const char* name;
  ShapeDescription shape;
  Vec3 p_lit;
};

class LightSampling : public testing::TestWithParam<LightCase> {
 protected:
  LightSampling() : scene_(build()) {}

  static Scene build() {
    test::SceneMaker maker({});
    maker.material(test::lambert(0), Rgb::gray(1));
    maker.add(GetParam().shape);
    return maker.build();
  }

  Scene scene_;
};

// What a light sends to a point, once by sampling it and once by looking in all directions for it.
TEST_P(LightSampling, AgreesWithLookingAround) {
  constexpr int kSamples = 400000;
  const Vec3 p = GetParam().p_lit, axis = normalize({0.3f, 0.5f, 0.2f});
  double sampled = 0, looked = 0, pdf_integral = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto u = Sampler(5, i % 1000, i / 1000, 0).pad(0);
    const auto choice = scene_.light_sampler().sample(static_cast<double>(u[2]));
    const AreaLight& light = scene_.area_light(choice.light);
    if (const auto s = light.sample(scene_.textures(), p, {u[0], u[1]})) {
      const float again = light.pdf(p, s->point->position);
      ASSERT_NEAR(s->pdf, again, 2e-3 * static_cast<double>(s->pdf)) << "sample() and pdf() disagree";
      sampled +=
          static_cast<double>(s->radiance.r * std::fabs(dot(s->wi, axis)) / (s->pdf * choice.pmf)) / kSamples;
    }
    const Vec3 wi = sample_sphere({u[0], u[3]});
    const Ray ray{p, wi};
    const Hit hit = scene_.bvh().closest_hit(scene_.primitives(), ray);
    if (!hit.found()) continue;
    looked += static_cast<double>(std::fabs(dot(wi, axis))) * 4 * 3.14159265 / kSamples;
    const std::uint32_t id = scene_.light_of(hit.primitive);
    const Vec3 p_light = scene_.primitives().surface(ray, hit).position;
    pdf_integral +=
        static_cast<double>(scene_.light_sampler().pmf(id) * scene_.area_light(id).pdf(p, p_light)) * 4 *
        3.14159265 / kSamples;
  }
  EXPECT_NEAR(sampled, looked, 0.03 * looked);
  EXPECT_NEAR(pdf_integral, 1, 0.05);
}

MeshDescription two_triangles() {
  return {.positions = {{-1, 1, -1}, {1, 1.5f, -1}, {1, 1, 1}, {-1, 0.5f, 1}},
          .normals = {},
          .uvs = {},
          .triangles = {{0, 1, 2}, {0, 2, 3}},
          .triangle_materials = {0}};
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, LightSampling,
    testing::Values(LightCase{"quad", QuadDescription{{-1, 1, -1}, {2, 0, 0.5f}, {0, 0.3f, 1}, 0}, {0, 0, 0}},
                    LightCase{"mesh", two_triangles(), {0.2f, 0, 0.1f}},
                    LightCase{"sphere", SphereDescription{{0, 2, 0.5f}, 0.8f, 0}, {0.1f, 0, 0}},
                    LightCase{"inside_sphere", SphereDescription{{0, 0, 0}, 2, 0}, {0.9f, 0.5f, 0}},
                    LightCase{"offset_sphere", SphereDescription{{300, 2, 0.5f}, 0.8f, 0}, {299, 1, 0}}),
    [](const auto& test_case) { return std::string(test_case.param.name); });

AreaLight light_of(const LightShape& shape, Vec3 front, float radiance, bool two_sided) {
  return {shape, front, {{Rgb::gray(radiance)}, static_cast<double>(radiance), two_sided}};
}

TEST(AreaLight, FarSphereIsSampledAccurately) {
  const AreaLight light = light_of(SphereLight{{0, 1000, 0}, 0.5f}, {}, 1, true);
  const auto sample = light.sample({}, {0, 0, 0}, {0.7f, 0.3f});
  ASSERT_TRUE(sample);
  EXPECT_NEAR(1 / static_cast<double>(sample->pdf), 3.14159265 * 0.25e-6, 1e-10);
}

TEST(AreaLight, OneSidedEmitsToItsFront) {
  const AreaLight light = light_of(QuadLight{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 0, 1}, 2, false);
  SurfacePoint middle;
  middle.position = {0.5f, 0.5f, 0};
  EXPECT_EQ(light.emitted({}, middle, {0, 0, 1}), Rgb::gray(2));
  EXPECT_EQ(light.emitted({}, middle, {0, 0, -1}), Rgb::gray(0));
  EXPECT_FALSE(light.sample({}, {0.5f, 0.5f, -1}, {0.5f, 0.5f}));
  EXPECT_TRUE(light.sample({}, {0.5f, 0.5f, 1}, {0.5f, 0.5f}));
}

TEST(AreaLight, HasThePowerOfTheSidesThatEmit) {
  const double quad = 3.14159265 * 2 * 5;
  EXPECT_NEAR(light_of(QuadLight{{0, 0, 0}, {5, 0, 0}, {0, 1, 0}}, {0, 0, 1}, 2, false).power(), quad, 1e-4);
  EXPECT_NEAR(light_of(QuadLight{{0, 0, 0}, {5, 0, 0}, {0, 1, 0}}, {0, 0, 1}, 2, true).power(), 2 * quad,
              1e-4);
  EXPECT_NEAR(light_of(SphereLight{{0, 0, 0}, 2}, {}, 1, true).power(), 3.14159265 * 4 * 3.14159265 * 4,
              1e-3);
}

TEST(LightSampler, ChoosesNineTimesInTenInProportionToPower) {
  const LightSampler sampler({1, 2, 10});
  EXPECT_NEAR(sampler.pmf(0), 0.9 * 1 / 13 + 0.1 / 3, 1e-6);
  EXPECT_NEAR(sampler.pmf(1), 0.9 * 2 / 13 + 0.1 / 3, 1e-6);
  EXPECT_NEAR(sampler.pmf(2), 0.9 * 10 / 13 + 0.1 / 3, 1e-6);
  EXPECT_EQ(sampler.sample(0.5).light, 2u);
  EXPECT_TRUE(LightSampler(std::vector<double>{}).empty());
}

TEST(LightSampler, LeavesOutLightsWithoutPower) {
  const LightSampler sampler({0, 3, 0, 1});
  EXPECT_NEAR(sampler.pmf(1), 0.9 * 3 / 4 + 0.05, 1e-6);
  EXPECT_EQ(sampler.pmf(0), 0);
  EXPECT_EQ(sampler.sample(0).light, 1u);
  EXPECT_TRUE(LightSampler({0, 0}).empty());
}

TEST(LightSampler, FindsAFaintLightBesideABrightOne) {
  const LightSampler sampler({1e-6, 1e12});
  EXPECT_NEAR(sampler.pmf(0), 0.05, 1e-6);
  EXPECT_EQ(sampler.sample(0.049).light, 0u);
}

}  // namespace
}  // namespace tessera::core
