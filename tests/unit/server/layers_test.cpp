// SPDX-License-Identifier: Apache-2.0
// Jobs whose images have layers: what workers send, what is kept, and what users get.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/version.hpp"
#include "core/film/develop.hpp"
#include "core/image/encode.hpp"
#include "core/scene/render_record.hpp"
#include "core/view/shown_layer.hpp"
#include "core/view/tile_pixels.hpp"
#include "proto/convert.hpp"
#include "proto/tile_codec.hpp"
#include "server/film/fingerprinter.hpp"
#include "tests/support/layered_tile.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using core::Layer;
using core::LayerSet;
using testing::ElementsAreArray;
using testing::HasSubstr;

core::FilmTile layered_tile(const core::PixelRect& rect, core::SampleRange range,
                            LayerSet layers = core::kAllLayers) {
  core::FilmTile tile = ready_made_tile(rect, range);
  tile.layers = layers;
  test::add_made_up_planes(tile);
  return tile;
}

v1::SubmitJobRequest submission_with(LayerSet layers) {
  v1::SubmitJobRequest request = submission();
  core::RenderOverrides overrides;
  overrides.layers = layers;
  *request.mutable_overrides() = proto::to_proto(overrides);
  return request;
}

// What a render on one machine writes. `attributes`: those of the file.
std::string local_file(LayerSet layers, core::ImageFormat format,
                       const core::TextAttributes& attributes = {}) {
  const core::TileGrid grid(kWidthPx, kHeightPx, core::kTilePx);
  core::Film film(grid, layers);
  for (int tile = 0; tile < grid.tile_count(); ++tile)
    film.add(layered_tile(grid.rect(tile), {0, kSpp}, layers));
  core::LayerRows rows(grid, grid.window(), layers,
                       [&](int tile) -> core::Result<core::Film::TileSums> { return film.tile(tile); });
  const core::ChannelRows source{
      kWidthPx,     kHeightPx, core::image_channels(layers), [&](int y) { return rows.row(y); },
      std::nullopt, attributes};
  return core::encode_channels(source, format, {}).value_or("");
}

class LayersTest : public ScriptedFarm {
 protected:
  LayersTest() {
    check_scene_ = [](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                      const std::vector<std::int32_t>& frames, const std::stop_token& stop) {
      auto scene = accept_scene(bundle, overrides, frames, stop);
      scene->scene_digests.emplace_back("d1");
      v1::TextAttribute& matte = scene->attributes.emplace_back();
      matte.set_name("cryptomatte/1234567/name");
      matte.set_value("CryptoObject");
      return scene;
    };
    open();
  }

  static v1::RenderedItem item_of(const v1::WorkItem& message, LayerSet layers) {
    const auto item = proto::from_proto(message);
    return proto::encode_tile(layered_tile(item->rect, item->range, layers), item->image);
  }
  // Delivers at most so many leases, of which `change` may change the result.
  int work_with(
      char worker, LayerSet layers, int leases = 1'000'000,
      const std::function<void(v1::RenderedItem&)>& change = [](v1::RenderedItem&) {}) {
    int done = 0;
    for (; done < leases; ++done) {
      const WaitingCall call(coordinator(), greeting(worker));
      if (!call.answered() || !call.answer() || call.answer()->leases().empty()) break;
      v1::SubmitResultRequest request = delivery(worker, call.answer()->leases(0));
      for (int i = 0; i < request.items_size(); ++i) {
        *request.mutable_items(i) = item_of(request.items(i).item(), layers);
        change(*request.mutable_items(i));
      }
      last_ = coordinator().dispatcher().submit_result(request);
      if (last_) continue;
      request.clear_items();  // gives the lease back
      EXPECT_TRUE(coordinator().dispatcher().submit_result(request));
      return done;
    }
    return done;
  }
  std::string file_of(const std::string& id, v1::ImageFormat format, const std::string& layer = "",
                      const std::vector<std::string>& channels = {}) {
    v1::GetImageRequest request;
    request.set_job_id(id);
    request.set_format(format);
    request.set_layer(layer);
    request.mutable_channels()->Add(channels.begin(), channels.end());
    const auto written = coordinator().images().write(request);
    error_ = written ? core::Error{} : written.error();
    return written ? written->file.read_at(0, written->size_bytes).value_or("") : "";
  }
  core::TextAttributes attributes(const std::string& id) {
    core::TextAttributes expected = core::attributes_of({.version = std::string(core::version()),
                                                         .fingerprint = kFingerprint,
                                                         .scene = "d1",
                                                         .settings = *proto::from_proto(job(id).settings()),
                                                         .frame = 0,
                                                         .complete = true});
    expected.emplace_back("cryptomatte/1234567/name", "CryptoObject");
    return expected;
  }
  void expect_local_image(const std::string& id) {
    EXPECT_TRUE(file_of(id, v1::IMAGE_FORMAT_EXR) ==
                local_file(core::kAllLayers, core::ImageFormat::kExr, attributes(id)));
    EXPECT_TRUE(file_of(id, v1::IMAGE_FORMAT_PNG) == local_file(core::kAllLayers, core::ImageFormat::kPng));
  }

