// SPDX-License-Identifier: Apache-2.0
#include "core/lights/light.hpp"

#include <gtest/gtest.h>
#include <numbers>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/lights/light_sampler.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::lights {
namespace {

struct LightCase {
  const char* name;
  ShapeDescription shape;
  Vec3 p_lit;
  Vec3 middle;         // the cap around this point
  double cap_degrees;  // holds the light
};

class LightSampling : public testing::TestWithParam<LightCase> {
 protected:
  LightSampling() : scene_(build()), sampler_(scene_.lights(), LightSampler::Among::kAll, 1) {}

  static Scene build() {
    test::SceneMaker maker({});
    maker.material(test::lambert(0), Rgb::gray(1));
    maker.add(GetParam().shape);
    return maker.build();
  }

  // The density with which the scene's lights together sample a direction; 0 where none is met.
  double pdf(Vec3 wi) const {
    const Ray ray{GetParam().p_lit, wi};
    const Hit hit = scene_.bvh().closest_hit(scene_.primitives(), ray);
    if (!hit.found()) return 0;
    const std::uint32_t id = scene_.light_of(hit);
    const Vec3 p_light = scene_.primitives().surface(ray, hit).position;
    return static_cast<double>(sampler_.pmf({GetParam().p_lit}, id) *
                               area_light(id).pdf(GetParam().p_lit, p_light));
  }

  const AreaLight& area_light(std::uint32_t light) const {
    return *std::get_if<AreaLight>(&scene_.lights()[light]);
  }

  Scene scene_;
  LightSampler sampler_;
};

// What a light sends to a point, once by sampling it and once by looking in all directions for it.
TEST_P(LightSampling, AgreesWithLookingAround) {
  constexpr int kSamples = 400000;
  const Vec3 p = GetParam().p_lit, axis = normalize({0.3f, 0.5f, 0.2f});
  double sampled = 0, looked = 0, pdf_integral = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto u = sampling::Sampler(5, i % 1000, i / 1000, 0).pad(0);
    const auto choice = sampler_.sample({p}, static_cast<double>(u[2]));
    if (choice.light == kNoLight) continue;
    const AreaLight& light = area_light(choice.light);
    if (const auto s = light.sample(scene_.textures(), p, {u[0], u[1]})) {
      const float again = light.pdf(p, s->point->position);
      ASSERT_NEAR(s->pdf, again, 2e-3 * static_cast<double>(s->pdf)) << "sample() and pdf() disagree";
      sampled +=
          static_cast<double>(s->radiance.r * std::fabs(dot(s->wi, axis)) / (s->pdf * choice.pmf)) / kSamples;
    }
    const Vec3 wi = sampling::sample_sphere({u[0], u[3]});
    const double density = pdf(wi);
    if (density == 0) continue;
    looked += static_cast<double>(std::fabs(dot(wi, axis))) * 4 * std::numbers::pi / kSamples;
    pdf_integral += density * 4 * std::numbers::pi / kSamples;
  }
  EXPECT_NEAR(sampled, looked, 0.03 * looked);
  EXPECT_NEAR(pdf_integral, 1, 0.05);
}

