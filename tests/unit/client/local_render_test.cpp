// SPDX-License-Identifier: Apache-2.0
#include "client/local_render.hpp"

#include <gtest/gtest.h>

#include "core/integrators/render.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::client {
namespace {

class LocalRenderTest : public testing::Test {
 protected:
  LocalRenderTest() : scene_(core::Scene::build(test::room(), 1).value()), settings_(scene_.settings()) {
    settings_.width_px = 150;  // not a whole number of tiles
    settings_.height_px = 70;
    settings_.spp = 3;
  }

  LocalRender render(const std::function<bool()>& should_stop) {
    ProgressLine progress(no_progress_output(), 0);
    return render_locally(scene_, settings_, 2, progress, should_stop);
  }

  core::Scene scene_;
  core::RenderSettings settings_;
};

TEST_F(LocalRenderTest, IsTheSameAsRenderingInOneCall) {
  const core::PixelRect everything{0, 0, settings_.width_px, settings_.height_px};
  const core::FilmTile at_once = core::render(scene_, settings_, everything, {0, settings_.spp}, 1);
  core::Film film(core::TileGrid(settings_.width_px, settings_.height_px, core::kTilePx));
  film.add(at_once);
  const LocalRender result = render([] { return false; });
  EXPECT_TRUE(result.complete);
  EXPECT_TRUE(result.film == film);
  EXPECT_EQ(result.counters, at_once.counters);
}

TEST_F(LocalRenderTest, StopsWhenAsked) {
  int questions = 0;
  const LocalRender result = render([&questions] { return ++questions == 3; });
  EXPECT_FALSE(result.complete);
  EXPECT_EQ(questions, 3);
  EXPECT_GT(result.counters.samples, 0u);
  EXPECT_LT(result.counters.samples, 150u * 70 * 3);
}

TEST_F(LocalRenderTest, StopsBeforeTheFirstSample) {
  const LocalRender result = render([] { return true; });
  EXPECT_FALSE(result.complete);
  EXPECT_EQ(result.counters.samples, 0u);
}

// Whatever reaches a pixel from its neighbours' places, it reaches it in a window as well: also at its edge.
TEST_F(LocalRenderTest, OfAWindowGivesThosePixelsOfTheWholePicture) {
  settings_.filter = core::default_filter(core::FilterKind::kGaussian);
  const core::Image whole = render([] { return false; }).film.develop();
  for (const core::PixelRect& window :
       {core::PixelRect{0, 0, 150, 70}, {67, 13, 141, 68}, {63, 63, 65, 65}, {149, 69, 150, 70}}) {
    settings_.crop = window;
    const LocalRender result = render([] { return false; });
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(result.counters.samples, window.pixel_count() * settings_.spp);
    const core::Image image = result.film.develop();
    ASSERT_EQ(image.width, window.width());
    ASSERT_EQ(image.height, window.height());
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        ASSERT_EQ(image.at(x, y), whole.at(window.x0 + x, window.y0 + y)) << x << ' ' << y;
  }
}

}  // namespace
}  // namespace tessera::client