  core::Result<v1::SubmitResultResponse> last_ = v1::SubmitResultResponse();
  core::Error error_;
};

TEST_F(LayersTest, AreNotLeasedToAWorkerThatDoesNotRenderThem) {
  const std::string id = submit(submission_with(core::kAllLayers));
  v1::SynchronizeRequest old = greeting('e');
  old.set_renders_layers(false);
  const WaitingCall call(coordinator(), old);
  EXPECT_FALSE(call.answered());
  EXPECT_EQ(job(id).waiting_reason(), "no connected worker renders layers: update the workers");
  const std::string without = submit();
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer()->leases(0).job_id(), without);
}

TEST_F(LayersTest, AreThoseOfTheLocalImage) {
  const std::string id = submit(submission_with(core::kAllLayers));
  while (stored_job(id).state() == v1::JOB_STATE_RUNNING) {
    for (const char worker : {'a', 'b', 'c'}) work_with(worker, core::kAllLayers, 1);
    ASSERT_TRUE(last_) << last_.error().message;
  }
  expect_local_image(id);
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
  EXPECT_THAT(job(id).settings().layers(), ElementsAreArray(core::layer_names()));
  EXPECT_EQ(job(id).images(0).layout().channels(0).name(), "R");
  EXPECT_EQ(static_cast<std::size_t>(job(id).images(0).layout().channels_size()),
            core::film_layout(core::kAllLayers).channels.size());
}

TEST_F(LayersTest, OfAPartSayThatTheyAreOfItsWindow) {
  const std::string id = submit(submission_with(core::kAllLayers));
  work_with('a', core::kAllLayers);
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  v1::GetImageRequest request;
  request.set_job_id(id);
  request.set_format(v1::IMAGE_FORMAT_EXR);
  *request.mutable_region() = proto::to_proto(core::PixelRect{10, 20, 80, 70});
  const auto written = coordinator().images().write(request);
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_THAT(written->file.read_at(0, written->size_bytes).value_or(""),
              HasSubstr("\"crop\":[10,20,80,70],"));
}

TEST_F(LayersTest, SurviveARestartInTheMiddle) {
  const std::string id = submit(submission_with(core::kAllLayers));
  ASSERT_GT(work_with('a', core::kAllLayers, 3), 0);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  work_with('b', core::kAllLayers, 2);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  work_with('a', core::kAllLayers);
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  expect_local_image(id);
  open();
  expect_local_image(id);
}

// Memory for the planes of about one tile of six.
TEST_F(LayersTest, NeedNotFitIntoMemory) {
  constexpr double kTileBytes = 64 * 64 * 8 * 24;
  limits_.film_gib = kTileBytes / (1 << 30);
  open();
  const std::string id = submit(submission_with(core::kAllLayers));
  for (int round = 0; round < 1000 && job(id).state() == v1::JOB_STATE_RUNNING; ++round) {
    work_with('a', core::kAllLayers, 1);
    EXPECT_TRUE(last_ || last_.error().code == ErrorCode::kUnavailable) << last_.error().message;
    ASSERT_TRUE(coordinator().checkpointer().checkpoint());
    EXPECT_LE(coordinator().film_memory().used_bytes(), coordinator().film_memory().budget_bytes());
  }
  expect_local_image(id);
}

