// SPDX-License-Identifier: Apache-2.0
#include "client/local_render.hpp"

#include <gtest/gtest.h>

#include <random>

#include "client/render_checkpoint.hpp"
#include "core/integrators/render.hpp"
#include "tests/support/temporary_folder.hpp"
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

  SharedFilm empty_film() const { return SharedFilm(core::TileGrid(settings_.window(), core::kTilePx)); }

  // Takes samples until `should_stop`; returns whether the film is complete.
  bool render(SharedFilm& film, const std::function<bool()>& should_stop, int threads = 2,
              std::vector<RenderObserver*> observers = {}) {
    ProgressLine progress(no_progress_output(), 0);
    return render_locally({scene_, settings_, threads, std::move(observers)}, film, progress, should_stop);
  }

  core::Film at_once() const {
    core::Film film(core::TileGrid(settings_.window(), core::kTilePx));
    film.add(core::integrators::render(core::integrators::prepare(scene_, settings_, 1), settings_.window(),
                                       {0, settings_.spp}, 1));
    return film;
  }

  core::Scene scene_;
  core::RenderSettings settings_;
};

const auto kNever = [] { return false; };

TEST_F(LocalRenderTest, IsTheSameAsRenderingInOneCall) {
  SharedFilm film = empty_film();
  EXPECT_TRUE(render(film, kNever));
  EXPECT_TRUE(film.film() == at_once());
  EXPECT_EQ(film.totals().counters,
            core::integrators::render(core::integrators::prepare(scene_, settings_, 1), settings_.window(),
                                      {0, settings_.spp}, 1)
                .counters);
}

TEST_F(LocalRenderTest, StopsWhenAsked) {
  int questions = 0;
  SharedFilm film = empty_film();
  EXPECT_FALSE(render(film, [&questions] { return ++questions == 3; }));
  EXPECT_EQ(questions, 3);
  EXPECT_GT(film.totals().counters.samples, 0u);
  EXPECT_LT(film.totals().counters.samples, 150u * 70 * 3);
}

TEST_F(LocalRenderTest, StopsBeforeTheFirstSample) {
  SharedFilm film = empty_film();
  EXPECT_FALSE(render(film, [] { return true; }));
  EXPECT_EQ(film.totals().counters.samples, 0u);
}

// Stopped again and again, each time continued from the file by another number of threads, and at last with
// more samples.
TEST_F(LocalRenderTest, ContinuedFromCheckpointsIsTheSameToTheBit) {
  const TemporaryFolder folder;
  const std::string path = folder.path() / "film";
  for (std::uint32_t seed = 0; seed < 2; ++seed) {
    std::mt19937 random(seed);
    settings_.crop = seed % 2 == 0 ? std::nullopt : std::optional(core::PixelRect{3, 5, 140, 69});
    settings_.spp = 5;
    SharedFilm first = empty_film();
    int calls = 0;
    render(first, [&] { return ++calls > 1; });
    ASSERT_TRUE(write_checkpoint(path, identity_of(settings_, {}), first));
    bool complete = false;
    for (int threads = 1; !complete; threads = threads % 3 + 1) {
      if (random() % 2 == 0) settings_.spp = 9;
      auto checkpoint = read_checkpoint(path, identity_of(settings_, {}));
      ASSERT_TRUE(checkpoint) << checkpoint.error().message;
      SharedFilm film(std::move(checkpoint->film), checkpoint->header.totals);
      const auto most = 1 + random() % 4;
      complete = render(
          film, [&, n = std::size_t{0}]() mutable { return n++ == most; }, threads);
      ASSERT_TRUE(write_checkpoint(path, identity_of(settings_, {}), film));
    }
    settings_.spp = 9;
    auto last = read_checkpoint(path, identity_of(settings_, {}));
    ASSERT_TRUE(last) << last.error().message;
    SharedFilm film(std::move(last->film), last->header.totals);
    EXPECT_TRUE(render(film, kNever, 3));
    EXPECT_TRUE(film.film() == at_once()) << "seed " << seed;
    EXPECT_EQ(film.totals().counters,
              core::integrators::render(core::integrators::prepare(scene_, settings_, 1), settings_.window(),
                                        {0, settings_.spp}, 1)
                  .counters);
  }
}

// Keeps an image of its own, of the tiles that it is told of.
class ImageOfTiles : public RenderObserver {
 public:
  void begin(const core::Film& film, const core::RenderSettings&) override {
    film_ = &film;
    image_ = film.develop();
  }
  std::mutex& film_mutex() override { return mutex_; }
  void samples_added(const core::PixelRect& rect, const core::SampleRange&) override {
    const std::lock_guard lock(mutex_);
    const core::PixelRect& window = film_->grid().window();
    const core::Image now = film_->develop();
    for (int y = rect.y0 - window.y0; y < rect.y1 - window.y0; ++y)
      for (int x = rect.x0 - window.x0; x < rect.x1 - window.x0; ++x) image_.at(x, y) = now.at(x, y);
  }
  void end() override { film_ = nullptr; }

  const core::Image& image() const { return image_; }
  bool has_ended() const { return film_ == nullptr; }

 private:
  const core::Film* film_ = nullptr;
  std::mutex mutex_;
  core::Image image_;
};

TEST_F(LocalRenderTest, TellsObserversOfEveryTile) {
  settings_.crop = core::PixelRect{1, 2, 139, 69};
  SharedFilm film = empty_film();
  for (const bool complete : {false, true}) {
    ImageOfTiles one, other;
    int calls = 0;
    EXPECT_EQ(render(film, [&] { return !complete && ++calls > 2; }, 2, {&one, &other}), complete);
    const core::Image image = film.develop();
    EXPECT_TRUE(one.image().pixels == image.pixels);
    EXPECT_TRUE(other.image().pixels == image.pixels);
    EXPECT_TRUE(one.has_ended() && other.has_ended());
  }
}

// Whatever reaches a pixel from its neighbours' places, it reaches it in a window as well: also at its edge.
TEST_F(LocalRenderTest, OfAWindowGivesThosePixelsOfTheWholeImage) {
  settings_.filter = core::default_filter(core::FilterKind::kGaussian);
  SharedFilm whole_film = empty_film();
  EXPECT_TRUE(render(whole_film, kNever));
  const core::Image whole = whole_film.develop();
  for (const core::PixelRect& window :
       {core::PixelRect{0, 0, 150, 70}, {67, 13, 141, 68}, {63, 63, 65, 65}, {149, 69, 150, 70}}) {
    settings_.crop = window;
    SharedFilm film = empty_film();
    EXPECT_TRUE(render(film, kNever));
    EXPECT_EQ(film.totals().counters.samples, window.pixel_count() * settings_.spp);
    const core::Image image = film.develop();
    ASSERT_EQ(image.width, window.width());
    ASSERT_EQ(image.height, window.height());
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        ASSERT_EQ(image.at(x, y), whole.at(window.x0 + x, window.y0 + y)) << x << ' ' << y;
  }
}

}  // namespace
}  // namespace tessera::client
