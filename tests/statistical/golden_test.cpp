// SPDX-License-Identifier: Apache-2.0
#include "tests/statistical/golden.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/film/region.hpp"
#include "core/image/decode.hpp"
#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "tests/statistical/shipped_scenes.hpp"

namespace tessera::test {
namespace {

constexpr int kBatches = 6;
constexpr std::uint64_t kFirstSeed = 1000;  // none of the references'
constexpr int kBlockPx = 4;                 // pixels are judged in blocks: their means are nearly normal

Golden read_golden(const std::string& name) {
  return {core::read_image(golden_mean_path(name)).value(),
          core::read_image(golden_variance_path(name)).value(), kReferenceBatches};
}

// By how many standard errors the mean of a rectangle's channel differs.
double z_score(const Golden& rendered, const Golden& reference, core::PixelRect rect, int channel) {
  double difference = 0, variance = 0, level = 0;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) {
      const auto at = [&](const core::Image& image) { return static_cast<double>(image.at(x, y)[channel]); };
      difference += at(rendered.mean) - at(reference.mean);
      // A rare bright sample may be in one of the two alone.
      const double of_batch = std::max(at(rendered.variance), at(reference.variance));
      variance += of_batch * (1.0 / rendered.batches + 1.0 / reference.batches);
      level += at(reference.mean);
    }
  return std::fabs(difference) / std::sqrt(variance + 1e-10 * level * level + 1e-20);
}

struct Verdict {
  double largest = 0;      // z-score of all blocks and of the whole image
  double mean_square = 0;  // of the blocks' z-scores: near 1 if the images have the same expectation
  core::PixelRect where{};

  bool same() const { return largest < 6 && mean_square < 1.35; }
};

Verdict judge(const Golden& rendered, const Golden& reference) {
  Verdict verdict;
  const auto score = [&](core::PixelRect rect, int channel) {
    const double z = z_score(rendered, reference, rect, channel);
    if (z > verdict.largest) {
      verdict.largest = z;
      verdict.where = rect;
    }
    return z;
  };
  const core::TileGrid blocks(kGoldenWidthPx, kGoldenHeightPx, kBlockPx);
  for (int c = 0; c < 3; ++c) {
    score({0, 0, kGoldenWidthPx, kGoldenHeightPx}, c);
    for (int b = 0; b < blocks.tile_count(); ++b) {
      const double z = score(blocks.rect(b), c);
      verdict.mean_square += z * z / (3 * blocks.tile_count());
    }
  }
  return verdict;
}

// Where a person can look at it.
std::string write_failed(const std::string& name, const core::Image& rendered) {
  const std::string folder = TESSERA_BINARY_DIR "/golden_failures", path = folder + "/" + name + ".exr";
  std::filesystem::create_directories(folder);
  const auto bytes = core::encode_image(rendered, core::ImageFormat::kExr);
  return bytes && core::write_file_atomically(path, *bytes) ? path : "(not written)";
}

class GoldenImage : public testing::TestWithParam<std::string> {};

TEST_P(GoldenImage, IsWhatItWas) {
  const auto scene = core::Scene::build(load_shipped_scene(GetParam()), 2);
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_TRUE(std::filesystem::exists(golden_mean_path(GetParam())))
      << "no reference yet; make it with: tessera_make_golden " << GetParam();
  const Golden rendered = render_golden(*scene, kFirstSeed, kBatches);
  const Verdict verdict = judge(rendered, read_golden(GetParam()));
  EXPECT_TRUE(verdict.same()) << fmt::format(
      "the rectangle from ({}, {}) to ({}, {}) is off by {:.2f} standard errors; the mean square over all "
      "blocks is {:.3f}\n"
      "image:     {}\nreference: {}",
      verdict.where.x0, verdict.where.y0, verdict.where.x1, verdict.where.y1, verdict.largest,
      verdict.mean_square, write_failed(GetParam(), rendered.mean), golden_mean_path(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Scenes, GoldenImage, testing::ValuesIn(shipped_scenes()),
                         [](const auto& test_case) { return test_case.param; });

// The judge tells an image that is two in a hundred brighter, and one that is shifted by a pixel, from
// noise.
TEST(GoldenJudge, FindsSmallChanges) {
  const auto scene = core::Scene::build(load_shipped_scene("cornell"), 2);
  ASSERT_TRUE(scene);
  const Golden reference = read_golden("cornell"), rendered = render_golden(*scene, kFirstSeed, kBatches);
  EXPECT_TRUE(judge(rendered, reference).same());

  Golden brighter = rendered;
  for (auto& pixel : brighter.mean.pixels) pixel *= 1.02f;
  EXPECT_FALSE(judge(brighter, reference).same());

  Golden shifted = rendered;
  std::rotate(shifted.mean.pixels.begin(), shifted.mean.pixels.begin() + 1, shifted.mean.pixels.end());
  EXPECT_FALSE(judge(shifted, reference).same());
}

}  // namespace
}  // namespace tessera::test