TEST_F(LayersTest, OfAJobWithoutAnyAreNotInItsFiles) {
  const std::string id = submit();
  work('a');
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  EXPECT_TRUE(file_of(id, v1::IMAGE_FORMAT_EXR) ==
              *core::encode_image(ready_made_image(kWidthPx, kHeightPx, kSpp), core::ImageFormat::kExr, {},
                                  {}, attributes(id)));
  EXPECT_EQ(job(id).images(0).layout().channels_size(), 0);
  file_of(id, v1::IMAGE_FORMAT_EXR, "albedo");
  EXPECT_EQ(error_.code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(error_.message, HasSubstr("layer: the image has no layers, and not albedo"));
  file_of(id, v1::IMAGE_FORMAT_EXR, "albedos");
  EXPECT_THAT(error_.message, HasSubstr("layer: must be one of alpha, "));
}

TEST_F(LayersTest, AreFetchedOneByOne) {
  const LayerSet layers = LayerSet{}.with(Layer::kNormal).with(Layer::kDepth).with(Layer::kCryptoObject);
  const std::string id = submit(submission_with(layers));
  work_with('a', layers);
  ASSERT_TRUE(last_) << last_.error().message;
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  const core::TileGrid grid(kWidthPx, kHeightPx, core::kTilePx);
  core::Film film(grid, layers);
  for (int tile = 0; tile < grid.tile_count(); ++tile)
    film.add(layered_tile(grid.rect(tile), {0, kSpp}, layers));
  for (const Layer layer : {Layer::kNormal, Layer::kDepth, Layer::kCryptoObject}) {
    core::Image image(kWidthPx, kHeightPx);
    for (int tile = 0; tile < grid.tile_count(); ++tile) {
      const core::PixelRect rect = grid.rect(tile);
      const core::Image part = view::develop_layer(layers, layer, rect, film.tile(tile), 0);
      for (int y = 0; y < rect.height(); ++y)
        for (int x = 0; x < rect.width(); ++x) image.at(rect.x0 + x, rect.y0 + y) = part.at(x, y);
    }
    const std::string name(core::layer_name(layer));
    EXPECT_TRUE(file_of(id, v1::IMAGE_FORMAT_PFM, name) ==
                *core::encode_image(image, core::ImageFormat::kPfm))
        << name << error_.message;
  }
  EXPECT_TRUE(file_of(id, v1::IMAGE_FORMAT_EXR, "", {"R", "G", "B"}) ==
              *core::encode_image(ready_made_image(kWidthPx, kHeightPx, kSpp), core::ImageFormat::kExr));
  file_of(id, v1::IMAGE_FORMAT_EXR, "albedo");
  EXPECT_THAT(error_.message, HasSubstr("layer: the image has only normal, depth, crypto_object"));
}

TEST_F(LayersTest, AreSentToWatchers) {
  const LayerSet layers = LayerSet{}.with(Layer::kAlbedo);
  const std::string id = submit(submission_with(layers));
  work_with('a', layers, 1);
  watch::TileQuery query{.job_id = id, .format = v1::TILE_FORMAT_RGB32F, .max_bytes = 1 << 20};
  query.layer = Layer::kAlbedo;
  const auto update = coordinator().tile_feed().update(query);
  ASSERT_TRUE(update) << update.error().message;
  ASSERT_FALSE(update->tiles.empty());
  for (const v1::TileImage& tile : update->tiles) {
    const auto rect = proto::from_proto(tile.rect());
    const auto pixels =
        view::decode_pixels(tile.pixels_zlib(), rect->width(), rect->height(), view::PixelFormat::kFloat);
    ASSERT_TRUE(pixels);
    const core::FilmTile samples = layered_tile(*rect, {0, tile.samples()}, layers);
    core::Film alone(core::TileGrid(*rect, core::kTilePx), layers);
    alone.add(samples);
    EXPECT_EQ(pixels->pixels, view::develop_layer(layers, Layer::kAlbedo, *rect, alone.tile(0), 0).pixels);
  }
  query.layer = Layer::kDepth;
  EXPECT_EQ(coordinator().tile_feed().update(query).error().code, ErrorCode::kInvalidArgument);
}

TEST_F(LayersTest, AreSentTogetherToWatchersOfAllChannels) {
  const std::string id = submit(submission_with(core::kAllLayers));
  work_with('a', core::kAllLayers, 1);
  watch::TileQuery query{.job_id = id, .format = v1::TILE_FORMAT_ALL32F, .max_bytes = 1 << 20};
  const auto update = coordinator().tile_feed().update(query);
  ASSERT_TRUE(update) << update.error().message;
  EXPECT_EQ(update->channels, core::image_channels(core::kAllLayers));
  ASSERT_FALSE(update->tiles.empty());
  for (const v1::TileImage& tile : update->tiles) {
    const auto rect = *proto::from_proto(tile.rect());
    core::Film alone(core::TileGrid(rect, core::kTilePx), core::kAllLayers);
    alone.add(layered_tile(rect, {0, tile.samples()}));
    std::vector<float> expected(rect.pixel_count() * update->channels.size());
    core::develop_layers(core::kAllLayers, rect, alone.tile(0), expected);
    const auto values = view::decode_channels(tile.pixels_zlib(), expected.size());
    ASSERT_TRUE(values) << values.error().message;
    EXPECT_EQ(std::memcmp(values->data(), expected.data(), expected.size() * sizeof(float)), 0);
    EXPECT_FALSE(view::decode_channels(tile.pixels_zlib(), expected.size() + 1));
  }
  query.layer = Layer::kDepth;
  EXPECT_THAT(coordinator().tile_feed().update(query).error().message, HasSubstr("layer: must be empty"));
}

// A result that is refused counts for nothing, and against its worker.
class ForgedLayersTest : public LayersTest {
 protected:
  // What is said of a result that another worker changes each time: three refusals in a row are a quarantine.
  std::string refusal(LayerSet layers, const std::function<void(v1::RenderedItem&)>& change) {
    last_ = v1::SubmitResultResponse();
    EXPECT_EQ(work_with(worker_++, layers, 1, change), 0);
    EXPECT_FALSE(last_);
    EXPECT_EQ(last_ ? ErrorCode::kInternal : last_.error().code, ErrorCode::kInvalidArgument);
    return last_ ? "" : last_.error().message;
  }
  std::string refusal(const std::function<void(v1::RenderedItem&)>& change) {
    return refusal(core::kAllLayers, change);
  }
  // The same of a change to the first plane of this encoding.
  std::string refusal(core::ChannelEncoding encoding, const std::function<void(core::Plane&)>& change) {
    return refusal([&](v1::RenderedItem& item) {
      auto tile = proto::decode_tile(item, core::kAllLayers);
      ASSERT_TRUE(tile) << tile.error().message;
      const core::FilmLayout layout = core::film_layout(core::kAllLayers);
      std::size_t plane = 0;
      while (layout.plane(plane).encoding != encoding) ++plane;
      change(tile->planes[plane]);
      item = proto::encode_tile(*tile);
    });
  }
  std::uint64_t counted() { return job(id_).samples_done(); }

 private:
  const std::string id_ = submit(submission_with(core::kAllLayers));
  char worker_ = 'a';
};

TEST_F(ForgedLayersTest, OfWrongSizesAreRefused) {
  EXPECT_THAT(refusal(LayerSet(), [](auto&) {}), HasSubstr("plane_words: it has 0 planes of layers"));
  EXPECT_THAT(refusal([](auto& item) { item.mutable_plane_words()->RemoveLast(); }),
              HasSubstr("plane_words: it has"));
  EXPECT_THAT(refusal([](auto& item) { item.set_plane_words(0, 0xffffffff); }), HasSubstr("64 MiB of words"));
  EXPECT_THAT(refusal([](auto& item) { item.set_plane_words(0, 5); }), HasSubstr("has 5 words of"));
  EXPECT_EQ(counted(), 0u);
}

TEST_F(ForgedLayersTest, OfImpossibleSumsAreRefused) {
  EXPECT_THAT(refusal([](auto& item) { item.set_sums_xxh3(item.sums_xxh3() + 1); }), HasSubstr("sums_xxh3"));
  EXPECT_THAT(refusal(core::ChannelEncoding::kCount, [](auto& plane) { plane[3] = 1000; }),
              HasSubstr("has a sum that no samples have"));
  EXPECT_THAT(refusal(core::ChannelEncoding::kIds, [](auto& plane) { std::swap(plane[0], plane[2]); }),
              HasSubstr("its entries are not sorted"));
  EXPECT_EQ(counted(), 0u);
}

TEST_F(LayersTest, OfAJobThatIsGoneAreDroppedUnread) {
  const std::string id = submit(submission_with(core::kAllLayers));
  const WaitingCall call(coordinator(), greeting('a'));
  v1::SubmitResultRequest request = delivery('a', call.answer()->leases(0));
  for (v1::RenderedItem& item : *request.mutable_items()) {
    item = item_of(v1::WorkItem(item.item()), core::kAllLayers);
    item.set_planes_zstd("nonsense");
  }
  ASSERT_TRUE(coordinator().jobs().remove(id));
  const auto dropped = coordinator().dispatcher().submit_result(request);
  ASSERT_TRUE(dropped) << dropped.error().message;
  EXPECT_EQ(dropped->dropped_items(), static_cast<std::uint32_t>(request.items_size()));
}

TEST_F(LayersTest, ThatAreUnknownAreRefused) {
  v1::SubmitJobRequest request = submission();
  request.mutable_overrides()->mutable_layers()->add_names("albedos");
  EXPECT_THAT(proto::from_proto(request.overrides()).error().message, HasSubstr("layers: must be of alpha"));
  request.mutable_overrides()->mutable_layers()->set_names(0, "all");
  EXPECT_FALSE(proto::from_proto(request.overrides()));
  for (int i = 0; i < 100; ++i) request.mutable_overrides()->mutable_layers()->add_names("albedo");
  EXPECT_THAT(proto::from_proto(request.overrides()).error().message,
              HasSubstr("layers: there are at most 51, got 101"));
}

core::FilmTile part(core::SampleRange range) {
  return layered_tile({64, 64, 128, 100}, range);
}

// Planes of minima have no part in it.
TEST(LayerFingerprint, PartsAddUpToTheWhole) {
  const film::Fingerprinter fingerprinter({1, 2});
  scheduler::Fingerprint parts = fingerprinter.of(part({3, 4}));
  parts.add(fingerprinter.of(part({4, 9})));
  parts.add(fingerprinter.of(part({9, 17})));
  const scheduler::Fingerprint whole = fingerprinter.of(part({3, 17}));
  EXPECT_TRUE(parts.low == whole.low && parts.high == whole.high);
  EXPECT_GE(parts.largest, whole.largest);
}

TEST(LayerFingerprint, EachPlaneCounts) {
  const film::Fingerprinter fingerprinter({1, 2});
  const core::FilmTile tile = part({0, 4});
  const scheduler::Fingerprint right = fingerprinter.of(tile);
  const core::FilmLayout layout = core::film_layout(core::kAllLayers);
  for (std::size_t i = 0; i < tile.planes.size(); ++i) {
    if (layout.plane(i).encoding == core::ChannelEncoding::kNearest) continue;
    core::FilmTile wrong = tile;
    ASSERT_FALSE(wrong.planes[i].empty()) << layout.plane(i).name;
    wrong.planes[i][1] ^= 1;
    EXPECT_FALSE(same_sums(right, fingerprinter.of(wrong))) << layout.plane(i).name;
  }
  core::FilmTile swapped = tile;
  std::swap(swapped.planes[0], swapped.planes[1]);
  EXPECT_FALSE(same_sums(right, fingerprinter.of(swapped)));
}

// What two workers found in other parts of the samples cannot be compared then.
TEST(LayerFingerprint, MarksPixelsThatMayLackIds) {
  core::FilmTile tile = ready_made_tile({0, 0, 2, 1}, {0, 100});
  tile.layers = LayerSet{}.with(Layer::kCryptoObject);
  core::IdCounter ids(tile.rect);
  for (std::uint32_t id = 1; id < core::kMaxIdsPerPixel; ++id) ids.add(1, id);
  tile.planes = {ids.take()};
  const film::Fingerprinter fingerprinter({1, 2});
  EXPECT_FALSE(std::isinf(fingerprinter.of(tile).largest));
  for (std::uint32_t id = 1; id <= core::kMaxIdsPerPixel; ++id) ids.add(1, id);
  tile.planes = {ids.take()};
  EXPECT_TRUE(std::isinf(fingerprinter.of(tile).largest));
}

}  // namespace
}  // namespace tessera::server