// Pearson's test over cells of equal solid angle: of the cap around the light, or of the whole sphere.
TEST_P(LightSampling, SamplesMatchTheDensity) {
  constexpr int kRows = 12, kColumns = 24, kSamples = 100000, kFine = 24;
  const Vec3 p = GetParam().p_lit;
  const Frame frame = Frame::around(normalize(GetParam().middle - p));
  const double cap = 1 - std::cos(GetParam().cap_degrees * std::numbers::pi / 180);
  std::vector<double> observed(kRows * kColumns), expected(kRows * kColumns);
  for (int i = 0; i < kSamples; ++i) {
    const auto u = sampling::Sampler(9, i % 1000, i / 1000, 0).pad(0);
    const auto choice = sampler_.sample({p}, static_cast<double>(u[2]));
    const auto s = sample_light(scene_.lights()[choice.light], {}, {p, {}}, {u[0], u[1]});
    ASSERT_TRUE(s);
    const Vec3 w = frame.to_local(s->wi);
    const double row = (1 - static_cast<double>(w.z)) / cap * kRows;
    const double column = (std::atan2(w.y, w.x) / (2 * kPi) + 0.5f) * kColumns;
    ASSERT_LT(row, kRows) << "outside the cap that the test looks at";
    observed[static_cast<std::size_t>(static_cast<int>(row) * kColumns +
                                      std::min(kColumns - 1, static_cast<int>(column)))] += 1;
  }
  for (int r = 0; r < kRows * kFine; ++r)
    for (int c = 0; c < kColumns * kFine; ++c) {
      const double z = 1 - cap * (r + 0.5) / (kRows * kFine), rho = std::sqrt(1 - z * z);
      const double phi = 2 * std::numbers::pi * ((c + 0.5) / (kColumns * kFine) - 0.5);
      const Vec3 w{static_cast<float>(rho * std::cos(phi)), static_cast<float>(rho * std::sin(phi)),
                   static_cast<float>(z)};
      expected[static_cast<std::size_t>(r / kFine * kColumns + c / kFine)] +=
          pdf(frame.to_world(w)) * cap * 2 * std::numbers::pi / (kRows * kColumns * kFine * kFine) * kSamples;
    }
  test::expect_chi_square(observed, expected, 50);
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
    testing::Values(
        LightCase{"quad",
                  QuadDescription{{-1, 1, -1}, {2, 0, 0.5f}, {0, 0.3f, 1}, 0},
                  {0, 0, 0},
                  {0, 1, -0.3f},
                  70},
        LightCase{"near_quad",
                  QuadDescription{{-1, 0.1f, -1}, {2, 0, 0}, {0, 0, 2}, 0},
                  {0.3f, 0, 0},
                  {0.3f, 1, 0},
                  90},
        LightCase{"mesh", two_triangles(), {0.2f, 0, 0.1f}, {0, 1, 0}, 75},
        LightCase{"sphere", SphereDescription{{0, 2, 0.5f}, 0.8f, 0}, {0.1f, 0, 0}, {0, 2, 0.5f}, 24},
        LightCase{"near_sphere", SphereDescription{{0, 1, 0}, 0.95f, 0}, {0, 0, 0}, {0, 1, 0}, 72.5},
        LightCase{"inside_sphere", SphereDescription{{0, 0, 0}, 2, 0}, {0.9f, 0.5f, 0}, {0, 0, 0}, 180},
        LightCase{"disk",
                  DiskDescription{{0.2f, 1, 0}, {0.9f, 0.2f, 0}, {0, 0.3f, 0.8f}},
                  {0, 0, 0},
                  {0.2f, 1, 0},
                  60},
        LightCase{"ring",
                  DiskDescription{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, 0.6f},
                  {0.1f, 0, 0.2f},
                  {0.1f, 1, 0.2f},
                  60},
        LightCase{"in_a_cylinder",
                  CylinderDescription{{0, 0, -1}, {0, 0, 2}, {1, 0, 0}, {0, 1, 0}},
                  {0.2f, -0.3f, 0.1f},
                  {0.2f, 1, 0.1f},
                  180},
        LightCase{"in_an_elliptic_cylinder",
                  CylinderDescription{{0.1f, 0, -1}, {-0.2f, 0.1f, 2}, {1.6f, 0.2f, 0}, {0, 0.7f, 0.1f}},
                  {0.3f, 0.1f, 0.1f},
                  {0.3f, 1, 0.1f},
                  180},
        LightCase{
            "offset_sphere", SphereDescription{{300, 2, 0.5f}, 0.8f, 0}, {299, 1, 0}, {300, 2, 0.5f}, 40}),
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

// The ray passes p_lit, and meets the sphere on the side that it comes from.
TEST(AreaLight, SphereOnARayIsMetOnItsNearSide) {
  const AreaLight light = light_of(SphereLight{{1, 2, -3}, 0.5f}, {}, 2, false);
  const Vec3 p_lit{0.3f, 0.1f, 0.2f};
  for (const Vec3 forward : {Vec3{0, 0, -1}, {0, 0, 1}}) {
    for (int i = 0; i < 100; ++i) {
      const auto u = sampling::Sampler(6, i, 0, 0).pad(0);
      const auto sample = light.sample_along({}, p_lit, forward, {u[0], u[1]});
      ASSERT_TRUE(sample);
      EXPECT_GT(dot(sample->wi, forward), 0);
      const Vec3 to_point = sample->point->position - p_lit;
      EXPECT_NEAR(length(cross(to_point, sample->wi)), 0, 1e-5) << "it is on the ray";
      EXPECT_NEAR(length(sample->point->position - Vec3{1, 2, -3}), 0.5, 2e-6);
      EXPECT_LT(dot(sample->point->geometric_normal, sample->wi), 1e-3f);
      EXPECT_EQ(sample->radiance, Rgb::gray(2));
      EXPECT_NEAR(sample->pdf, light.pdf(p_lit, sample->point->position), 1e-3 * double{sample->pdf});
    }
  }
}

TEST(AreaLight, FlatLightOnARayEmitsAgainstIt) {
  const AreaLight light = light_of(QuadLight{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 0, 1}, 2, false);
  const auto towards_back = light.sample_along({}, {0.5f, 0.5f, 1}, {0, 0, -1}, {0.2f, 0.7f});
  ASSERT_TRUE(towards_back) << "the ray passes the point before it meets the front";
  EXPECT_LT(towards_back->wi.z, 0);
  const auto before = light.sample_along({}, {0.5f, 0.5f, -1}, {0, 0, -1}, {0.2f, 0.7f});
  ASSERT_TRUE(before) << "the ray meets the front before it passes the point";
  EXPECT_LT(before->wi.z, 0);
  EXPECT_EQ(before->point->position, towards_back->point->position);
  EXPECT_FALSE(light.sample_along({}, {0.5f, 0.5f, -1}, {0, 0, 1}, {0.2f, 0.7f})) << "it meets the back";
}

TEST(AreaLight, OneSidedEmitsToItsFront) {
  const AreaLight light = light_of(QuadLight{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 0, 1}, 2, false);
  const Vec3 middle{0.5f, 0.5f, 0};
  EXPECT_EQ(light.emitted({}, middle, {}, {0, 0, 1}), Rgb::gray(2));
  EXPECT_EQ(light.emitted({}, middle, {}, {0, 0, -1}), Rgb::gray(0));
  EXPECT_FALSE(light.sample({}, {0.5f, 0.5f, -1}, {0.5f, 0.5f}));
  EXPECT_TRUE(light.sample({}, {0.5f, 0.5f, 1}, {0.5f, 0.5f}));
}

// Radiance and opacity are looked up by different texture coordinates.
TEST(AreaLight, OfATriangleCanHaveTwoUvSets) {
  const auto ramp = std::make_shared<const TextureImage>(2, 1, std::vector<float>{1, 1, 1, 0.5f, 0.5f, 0.5f});
  std::vector<Texture> textures{{.image = ramp, .wrap = Wrap::kClamp}, {.image = ramp, .wrap = Wrap::kClamp}};
  textures[0].uv_set = UvSet::kSecond;
  SurfaceEmission emission{{Rgb::gray(8), 0}, 4, true};
  emission.opacity = {1, 1};
  const std::array<UvSets, 3> uvs{UvSets({0, 0}, {1, 0}), UvSets({1, 0}, {0, 0}), UvSets({0, 1}, {1, 1})};
  const Vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const AreaLight light(
      TriangleLight{corners[0], corners[1], corners[2], std::make_shared<const std::array<UvSets, 3>>(uvs)},
      {0, 0, 1}, emission);
  for (const Vec2 u : {Vec2{0.3f, 0.4f}, Vec2{0.7f, 0.2f}, Vec2{0.1f, 0.9f}}) {
    const auto sample = light.sample(textures, {0.2f, 0.3f, 2}, u);
    ASSERT_TRUE(sample);
    const float x = sample->point->position.x;  // the first u is x, the second 1 - x
    const float opacity = textures[1].evaluate(Vec2{x, 0}).r,
                radiance = 8 * textures[0].evaluate(Vec2{1 - x, 0}).r;
    EXPECT_NEAR(sample->radiance.g, opacity * radiance, 1e-4f);
  }
}

TEST(AreaLight, HasThePowerOfTheSidesThatEmit) {
  const double quad = 3.14159265 * 2 * 5;
  EXPECT_NEAR(light_of(QuadLight{{0, 0, 0}, {5, 0, 0}, {0, 1, 0}}, {0, 0, 1}, 2, false).power(), quad, 1e-4);
  EXPECT_NEAR(light_of(QuadLight{{0, 0, 0}, {5, 0, 0}, {0, 1, 0}}, {0, 0, 1}, 2, true).power(), 2 * quad,
              1e-4);
  EXPECT_NEAR(light_of(DiskLight{{}, {2, 0, 0}, {0, 2, 0}, 0.5f}, {0, 0, 1}, 2, false).power(),
              3.14159265 * 2 * 3.14159265 * 3, 1e-4);
  EXPECT_NEAR(light_of(CylinderLight{{}, {0, 0, 3}, {2, 0, 0}, {0, 2, 0}, false}, {}, 2, true).power(),
              2 * 3.14159265 * 2 * 3.14159265 * 12, 1e-3);
  EXPECT_NEAR(light_of(SphereLight{{0, 0, 0}, 2}, {}, 1, true).power(), 3.14159265 * 4 * 3.14159265 * 4,
              1e-3);
}

TEST(DeltaLights, AreSampledInTheOneDirectionThatTheyComeFrom) {
  const Vec3 p{1, 0, 0};
  const auto point = sample_light(PointLight({1, 2, 0}, Rgb::gray(8)), {}, {p, {}}, {});
  ASSERT_TRUE(point);
  EXPECT_EQ(point->wi, (Vec3{0, 1, 0}));
  EXPECT_EQ(point->radiance, Rgb::gray(2));
  EXPECT_EQ(point->point->position, (Vec3{1, 2, 0}));
  EXPECT_TRUE(point->delta);
  EXPECT_EQ(point->pdf, 1);
  const auto sun = sample_light(DirectionalLight({0, -1, 0}, Rgb::gray(3)), {}, {p, {}}, {});
  ASSERT_TRUE(sun);
  EXPECT_EQ(sun->wi, (Vec3{0, 1, 0}));
  EXPECT_FALSE(sun->point) << "it is nowhere in particular";
  EXPECT_FALSE(sample_light(PointLight(p, Rgb::gray(8)), {}, {p, {}}, {})) << "the light itself is not lit";
  EXPECT_FALSE(sample_light(SpotLight({1, 2, 0}, Rgb::gray(8), {{0, 1, 0}, 90, 0}), {}, {p, {}}, {}));
}

// Power by integrating what leaves a light over all directions.
TEST(DeltaLights, HaveThePowerOfWhatTheySend) {
  for (const float softness : {0.0f, 0.3f, 1.0f})
    for (const float angle : {20.0f, 100.0f, 180.0f}) {
      const SpotLight spot({0, 0, 0}, Rgb::gray(2), {{0, 0, 1}, angle, softness});
      constexpr int kSteps = 100000;
      double sent = 0;
      for (int i = 0; i < kSteps; ++i)
        sent += 2 * 2 * std::numbers::pi * 2 / kSteps *
                static_cast<double>(spot.falloff(2 * (static_cast<float>(i) + 0.5f) / kSteps));
      EXPECT_NEAR(spot.power(), sent, 1e-3 * sent) << angle << ' ' << softness;
    }
  EXPECT_NEAR(PointLight({}, Rgb::gray(2)).power(), 8 * std::numbers::pi, 1e-5);
  EXPECT_NEAR(power(DirectionalLight({0, 1, 0}, Rgb::gray(2)), 3), 2 * 9 * std::numbers::pi, 1e-5);
  EXPECT_NEAR(power(Environment(Rgb::gray(2), nullptr, 0), 3),
              2 * 4 * std::numbers::pi * 9 * std::numbers::pi, 1e-3);
}

TEST(SpotLight, FallsOffLinearlyInTheAngle) {
  const SpotLight spot({}, Rgb::gray(1), {{0, 0, 1}, 80, 0.5f, SpotFalloff::kLinear});
  const auto at = [&](double degrees) {
    return spot.falloff(static_cast<float>(1 - std::cos(degrees * std::numbers::pi / 180)));
  };
  EXPECT_EQ(at(19), 1);
  EXPECT_NEAR(at(25), 0.75f, 1e-4f);
  EXPECT_NEAR(at(39), 0.05f, 1e-4f);
  EXPECT_EQ(at(41), 0);
  // The integral of the falloff over the sphere, by parts.
  const double inner = std::numbers::pi / 9, outer = 2 * inner;
  EXPECT_NEAR(spot.power(),
              2 * std::numbers::pi * (1 - (std::sin(outer) - std::sin(inner)) / (outer - inner)), 1e-3);
}

// KHR_lights_punctual.
TEST(SpotLight, FallsOffWithTheSquareOfARamp) {
  const SpotLight spot({}, Rgb::gray(1), {{0, 0, 1}, 80, 0.5f, SpotFalloff::kSquared});
  const auto cosine = [](double degrees) { return std::cos(degrees * std::numbers::pi / 180); };
  for (const double degrees : {0.0, 19.0, 20.5, 25.0, 33.0, 39.9, 41.0}) {
    const double ramp = std::clamp((cosine(degrees) - cosine(40)) / (cosine(20) - cosine(40)), 0.0, 1.0);
    EXPECT_NEAR(spot.falloff(static_cast<float>(1 - cosine(degrees))), ramp * ramp, 1e-5) << degrees;
  }
  const double inner = 1 - cosine(20), outer = 1 - cosine(40);
  EXPECT_NEAR(spot.power(), 2 * std::numbers::pi * (inner + (outer - inner) / 3), 1e-4);
}

// Of two columns, the left one red and the right one green, the upper texels twice as bright.
std::vector<Texture> slide() {
  return {
      {.image = std::make_shared<TextureImage>(2, 2, std::vector<float>{2, 0, 0, 0, 2, 0, 1, 0, 0, 0, 1, 0}),
       .wrap = Wrap::kClamp}};
}

TEST(SpotLight, ProjectsAnImage) {
  ProjectedImage image{.texture = 0, .right = {0.5f, 0, 0}, .up = {0, 1, 0}};
  const auto light = [&](Vec3 to) {
    return SpotLight({}, Rgb::gray(3), {{0, 0, 1}, 120, 0}, image).sample(slide(), to);
  };
  EXPECT_NEAR(light({0.375f, 0.9f, 1})->radiance.g / light({0.375f, -0.9f, 1})->radiance.g, 2, 1e-5f);
  EXPECT_EQ(light({0.375f, 0.9f, 1})->radiance.r, 0);
  EXPECT_GT(light({-0.375f, 0.9f, 1})->radiance.r, 0);
  EXPECT_FALSE(light({0.51f, 0, 1}));
  EXPECT_FALSE(light({0, -1.01f, 1}));
  EXPECT_NEAR(light({0.45f, 0.8f, 1})->radiance.g, 6 / (1 + 0.45f * 0.45f + 0.8f * 0.8f), 1e-5f);
  image.flat_field = true;
  // On a plane the cosine to the light and the growing distance are made up for.
  const Vec3 place{0.45f, 0.8f, 1};
  const auto flat = light(place);
  EXPECT_NEAR(flat->radiance.g * std::fabs(flat->wi.z), 6, 1e-4f);
}

TEST(PointLight, EmitsAsAnImageSays) {
  const auto half = std::make_shared<TextureImage>(2, 1, std::vector<float>{1, 1, 1, 3, 3, 3});
  // The image is split at -z, its middle, into -x on the left and +x on the right.
  const PointLight light({}, Rgb::gray(2), half);
  EXPECT_NEAR(light.sample({1, 0, 0})->radiance.g, 6, 1e-5f);
  EXPECT_NEAR(light.sample({-1, 0, 0})->radiance.g, 2, 1e-5f);
  EXPECT_NEAR(light.power(), 16 * std::numbers::pi, 1e-4);
  Transform turned;
  turned.x_axis = {-1, 0, 0};
  EXPECT_NEAR(PointLight({}, Rgb::gray(2), half, turned).sample({1, 0, 0})->radiance.g, 2, 1e-5f);
}

TEST(SpotLight, MayBeAsNarrowAsALaser) {
  const SpotLight laser({}, Rgb::gray(1), {{0, 0, 1}, 0.001f, 0.5f});
  EXPECT_GT(laser.power(), 0);
  EXPECT_TRUE(laser.sample({}, {0, 0, 5}));
  EXPECT_FALSE(laser.sample({}, {0.001f, 0, 5}));
}

TEST(SpotLight, HasASharpEdgeWithoutSoftnessAndFallsOffSmoothlyWithIt) {
  const SpotLight sharp({}, Rgb::gray(1), {{0, 0, 1}, 60, 0});
  EXPECT_EQ(sharp.falloff(1 - std::cos(0.52f)), 1);
  EXPECT_EQ(sharp.falloff(1 - std::cos(0.53f)), 0);
  const SpotLight soft({}, Rgb::gray(1), {{0, 0, 1}, 60, 1});
  float last = 2;
  for (float angle = 0; angle < 0.6f; angle += 0.01f) {
    const float share = soft.falloff(1 - std::cos(angle));
    EXPECT_LE(share, last);
    EXPECT_LT(last - share, 0.05f + (last > 1 ? 1 : 0));
    last = share;
  }
  EXPECT_EQ(last, 0);
}

}  // namespace
}  // namespace tessera::core::lights
