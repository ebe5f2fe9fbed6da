// SPDX-License-Identifier: Apache-2.0
// Jobs of several images, and tiles with sample targets of their own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "proto/convert.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;
using testing::IsEmpty;

const core::PixelRect kWholeImage{0, 0, kWidthPx, kHeightPx};

v1::SubmitJobRequest submission_of(const std::vector<int>& frames) {
  v1::SubmitJobRequest request = submission();
  request.mutable_frames()->Add(frames.begin(), frames.end());
  return request;
}

class JobImages : public ScriptedFarm {
 protected:
  void expect_image(const std::string& id, int image, std::uint32_t spp = kSpp) {
    const auto made = coordinator().images().get(id, image);
    ASSERT_TRUE(made) << made.error().message;
    const auto index = static_cast<std::uint32_t>(image);
    EXPECT_EQ(made->image.pixels, ready_made_image(kWholeImage, spp, index).pixels) << "image " << image;
  }
  void crash() {
    const auto crashed = folder_.path() / "crashed";
    std::filesystem::copy(folder_.path() / "state", crashed, std::filesystem::copy_options::recursive);
    open(crashed);
  }
  // Raises the target of a tile alone.
  core::Result<v1::Job> raise(const std::string& id, std::uint32_t image, const core::PixelRect& rect,
                              std::uint32_t spp) {
    v1::ExtendJobRequest request;
    request.set_job_id(id);
    v1::TileTarget& tile = *request.add_tiles();
    tile.set_image(image);
    *tile.mutable_rect() = proto::to_proto(rect);
    tile.set_spp(spp);
    return coordinator().jobs().extend(request);
  }
  core::Error refusal_of_image(v1::GetImageRequest request) {
    request.set_format(v1::IMAGE_FORMAT_PFM);
    const auto written = coordinator().images().write(request);
    EXPECT_FALSE(written);
    return written ? core::Error{} : written.error();
  }
  watch::TileUpdate tiles(const std::string& id, std::uint32_t image) {
    const auto update =
        coordinator().tile_feed().update({id, 0, v1::TILE_FORMAT_RGB32F, {}, std::size_t{1} << 30, image});
    EXPECT_TRUE(update) << update.error().message;
    return update ? *update : watch::TileUpdate();
  }
};

