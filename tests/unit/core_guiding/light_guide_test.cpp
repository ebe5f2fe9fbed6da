// SPDX-License-Identifier: Apache-2.0
#include "core/guiding/light_guide.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/math/lane_array.hpp"
#include "core/math/octahedral_map.hpp"
#include "core/math/simd_double.hpp"
#include "tests/unit/core_guiding/example_photons.hpp"

namespace tessera::core::guiding {
namespace {

constexpr Vec3 kUp{0, 1, 0};

// What other light there is grows along x.
float darker_at_the_left(const Photon& photon, std::uint32_t) {
  return photon.position.x * photon.position.x * 1e5f;
}

LightGuide guide_of(std::uint32_t photons, int threads = 1) {
  return LightGuide::build(test::photons_on_floor(photons), share_beside(darker_at_the_left), threads);
}

// 0 where nothing is known.
float share_at(const LightGuide& guide, Vec3 place, Vec3 side_normal = kUp) {
  return guide.at(place, side_normal).share;
}

TEST(LightGuide, OfNothingKnowsNothing) {
  EXPECT_EQ(share_at(LightGuide(), {0, 0, 0}), 0);
  EXPECT_TRUE(guide_of(0).cells().empty());
  EXPECT_EQ(share_at(guide_of(0), {0, 0, 0}), 0);
}

TEST(LightGuide, KnowsOnlyWherePhotonsFell) {
  const LightGuide guide = guide_of(10000);
  EXPECT_GT(share_at(guide, {0.5f, 0, 0.5f}), 0);
  EXPECT_EQ(share_at(guide, {0.5f, 0, 0.5f}, -kUp), 0) << "the other side";
  EXPECT_EQ(share_at(guide, {0.5f, 0.5f, 0.5f}), 0) << "above the floor";
  EXPECT_EQ(share_at(guide, {5, 0, 0.5f}), 0) << "beside it";
}

// However many photons there are on surfaces that face the same way, and so however deep their cells lie.
TEST(LightGuide, FindsTheCellsOfAllPhotons) {
  std::vector<Photon> photons = test::photons_on_floor(20000);
  for (std::size_t i = 0; i < photons.size(); ++i) {
    const float u = photons[i].position.x;
    photons[i].side_normal = i < 100 ? Vec3{1, 0, 0} : i < 3000 ? Vec3{0, 0, -1} : u < 0.1f ? -kUp : kUp;
  }
  const LightGuide guide = LightGuide::build(photons, share_beside(darker_at_the_left), 1);
  for (const Photon& photon : photons) ASSERT_GT(share_at(guide, photon.position, photon.side_normal), 0);
}

// Most photons are in a plane across the axis along which all of them are spread the most, as those of a wall
// behind a ball.
TEST(LightGuide, FindsTheCellsOfPhotonsInAPlane) {
  std::vector<Photon> photons = test::photons_on_floor(20000);
  for (std::size_t i = 0; i < photons.size(); ++i) {
    const Vec3 place = photons[i].position;
    photons[i].position = {i % 5 == 0 ? 9 * place.x : 3, place.x, place.z};
    photons[i].side_normal = {1, 0, 0};
    photons[i].wi = {1, 0, 0};
  }
  const LightGuide guide = LightGuide::build(photons, share_beside(darker_at_the_left), 1);
  for (const Photon& photon : photons) ASSERT_GT(share_at(guide, photon.position, photon.side_normal), 0);
}

// The view through an opening moves with the place.
TEST(LightGuide, KnowsHowFarAnOpeningIs) {
  const Vec3 opening{0.5f, 2, 0.5f};
  std::vector<Photon> photons;
  for (std::uint32_t i = 0; i < 200; ++i) {
    const auto u = sampling::Sampler(19, 0, 0, i).pad(0);
    const Vec3 place{u[0], 0, u[1]}, seen = opening + Vec3{0.3f * u[2], 0, 0.3f * u[3]};
    photons.push_back({place, kUp, normalize(seen - place), std::numeric_limits<float>::infinity(), 1, 0});
  }
  const LightGuide guide = LightGuide::build(photons, share_beside(darker_at_the_left), 1);
  ASSERT_EQ(guide.cells().size(), 1u);
  EXPECT_NEAR(guide.cells()[0].radius, 2, 0.4f);
}

// From places all over a cell, not only from its middle.
TEST(LightGuide, DensityIntegratesToOneFromEverywhere) {
  const LightGuide guide = guide_of(3000);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const auto u = sampling::Sampler(11, 0, 0, i).pad(0);
    const Vec3 place{u[0], 0, u[1]};
    const auto guidance = guide.at(place, kUp);
    ASSERT_GT(guidance.share, 0);
    double sum = 0;
    constexpr int kSide = 2048;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const Vec3 d = from_octahedral_square<float>(
            {(static_cast<float>(x) + 0.5f) / kSide, (static_cast<float>(y) + 0.5f) / kSide});
        sum += static_cast<double>(guide.sample_or(guidance, false, {}, d).pdf) *
               static_cast<double>(octahedral_area(d));
      }
    EXPECT_NEAR(sum / (kSide * kSide), 1, 0.01);
  }
}

