// SPDX-License-Identifier: Apache-2.0
// The keystone: a sample is a pure function, and the film is an exact sum.
#include "core/integrators/render.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

class Render : public testing::Test {
 protected:
  Render() : scene_(Scene::build(test::room(), 2).value()) {}

  PixelRect image() const { return {0, 0, scene_.settings().width_px, scene_.settings().height_px}; }
  FilmTile whole(const RenderSettings& settings, int threads) const {
    return render(prepare(scene_, settings, threads), image(), {0, settings.spp}, threads);
  }

  Scene scene_;
};

TEST_F(Render, ThreadsDoNotChangeABit) {
  const FilmTile one = whole(scene_.settings(), 1);
  for (const int threads : {2, 3, 7, 64}) {
    const FilmTile many = whole(scene_.settings(), threads);
    ASSERT_EQ(many.sums, one.sums) << threads;
    ASSERT_EQ(many.odd_sums, one.odd_sums) << threads;
    ASSERT_EQ(many.counters, one.counters) << threads;
  }
}

TEST_F(Render, CuttingAndShufflingDoesNotChangeABit) {
  for (const Integrator integrator :
       {Integrator::kNaive, Integrator::kNee, Integrator::kMis, Integrator::kWhitted}) {
    RenderSettings settings = scene_.settings();
    settings.integrator = integrator;
    const TileGrid grid(settings.width_px, settings.height_px, 16);
    Film expected(grid);
    expected.add(whole(settings, 2));

    std::mt19937 random(static_cast<unsigned>(integrator));
    std::vector<std::pair<int, SampleRange>> work;
    for (int t = 0; t < grid.tile_count(); ++t)
      for (std::uint32_t begin = 0; begin < settings.spp;) {
        const auto end = std::min(settings.spp, begin + 1 + static_cast<std::uint32_t>(random() % 5));
        work.push_back({t, {begin, end}});
        begin = end;
      }
    std::shuffle(work.begin(), work.end(), random);
    Film film(grid);
    const RenderPlan plan = prepare(scene_, settings, 1);
    for (const auto& [tile, range] : work)
      film.add(render(plan, grid.rect(tile), range, 1 + static_cast<int>(random() % 3)));
    ASSERT_TRUE(film == expected) << integrator_name(integrator);
  }
}

TEST_F(Render, AskingForMoreSamplesKeepsTheFirst) {
  RenderSettings more = scene_.settings();
  more.spp = 1000;
  EXPECT_EQ(render(prepare(scene_, more, 1), {3, 5, 20, 9}, {2, 9}, 1).sums,
            render(prepare(scene_, scene_.settings(), 1), {3, 5, 20, 9}, {2, 9}, 1).sums);
}

TEST_F(Render, SeedsGiveIndependentImages) {
  RenderSettings other = scene_.settings();
  other.seed = 1;
  EXPECT_NE(whole(other, 2).sums, whole(scene_.settings(), 2).sums);
}

TEST_F(Render, CountsWhatItDoes) {
  const RenderCounters counters = whole(scene_.settings(), 2).counters;
  EXPECT_EQ(counters.samples, 48u * 32u * 16u);
  EXPECT_GT(counters.closest_hit_rays, counters.samples);
  EXPECT_GT(counters.shadow_rays, 0u);
  EXPECT_EQ(counters.non_finite_samples, 0u);
  EXPECT_EQ(counters.saturated_samples, 0u);
}

TEST_F(Render, OneSampleCanBeReplayed) {
  const SampleId id{24, 20, 5};
  const RenderPlan plan = prepare(scene_, scene_.settings(), 1);
  const FilmTile tile = render(plan, {24, 20, 25, 21}, {5, 6}, 1);
  const Rgb radiance = render_sample(plan, id);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(static_cast<double>(tile.sums[c]) * kFilmUnit,
                static_cast<double>(radiance[static_cast<int>(c)]), kFilmUnit);
}

TEST_F(Render, OddSamplesAreSummedApart) {
  const RenderPlan plan = prepare(scene_, scene_.settings(), 1);
  const FilmTile both = render(plan, {0, 0, 8, 8}, {0, 2}, 1);
  const FilmTile odd = render(plan, {0, 0, 8, 8}, {1, 2}, 1);
  EXPECT_EQ(both.odd_sums, odd.sums);
}

TEST(RenderNonFinite, IsCountedAndNamedAndBlack) {
  test::SceneMaker maker({.position = {0, 0, 3}, .look_at = {0, 0, 0}});
  const auto overflowing = maker.material(test::lambert(1), Rgb::gray(3e38f));
  maker.add(QuadDescription{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, overflowing});
  maker.add(QuadDescription{{-1, -1, -1}, {2, 0, 0}, {0, 0, 2}, overflowing});
  const Scene scene = maker.build();
  const RenderPlan plan = prepare(scene, {.width_px = 16, .height_px = 16, .spp = 4}, 2);
  const FilmTile tile = render(plan, {0, 0, 16, 16}, {0, 4}, 2);
  ASSERT_GT(tile.counters.non_finite_samples, 0u);
  ASSERT_TRUE(tile.counters.first_non_finite);
  EXPECT_GT(tile.counters.saturated_samples, 0u);
  EXPECT_FALSE(is_finite(render_sample(plan, *tile.counters.first_non_finite)));
}

// Each sample's direct light is kept, and its indirect light limited.
TEST(ClampIndirect, LimitsIndirectLightOfEachSample) {
  const Scene scene = Scene::build(test::room(), 1).value();
  RenderPlans plans(scene);
  constexpr float kLimit = 0.3f;
  int limited = 0;
  for (int x = 0; x < 400; ++x) {
    const SampleId id{x % 48, x / 48 * 3, 5};
    const auto radiance = [&](int max_depth, float clamp) {
      RenderSettings settings = scene.settings();
      settings.max_depth = max_depth;
      settings.clamp_indirect = clamp;
      return render_sample(plans.get(settings, 1), id);
    };
    const Rgb all = radiance(0, 0), direct = radiance(1, 0), clamped = radiance(0, kLimit);
    const float most = max_component(all - direct), scale = most > kLimit ? kLimit / most : 1;
    limited += most > kLimit ? 1 : 0;
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(clamped[c], direct[c] + (all[c] - direct[c]) * scale, 1e-4f * (1 + all[c]));
  }
  EXPECT_GT(limited, 20);
}

}  // namespace
}  // namespace tessera::core::integrators
