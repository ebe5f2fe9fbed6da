// SPDX-License-Identifier: Apache-2.0
#include "core/guiding/direction_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/math/octahedral_map.hpp"
#include "core/sampling/warp.hpp"
#include "tests/support/chi_square.hpp"
#include "tests/unit/core_guiding/example_photons.hpp"

namespace tessera::core::guiding {
namespace {

std::vector<DirectedLight> examples(std::uint32_t count) {
  std::vector<DirectedLight> all;
  for (const Photon& photon : test::photons_on_floor(count))
    all.push_back({photon.wi, photon.flux, 0.1f * photon.flux * photon.radiance});
  return all;
}

float pdf_of(const DirectionTrees& trees, DirectionTrees::Root root, Vec3 direction) {
  return trees.sample_or<float>(root, false, {}, direction).pdf;
}

TEST(DirectionTrees, DensityIntegratesToOne) {
  DirectionTrees trees;
  for (const std::uint32_t count : {1u, 5u, 100u, 5000u}) {
    const auto root = trees.add(examples(count)).root;
    double sum = 0;
    constexpr int kSide = 1024;  // eight by eight places in each of the smallest squares
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const Vec3 d = from_octahedral_square<float>(
            {(static_cast<float>(x) + 0.5f) / kSide, (static_cast<float>(y) + 0.5f) / kSide});
        sum += static_cast<double>(pdf_of(trees, root, d)) * static_cast<double>(octahedral_area(d));
      }
    EXPECT_NEAR(sum / (kSide * kSide), 1, 2e-3) << count << " examples";
  }
}

TEST(DirectionTrees, SamplesFollowTheDensity) {
  DirectionTrees trees;
  const auto root = trees.add(examples(1000)).root;
  constexpr int kSide = 64, kSamples = 1 << 18, kFine = 8;
  std::vector<double> observed(kSide * kSide), expected(kSide * kSide);
  const auto cell = [](float c) { return std::min(static_cast<int>(c * kSide), kSide - 1); };
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const auto u = sampling::Sampler(3, 0, 0, i).pad(0);
    const Vec2 at = to_octahedral_square(trees.sample_or<float>(root, true, {u[0], u[1]}, {}).direction);
    ++observed[static_cast<std::size_t>(cell(at.y) * kSide + cell(at.x))];
  }
  for (int y = 0; y < kSide * kFine; ++y)
    for (int x = 0; x < kSide * kFine; ++x) {
      const Vec3 d = from_octahedral_square<float>({(static_cast<float>(x) + 0.5f) / (kSide * kFine),
                                                    (static_cast<float>(y) + 0.5f) / (kSide * kFine)});
      expected[static_cast<std::size_t>(y / kFine * kSide + x / kFine)] +=
          static_cast<double>(pdf_of(trees, root, d)) * static_cast<double>(octahedral_area(d)) * kSamples /
          (kSide * kSide * kFine * kFine);
    }
  test::expect_chi_square(observed, expected, 100);
}

// But for those at the very edge of a square.
TEST(DirectionTrees, SamplesComeWithTheDensityOfTheirDirection) {
  DirectionTrees trees;
  for (const std::uint32_t count : {1u, 20u, 300u, 5000u}) {
    const auto root = trees.add(examples(count)).root;
    int others = 0;
    for (std::uint32_t i = 0; i < 4096; ++i) {
      const auto u = sampling::Sampler(4, 0, 0, i).pad(0);
      const auto [direction, pdf] = trees.sample_or<float>(root, true, {u[0], u[1]}, {});
      EXPECT_NEAR(length(direction), 1, 1e-6f);
      if (std::fabs(pdf - pdf_of(trees, root, direction)) > 1e-4f * pdf) ++others;
    }
    EXPECT_LE(others, 4) << count << " examples";
  }
}

TEST(DirectionTrees, OfNoneAreEven) {
  const DirectionTrees trees;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto u = sampling::Sampler(6, 0, 0, i).pad(0);
    const auto [direction, pdf] = trees.sample_or<float>(0, true, {u[0], u[1]}, {});
    EXPECT_NEAR(pdf * octahedral_area(direction), 1, 1e-5f);
    EXPECT_LT(length(direction - from_octahedral_square<float>({u[0], u[1]})), 1e-4f);
  }
}

TEST(DirectionTrees, HaveSomeDensityEverywhereAndMostWhereExamplesAre) {
  DirectionTrees trees;
  const auto root = trees.add(examples(1000)).root;
  int above = 0;  // where all of the examples are
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const auto u = sampling::Sampler(5, 0, 0, i).pad(0);
    EXPECT_GT(pdf_of(trees, root, sampling::sample_sphere({u[0], u[1]})), 0);
    if (trees.sample_or<float>(root, true, {u[2], u[3]}, {}).direction.y > 0) ++above;
  }
  EXPECT_GT(above, 900);
}

// The same power from either side, but on one of them from few directions.
TEST(DirectionTrees, LookLongerForLightThatComesFromFewerDirections) {
  DirectionTrees trees;
  const Vec3 wide = normalize({1, 1, 1}), narrow = normalize({-1, -1, 1});
  const auto [root, root_mean_square] = trees.add(std::vector<DirectedLight>{{wide, 1, 0}, {narrow, 1, 4}});
  EXPECT_GT(pdf_of(trees, root, narrow), 2 * pdf_of(trees, root, wide));
  EXPECT_GT(pdf_of(trees, root, wide), 2 * pdf_of(trees, root, normalize({-1, 1, 1})));
  EXPECT_GT(root_mean_square, 3);
}

}  // namespace
}  // namespace tessera::core::guiding