// The mean of 1 / pdf over samples is the solid angle of all directions.
TEST(LightGuide, SamplesFollowTheDensity) {
  const LightGuide guide = guide_of(3000);
  const Vec3 place{0.3f, 0, 0.8f};
  const auto guidance = guide.at(place, kUp);
  ASSERT_GT(guidance.share, 0);
  constexpr std::uint32_t kSamples = 1 << 18;
  double octants[8] = {}, all = 0;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const auto u = sampling::Sampler(13, 0, 0, i).pad(0);
    const auto [wi, pdf] = guide.sample_or(guidance, true, {u[0], u[1]}, kUp);
    EXPECT_NEAR(length(wi), 1, 1e-5f);
    const double share = 1 / static_cast<double>(pdf) / kSamples;
    octants[(wi.x > 0 ? 1 : 0) + (wi.y > 0 ? 2 : 0) + (wi.z > 0 ? 4 : 0)] += share;
    all += share;
  }
  EXPECT_NEAR(all, 4 * static_cast<double>(kPi), 0.05);
  for (const double octant : octants) EXPECT_NEAR(octant, static_cast<double>(kPi) / 2, 0.05);
}

TEST(LightGuide, IsAskedForMoreWhereItKnowsMoreOfTheLight) {
  const LightGuide guide = guide_of(10000);
  const float left = share_at(guide, {0.02f, 0, 0.5f}), right = share_at(guide, {0.98f, 0, 0.5f});
  EXPECT_GT(left, right);
  EXPECT_GT(right, 0);
  for (const LightGuide::Cell& cell : guide.cells()) {
    EXPECT_GT(cell.share, 0);
    EXPECT_LT(cell.share, 1);
  }
}

TEST(LightGuide, SurvivesPhotonsOfOnePlace) {
  std::vector<Photon> photons(5000, {{1, 2, 3}, kUp, kUp, 1, 1, 1});
  EXPECT_EQ(share_at(LightGuide::build(photons, share_beside(darker_at_the_left), 1), {1, 2, 3}), 0);
}

// Eight at once are to the bit what each is alone.
TEST(LightGuide, AnswersEightPlacesAsItAnswersEach) {
  const LightGuide guide = guide_of(10000);
  for (std::uint32_t i = 0; i < 512; ++i) {
    Vec3Lanes places, normals, wis;
    FloatLanes u_x, u_y;
    for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
      const auto u = sampling::Sampler(17, 0, 0, kLaneCount * i + lane).pad(0),
                 v = sampling::Sampler(17, 1, 0, i).pad(lane);
      places.set(lane, {1.2f * u[0] - 0.1f, 0, 1.2f * u[1] - 0.1f});  // some beside the floor
      normals.set(lane, sampling::sample_sphere({u[2], u[3]}));
      wis.set(lane, sampling::sample_sphere({v[0], v[1]}));
      u_x.set(lane, v[2]), u_y.set(lane, v[3]);
    }
    const auto all = guide.at(places.all(), normals.all());
    const auto chosen =
        guide.sample_or(all, MaskN::from_bits(i), Vec2Of<FloatN>{u_x.all(), u_y.all()}, wis.all());
    const FloatLanes share(all.share), pdf(chosen.pdf);
    const Vec3Lanes direction(chosen.direction);
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const auto one = guide.at(places[lane], normals[lane]);
      ASSERT_EQ(share[lane], one.share);
      if (one.share == 0) continue;
      const auto of_one = guide.sample_or(one, (i >> lane & 1) != 0, {u_x[lane], u_y[lane]}, wis[lane]);
      ASSERT_EQ(pdf[lane], of_one.pdf);
      ASSERT_EQ(direction[lane], of_one.direction);
    }
  }
}

}  // namespace
}  // namespace tessera::core::guiding
