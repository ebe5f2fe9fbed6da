// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "client/local_render.hpp"
#include "client/tev_observer.hpp"
#include "client/tev_packets.hpp"
#include "core/film/develop.hpp"
#include "tests/support/fake_tev.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text.push_back(static_cast<char>(value));
  return text;
}

// The bytes of the protocol, written out.
TEST(TevPackets, AreThoseOfTheProtocol) {
  EXPECT_EQ(
      tev_create_image({"ab", 3, 258, {"R", "G", "B"}}),
      bytes({27, 0, 0, 0, 4, 0, 'a', 'b', 0, 3, 0, 0, 0, 2, 1, 0, 0, 3, 0, 0, 0, 'R', 0, 'G', 0, 'B', 0}));
  const std::array<float, 3> pixel{1, 2, -0.5f};
  const std::string strides = bytes({3, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(tev_update_image({"a", 9, 9, {"R", "G", "B"}}, {5, 6, 6, 7}, pixel),
            bytes({94, 0, 0, 0, 6, 0, 'a', 0, 3, 0, 0, 0, 'R', 0, 'G', 0, 'B', 0}) +
                bytes({5, 0, 0, 0, 6, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}) +
                bytes({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0}) + strides +
                strides + strides + bytes({0, 0, 0x80, 0x3f, 0, 0, 0, 0x40, 0, 0, 0, 0xbf}));
}

class TevTest : public testing::Test {
 protected:
  TevTest() : scene_(core::Scene::build(test::room(), 1).value()), settings_(scene_.settings()) {
    settings_.width_px = 150;
    settings_.height_px = 90;
    settings_.crop = core::PixelRect{7, 9, 149, 88};
    settings_.spp = 4;
  }

  // Renders what is missing, with pauses in which `between` is called.
  void render(
      SharedFilm& film, TevObserver& tev, const std::function<void()>& between = [] {}) {
    ProgressLine progress(no_progress_output(), 0);
    EXPECT_TRUE(render_locally({scene_, settings_, 2, {&tev}}, film, progress, [&] {
      between();
      return false;
    }));
  }

  core::Scene scene_;
  core::RenderSettings settings_;
  Notices notices_;
};

TEST_F(TevTest, ShowsTheImageToTheBit) {
  test::FakeTev viewer;
  SharedFilm film(core::TileGrid(settings_.window(), core::kTilePx));
  TevObserver tev(viewer.address(), "out.exr", notices_);
  render(film, tev);
  viewer.wait_for_end();
  EXPECT_TRUE(viewer.images()["out.exr"].pixels == film.develop().pixels);
  EXPECT_THAT(notices_.take(), testing::IsEmpty());
}

TEST_F(TevTest, ShowsLayersAsChannels) {
  settings_.layers = core::LayerSet().with(core::Layer::kNormal).with(core::Layer::kDepth);
  test::FakeTev viewer;
  SharedFilm film(core::TileGrid(settings_.window(), core::kTilePx), settings_.layers);
  TevObserver tev(viewer.address(), "out.exr", notices_);
  render(film, tev);
  viewer.wait_for_end();
  const auto shown = viewer.all()["out.exr"];
  EXPECT_THAT(shown.channels, ElementsAre("R", "G", "B", "Normal.X", "Normal.Y", "Normal.Z", "Depth.Z"));
  core::LayerRows rows(film.grid(), film.grid().window(), settings_.layers,
                       [&](int tile) { return film.tile(tile); });
  for (int y = 0; y < shown.height; ++y) {
    const std::size_t count = static_cast<std::size_t>(shown.width) * shown.channels.size();
    const float* const row = shown.values.data() + static_cast<std::size_t>(y) * count;
    ASSERT_TRUE(std::equal(row, row + count, *rows.row(y))) << "row " << y;
  }
}

TEST_F(TevTest, AViewerThatIsLostIsWarnedOfOnce) {
  auto viewer = std::make_unique<test::FakeTev>();
  SharedFilm film(core::TileGrid(settings_.window(), core::kTilePx));
  TevObserver tev(viewer->address(), "out.exr", notices_);
  const std::string address = viewer->address();
  render(film, tev, [&] {
    while (viewer && viewer->packets() == 0) std::this_thread::yield();
    viewer.reset();
  });
  const auto told = notices_.take();
  EXPECT_LE(told.size(), 2u);
  for (const std::string& notice : told) EXPECT_THAT(notice, HasSubstr("tev at " + address));
}

TEST_F(TevTest, AMissingViewerIsWarnedOfAndTheRenderGoesOn) {
  std::string address;
  { address = test::FakeTev().address(); }
  SharedFilm film(core::TileGrid(settings_.window(), core::kTilePx));
  TevObserver tev(address, "out.exr", notices_);
  render(film, tev);
  EXPECT_THAT(notices_.take(),
              ElementsAre(HasSubstr("no tev at " + address + ": Connection refused; start tev")));
}

TEST(TevOption, TellsAddressesFromOtherArguments) {
  for (const char* address : {"127.0.0.1:14158", "localhost:1", "[::1]:65535", "tev.example.org:80"}) {
    std::optional<std::string> given = address;
    EXPECT_EQ(take_argument(given), "");
    EXPECT_EQ(given, address);
  }
  for (const char* other : {"scene.json", "a:b", "host:0", "host:65536", ":5", "host:", "c:/scene.json"}) {
    std::optional<std::string> given = other;
    EXPECT_EQ(take_argument(given), other);
    EXPECT_EQ(given, kDefaultTev);
  }
  std::optional<std::string> none;
  EXPECT_EQ(take_argument(none), "");
}

}  // namespace
}  // namespace tessera::client
