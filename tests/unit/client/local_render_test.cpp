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

}  // namespace
}  // namespace tessera::client