TEST_F(JobImages, HaveSamplesOfTheirOwn) {
  const std::string id = submit(submission_of({10, 12, 7}));
  EXPECT_EQ(job(id).image_count(), 3u);
  EXPECT_EQ(job(id).samples_total(), 3 * kSamples);
  work('a');
  const v1::Job done = stored_job(id);
  EXPECT_EQ(done.state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(done.samples_done(), 3 * kSamples);
  ASSERT_EQ(done.images_size(), 3);
  const int frames[] = {10, 12, 7};
  for (int image = 0; image < 3; ++image) {
    expect_image(id, image);
    EXPECT_EQ(done.images(image).frame(), frames[image]);
    EXPECT_EQ(done.images(image).samples_done(), kSamples);
    EXPECT_EQ(done.images(image).samples_total(), kSamples);
  }
}

// Frames are images of one job: its scene is stored once.
TEST_F(JobImages, ShareTheFilesOfTheScene) {
  std::vector<int> turn(12);
  for (std::size_t i = 0; i < turn.size(); ++i) turn[i] = static_cast<int>(i) + 1;
  const auto files_in = [](const std::filesystem::path& folder) {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      count += entry.is_regular_file();
    return count;
  };
  std::vector<std::int32_t> checked;
  check_scene_ = [&](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                     const std::vector<std::int32_t>& frames, const std::stop_token&) {
    checked = frames;
    return accept_scene(bundle, overrides);
  };
  open();
  const std::string id = submit(submission_of(turn));
  EXPECT_EQ(job(id).image_count(), 12u);
  EXPECT_EQ(job(id).bundle().assets_size(), 1);
  EXPECT_EQ(files_in(folder_.path() / "state" / "blobs"), 1u);
  EXPECT_EQ(checked, std::vector<std::int32_t>(turn.begin(), turn.end()));
}

TEST_F(JobImages, AreRenderedInTheirOrder) {
  const std::string id = submit(submission_of({1, 2}));
  work('a', 1);
  while (job(id).images(1).samples_done() == 0) work('a', 1);
  EXPECT_GT(job(id).images(0).samples_done(), kSamples - kSamples / 2);
  EXPECT_EQ(job(id).images(0).samples_done() + job(id).images(1).samples_done(), job(id).samples_done());
}

TEST_F(JobImages, SurviveACrashAndARestart) {
  const std::string id = submit(submission_of({1, 2}));
  while (job(id).images(1).samples_done() == 0) work('a', 1);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  const v1::Job before = job(id);
  crash();
  for (int image = 0; image < 2; ++image)
    EXPECT_EQ(job(id).images(image).SerializeAsString(), before.images(image).SerializeAsString());
  work('b');
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  open(folder_.path() / "crashed");
  for (int image = 0; image < 2; ++image) {
    expect_image(id, image);
    EXPECT_EQ(job(id).images(image).frame(), image + 1);
  }
}

TEST_F(JobImages, OfACancelledJobAreKnownBySamplesAlsoWhenTheStoreAloneHasIt) {
  const std::string id = submit(submission_of({1, 2}));
  work('a', 1);
  ASSERT_TRUE(coordinator().jobs().cancel(id));
  const v1::Job cancelled = stored_job(id);
  EXPECT_GT(cancelled.images(0).samples_done(), 0u);
  EXPECT_EQ(cancelled.images(0).samples_done() + cancelled.images(1).samples_done(),
            cancelled.samples_done());
}

TEST_F(JobImages, AreExtendedTogether) {
  const std::string id = submit(submission_of({1, 2}));
  work('a');
  ASSERT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  ASSERT_TRUE(coordinator().jobs().extend(id, kSpp + 3));
  work('a');
  ASSERT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  for (int image = 0; image < 2; ++image) expect_image(id, image, kSpp + 3);
}

TEST_F(JobImages, AreWatchedOneByOne) {
  const std::string id = submit(submission_of({1, 2}));
  while (job(id).images(1).samples_done() == 0) work('a', 1);
  for (const bool is_stored : {false, true}) {
    if (is_stored) work('a');
    if (is_stored) ASSERT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
    for (const std::uint32_t image : {0u, 1u}) {
      const watch::TileUpdate update = tiles(id, image);
      EXPECT_FALSE(update.tiles.empty());
      for (const v1::TileImage& tile : update.tiles) EXPECT_EQ(tile.image(), image);
    }
    EXPECT_EQ(tiles(id, 0).tiles.size(), 6u);
  }
  EXPECT_EQ(tiles(id, 1).tiles.size(), 6u);
  const auto third =
      coordinator().tile_feed().update({id, 0, v1::TILE_FORMAT_RGB32F, {}, std::size_t{1} << 30, 2});
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().code, ErrorCode::kInvalidArgument);
}

TEST_F(JobImages, AndChannelsThatAJobDoesNotHaveAreRefused) {
  const std::string id = submit(submission_of({1, 2}));
  v1::GetImageRequest request;
  request.set_job_id(id);
  request.set_image(2);
  EXPECT_EQ(refusal_of_image(request).message,
            "image: must be below 2, the number of the job's images, got 2");
  request.set_image(1);
  request.add_channels("Z");
  EXPECT_EQ(refusal_of_image(request).code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(refusal_of_image(request).message, HasSubstr("channels: must be R, G, B"));
  request.clear_channels();
  for (const char* const channel : {"R", "G", "B"}) request.add_channels(channel);
  request.set_format(v1::IMAGE_FORMAT_PFM);
  EXPECT_TRUE(coordinator().images().write(request));
}

// Its results would count for the first image.
TEST_F(JobImages, AreNotLeasedToAWorkerThatDoesNotNameThem) {
  submit(submission_of({1, 2}));
  v1::SynchronizeRequest old = greeting('e');
  old.set_names_images(false);
  const WaitingCall call(coordinator(), old);
  EXPECT_FALSE(call.answered());
  const std::string of_one = submit();
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer()->leases(0).job_id(), of_one);
}

TEST_F(JobImages, AreDescribedToWorkers) {
  submit(submission_of({4, 5}));
  const v1::SynchronizeResponse response = synchronize(greeting('a'));
  ASSERT_EQ(response.jobs(0).images_size(), 2);
  EXPECT_EQ(response.jobs(0).images(1).frame(), 5);
}

