// SPDX-License-Identifier: Apache-2.0
// Inputs that people met in the wild, where they are at hand: what is seen of them.
// tests/unit/core_scene/shared_cases_test.cpp has all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/integrators/render.hpp"
#include "core/scene/loader/loader.hpp"

namespace tessera::core::integrators {
namespace {

const std::filesystem::path kSharedCases = TESSERA_SOURCE_DIR "/../shared/cases";
constexpr int kCaseWidth = 48, kCaseHeight = 36;

class SharedCaseImages : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kSharedCases)) GTEST_SKIP() << kSharedCases << " is not there";
  }

  // Pixels of a scene of 240 x 180 pixels, one fifth as large.
  static std::vector<Rgb> image_of(const std::string& folder) {
    auto description = load_scene_file((kSharedCases / folder / "scene.json").string());
    EXPECT_TRUE(description.has_value()) << folder;
    if (!description) return {};
    const auto scene = Scene::build(std::move(*description), 1);
    EXPECT_TRUE(scene.has_value()) << folder;
    if (!scene) return {};
    constexpr std::uint32_t kSpp = 64;
    RenderSettings settings = scene->settings();
    settings.width_px = kCaseWidth;
    settings.height_px = kCaseHeight;
    settings.spp = kSpp;
    const FilmTile tile = render(prepare(*scene, settings, 2), {0, 0, kCaseWidth, kCaseHeight}, {0, kSpp}, 2);
    const auto value = [&](std::size_t i) {
      return static_cast<float>(static_cast<double>(tile.sums[i]) * kFilmUnit / kSpp);
    };
    std::vector<Rgb> pixels;
    for (std::size_t i = 0; i < tile.sums.size(); i += 3)
      pixels.push_back({value(i), value(i + 1), value(i + 2)});
    return pixels;
  }

  static Rgb centre(const std::vector<Rgb>& pixels) {
    return pixels.empty() ? Rgb{} : pixels[kCaseHeight / 2 * kCaseWidth + kCaseWidth / 2];
  }
  static float mean_difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
    float sum = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) sum += std::fabs(a[i].g - b[i].g);
    return sum / static_cast<float>(a.size());
  }
};

// Glass whose vertex normals point inwards is glass; glass that is wound inwards is an air bubble.
TEST_F(SharedCaseImages, WindingDecidesTheFrontOfGlass) {
  const std::string folder = "29-front-is-by-vn-not-by-winding/";
  const auto glass = image_of(folder + "67-glass"), turned = image_of(folder + "68-glass-normals-inward"),
             bubble = image_of(folder + "69-glass-winding-inward");
  EXPECT_LT(mean_difference(glass, turned), 5e-3f);
  EXPECT_GT(mean_difference(glass, bubble), 0.02f);
}

TEST_F(SharedCaseImages, WindingDecidesTheFrontOfLamps) {
  const std::string folder = "29-front-is-by-vn-not-by-winding/";
  EXPECT_GT(centre(image_of(folder + "89b-emit-front-vn-inward")).g, 1.95f);
  EXPECT_LT(centre(image_of(folder + "89c-emit-front-winding-inward")).g, 0.5f);
}

// Not a gray mirror. The sky is bluish.
TEST_F(SharedCaseImages, RoughGoldOfBlenderIsGolden) {
  const Rgb gold = centre(image_of("05-blender-metal-is-perfect-mirror/71-blender-rough-metal"));
  EXPECT_GT(gold.r, gold.g);
  EXPECT_GT(gold.g, 1.5f * gold.b);
}

// Not a sheet of clear glass where illum is 4. The centre of the image is on the yellow centre of the card.
TEST_F(SharedCaseImages, CutoutsAreCardsWhateverIllum) {
  const auto masked = image_of("08-alpha-cutouts/74-map_d-cutout");
  EXPECT_LT(mean_difference(masked, image_of("08-alpha-cutouts/74b-map_d-cutout-illum4")), 1e-6f);
  EXPECT_GT(centre(masked).r, 2 * centre(masked).b);
}

}  // namespace
}  // namespace tessera::core::integrators
