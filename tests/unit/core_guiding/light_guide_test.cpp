#include "core/guiding/light_guide.hpp"

#include <gtest/gtest.h>

#include "core/guiding/octahedral_map.hpp"
#include "tests/unit/core_guiding/example_photons.hpp"

namespace tessera::core {
namespace {

constexpr Vec3 kUp{0, 1, 0};

// What other light there is grows along x.
float darker_at_the_left(const Photon& photon, std::uint32_t) {
  return photon.position.x * photon.position.x * 1e5f;
}

LightGuide guide_of(std::uint32_t photons, int threads = 1) {
  return LightGuide::build(test::photons_on_floor(photons), darker_at_the_left, threads);
}

TEST(LightGuide, OfNothingKnowsNothing) {
  EXPECT_EQ(LightGuide().find({0, 0, 0}, kUp), nullptr);
  EXPECT_TRUE(guide_of(0).cells().empty());
  EXPECT_EQ(guide_of(0).find({0, 0, 0}, kUp), nullptr);
}

TEST(LightGuide, KnowsOnlyWherePhotonsFell) {
  const LightGuide guide = guide_of(10000);
  EXPECT_NE(guide.find({0.5f, 0, 0.5f}, kUp), nullptr);
  EXPECT_EQ(guide.find({0.5f, 0, 0.5f}, -kUp), nullptr) << "the other side";
  EXPECT_EQ(guide.find({0.5f, 0.5f, 0.5f}, kUp), nullptr) << "above the floor";
  EXPECT_EQ(guide.find({5, 0, 0.5f}, kUp), nullptr) << "beside it";
}

// From places all over a cell, not only from its middle.
TEST(LightGuide, DensityIntegratesToOneFromEverywhere) {
  const LightGuide guide = guide_of(3000);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const auto u = Sampler(11, 0, 0, i).pad(0);
    const Vec3 place{u[0], 0, u[1]};
    const LightGuide::Cell* cell = guide.find(place, kUp);
    ASSERT_NE(cell, nullptr);
    double sum = 0;
    constexpr int kSide = 2048;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const Vec3 d = from_octahedral_square(
            {(static_cast<float>(x) + 0.5f) / kSide, (static_cast<float>(y) + 0.5f) / kSide});
        sum += static_cast<double>(guide.pdf(*cell, place, d)) * static_cast<double>(octahedral_area(d));
      }
    EXPECT_NEAR(sum / (kSide * kSide), 1, 0.01);
  }
}

// The mean of 1 / pdf over samples is the solid angle of all directions.
TEST(LightGuide, SamplesFollowTheDensity) {
  const LightGuide guide = guide_of(3000);
  const Vec3 place{0.3f, 0, 0.8f};
  const LightGuide::Cell* cell = guide.find(place, kUp);
  ASSERT_NE(cell, nullptr);
  constexpr std::uint32_t kSamples = 1 << 18;
  double octants[8] = {}, all = 0;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const auto u = Sampler(13, 0, 0, i).pad(0);
    const Vec3 wi = guide.sample(*cell, place, {u[0], u[1]});
    EXPECT_NEAR(length(wi), 1, 1e-5f);
    const double share = 1 / static_cast<double>(guide.pdf(*cell, place, wi)) / kSamples;
    octants[(wi.x > 0 ? 1 : 0) + (wi.y > 0 ? 2 : 0) + (wi.z > 0 ? 4 : 0)] += share;
    all += share;
  }
  EXPECT_NEAR(all, 4 * static_cast<double>(kPi), 0.05);
  for (const double octant : octants) EXPECT_NEAR(octant, static_cast<double>(kPi) / 2, 0.05);
}

TEST(LightGuide, IsAskedForMoreWhereItKnowsMoreOfTheLight) {
  const LightGuide guide = guide_of(10000);
  const auto left = guide.find({0.02f, 0, 0.5f}, kUp), right = guide.find({0.98f, 0, 0.5f}, kUp);
  ASSERT_TRUE(left && right);
  EXPECT_GT(left->share, right->share);
  for (const LightGuide::Cell& cell : guide.cells()) {
    EXPECT_GT(cell.share, 0);
    EXPECT_LT(cell.share, 1);
  }
}

TEST(LightGuide, SurvivesPhotonsOfOnePlace) {
  std::vector<Photon> photons(5000, {{1, 2, 3}, kUp, kUp, 1, 1});
  EXPECT_EQ(LightGuide::build(photons, darker_at_the_left, 1).find({1, 2, 3}, kUp), nullptr);
}

}  // namespace
}  // namespace tessera::core