TEST_F(JobImages, AreLimitedInNumberAndMustDiffer) {
  limits_.images = 2;
  open();
  EXPECT_TRUE(coordinator().jobs().submit(submission_of({1, 2})));
  EXPECT_EQ(refusal(submission_of({1, 2, 3})).message,
            "the job has 3 images, and this farm takes at most 2 (tessera-coordinator --max-images)");
  EXPECT_EQ(refusal(submission_of({1, 1})).message, "frames: 1 is named twice");
}

TEST_F(JobImages, AllCountTowardTheMemoryOfFilms) {
  limits_.film_gib = 0.0625;  // for 65,536 tiles
  open();
  EXPECT_EQ(job(submit(submission_of({1}))).state(), v1::JOB_STATE_RUNNING);
  limits_.images = 20'000;
  open();
  std::vector<int> frames(11'000);
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i] = static_cast<int>(i);
  EXPECT_THAT(refusal(submission_of(frames)).message, HasSubstr("this one with 11000 images of 150 x 100"));
}

TEST_F(JobImages, AreIdleForAWorkerWhoseResultNamesAnImageThatThereIsNot) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  v1::SubmitResultRequest result = delivery('a', lease);
  result.mutable_items(0)->mutable_item()->set_image(1);
  const auto counted = coordinator().dispatcher().submit_result(result);
  ASSERT_FALSE(counted);
  EXPECT_EQ(counted.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(job(id).samples_done(), 0u);
}

class TileTargets : public JobImages {};

TEST_F(TileTargets, AreReachedByTheirTilesAlone) {
  const std::string id = submit(submission_of({1, 2}));
  const core::PixelRect tile{64, 0, 128, 64};
  ASSERT_TRUE(raise(id, 1, tile, kSpp + 4));
  EXPECT_EQ(job(id).samples_total(), 2 * kSamples + 64 * 64 * 4);
  EXPECT_EQ(job(id).images(1).samples_total(), kSamples + 64 * 64 * 4);
  work('a');
  const v1::Job done = stored_job(id);
  EXPECT_EQ(done.state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(done.samples_done(), 2 * kSamples + 64 * 64 * 4);
  EXPECT_EQ(done.settings().spp(), kSpp);
  expect_image(id, 0);
  for (const v1::TileImage& image : tiles(id, 1).tiles) {
    const bool is_raised = *proto::from_proto(image.rect()) == tile;
    EXPECT_EQ(image.samples(), is_raised ? kSpp + 4 : kSpp);
    EXPECT_EQ(image.samples_target(), image.samples());
  }
}

TEST_F(TileTargets, SurviveACrashAndAreThoseOfAFinishedJob) {
  const std::string id = submit();
  ASSERT_TRUE(raise(id, 0, {0, 0, 64, 64}, kSpp + 2));
  crash();
  EXPECT_EQ(job(id).samples_total(), kSamples + 64 * 64 * 2);
  work('a');
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  open(folder_.path() / "crashed");
  EXPECT_EQ(job(id).samples_total(), kSamples + 64 * 64 * 2);
  EXPECT_EQ(raise(id, 0, {0, 0, 64, 64}, kSpp + 2)->state(), v1::JOB_STATE_DONE) << "it has these";
  EXPECT_EQ(raise(id, 0, {0, 0, 64, 64}, kSpp + 3)->state(), v1::JOB_STATE_RUNNING);
  work('a');
  EXPECT_EQ(stored_job(id).samples_done(), kSamples + 64 * 64 * 3);
  EXPECT_TRUE(coordinator().images().get(id));
}

TEST_F(TileTargets, OfOtherRectanglesOrImagesAreRefused) {
  const std::string id = submit();
  for (const core::PixelRect& rect : {core::PixelRect{0, 0, 63, 64}, {0, 0, 64, 65}, {150, 0, 214, 64}})
    EXPECT_EQ(raise(id, 0, rect, kSpp + 2).error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(raise(id, 1, {0, 0, 64, 64}, kSpp + 2).error().message, HasSubstr("tiles[0]"));
  limits_.spp = kSpp + 1;
  open();
  EXPECT_EQ(raise(id, 0, {0, 0, 64, 64}, kSpp + 2).error().code, ErrorCode::kResourceExhausted);
}

}  // namespace
}  // namespace tessera::server
