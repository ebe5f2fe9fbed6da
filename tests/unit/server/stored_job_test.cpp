// SPDX-License-Identifier: Apache-2.0
// Jobs as the store keeps them, and as earlier releases kept them.
#include "server/farm/stored_job.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert.hpp"
#include "server/farm/job_record.hpp"
#include "server/store/stored.pb.h"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::farm {
namespace {

v1::Job whole_job() {
  v1::Job job;
  job.set_id("id");
  job.set_name("a name");
  job.set_owner("ann");
  job.mutable_created_at()->set_seconds(1'700'000'000);
  job.set_priority(-3);
  job.set_max_workers(7);
  core::RenderSettings settings;
  settings.width_px = 300;
  settings.height_px = 200;
  settings.spp = 17;
  settings.seed = 0x123456789abcdef;
  settings.integrator = core::Integrator::kWhitted;
  settings.heuristic = core::Heuristic::kPower;
  settings.max_depth = 9;
  settings.clamp_indirect = 2.5f;
  settings.filter = {core::FilterKind::kGaussian, 1.5f};
  settings.crop = core::PixelRect{10, 20, 100, 90};
  *job.mutable_settings() = proto::to_proto(settings);
  job.mutable_display()->set_exposure_stops(-2);
  job.mutable_display()->set_tone_curve(v1::TONE_CURVE_AGX);
  (*job.mutable_labels())["shot"] = "12";
  job.add_warnings("a texture is missing");
  *job.mutable_bundle() = server::submission().bundle();
  return job;
}

TEST(StoredJob, GivesBackWhatWasPutIn) {
  const v1::Job job = whole_job();
  v1::Job read;
  ASSERT_TRUE(decode_spec(encode_spec(job), read));
  ASSERT_TRUE(decode_bundle(encode_bundle(job), read));
  EXPECT_EQ(read.DebugString(), job.DebugString());
}

TEST(StoredJob, GivesBackItsLayers) {
  v1::Job job = whole_job(), read;
  job.mutable_settings()->add_layers("alpha");
  job.mutable_settings()->add_layers("crypto_object");
  job.add_scene_digests("0123");
  v1::TextAttribute& attribute = *job.add_attributes();
  attribute.set_name("cryptomatte/1234567/manifest");
  attribute.set_value("{\"a\xff\":\"12345678\"}");
  const std::string bytes = encode_spec(job);
  ASSERT_TRUE(decode_spec(bytes, read));
  EXPECT_EQ(read.attributes_size() + read.scene_digests_size(), 0) << "lists read the spec alone";
  ASSERT_TRUE(decode_bundle(encode_bundle(job), read));
  EXPECT_EQ(read.DebugString(), job.DebugString());
  // As of a release that knows other layers, or arranges these otherwise.
  stored::v1::Job other;
  ASSERT_TRUE(other.ParseFromString(bytes.substr(1)));
  const auto can_be_read = [&] { return decode_spec("J" + other.SerializeAsString(), read); };
  EXPECT_TRUE(can_be_read());
  other.mutable_settings()->set_layers(0, "motion");
  EXPECT_FALSE(can_be_read());
  other.mutable_settings()->set_layers(0, "depth");
  EXPECT_FALSE(can_be_read());
}

TEST(StoredJob, KeepsTheLayersOfASubmission) {
  v1::SubmitJobRequest submission, read;
  submission.mutable_overrides()->mutable_layers();  // none, instead of the scene's
  ASSERT_TRUE(decode_submission(encode_submission(submission), read));
  EXPECT_TRUE(read.overrides().has_layers());
  submission.mutable_overrides()->mutable_layers()->add_names("uv");
  ASSERT_TRUE(decode_submission(encode_submission(submission), read));
  EXPECT_EQ(read.overrides().layers().names(0), "uv");
  v1::SubmitJobRequest absent;
  ASSERT_TRUE(decode_submission(encode_submission({}), absent));
  EXPECT_FALSE(absent.overrides().has_layers());
}

TEST(StoredJob, GivesBackWhatIsAbsent) {
  v1::Job job, read;
  job.mutable_created_at()->set_seconds(1);
  ASSERT_TRUE(decode_spec(encode_spec(job), read));
  job.mutable_settings();
  EXPECT_EQ(read.DebugString(), job.DebugString());
}

TEST(StoredJob, GivesBackItsImages) {
  v1::Job job = whole_job(), read;
  for (const int frame : {7, -3, 0}) job.add_images()->set_frame(frame);
  job.mutable_images(1)->set_name("a name");
  job.set_image_count(3);
  ASSERT_TRUE(decode_spec(encode_spec(job), read));
  ASSERT_TRUE(decode_bundle(encode_bundle(job), read));
  EXPECT_EQ(read.DebugString(), job.DebugString());
  EXPECT_EQ(grid_of(read).image_count(), 3);
}

TEST(StoredTargets, GiveBackWhatWasPutIn) {
  const scheduler::TileTargets targets({{0, 5}, {7, 1}, {1'000'000, 1 << 20}});
  EXPECT_EQ(decode_targets(encode_targets(targets)), targets);
  EXPECT_EQ(encode_targets({}), "");
  EXPECT_EQ(decode_targets(""), scheduler::TileTargets());
  EXPECT_FALSE(decode_targets("torn"));
}

TEST(StoredSubmission, GivesBackWhatWasPutInAndWhatIsAbsent) {
  v1::SubmitJobRequest whole, empty, read;
  v1::RenderOverrides& overrides = *whole.mutable_overrides();
  overrides.set_width_px(0);
  overrides.set_height_px(200);
  overrides.set_spp(17);
  overrides.set_seed(0x123456789abcdef);
  overrides.set_integrator(v1::INTEGRATOR_NEE);
  overrides.set_heuristic(v1::HEURISTIC_POWER);
  overrides.mutable_crop()->set_x1(7);
  overrides.set_clamp_indirect(0);
  whole.mutable_display()->set_exposure_stops(0);
  whole.mutable_display()->set_tone_curve(v1::TONE_CURVE_AGX);
  empty.mutable_overrides();
  empty.mutable_display();
  for (const v1::SubmitJobRequest* each : {&whole, &empty}) {
    read.Clear();
    ASSERT_TRUE(decode_submission(encode_submission(*each), read));
    EXPECT_EQ(read.DebugString(), each->DebugString());
  }
  EXPECT_FALSE(decode_submission("torn", read));
}

TEST(StoredFailure, GivesBackWhatWasPutIn) {
  const scheduler::FailureDetails whole{
      scheduler::FailureReason::kWorkersLost, scheduler::WorkItem{3, {4, 9}}, {"host-a", "host-b"}};
  EXPECT_EQ(decode_failure(encode_failure(whole)), whole);
  EXPECT_EQ(decode_failure(encode_failure({})), scheduler::FailureDetails{});
  EXPECT_EQ(decode_failure("torn"), scheduler::FailureDetails{});
}

TEST(StoredJob, OfAnEarlierReleaseIsRead) {
  const v1::Job job = whole_job();
  v1::Job read;
  ASSERT_TRUE(decode_spec(job.SerializeAsString(), read));
  EXPECT_EQ(read.DebugString(), job.DebugString());
}

// A later release may store other images.
TEST(StoredJob, WithImagesThatThisReleaseDoesNotKnowIsRefused) {
  v1::Job read;
  stored::v1::Job two;
  ASSERT_TRUE(two.ParseFromString(encode_spec(whole_job()).substr(1)));
  stored::v1::Job depth = two, none = two, other = two;
  two.add_images()->mutable_layout()->add_channels()->set_name("Z");
  depth.mutable_images(0)->mutable_layout()->add_channels()->set_name("Z");
  none.clear_images();
  other.mutable_images(0)->mutable_layout()->mutable_channels(1)->set_encoding(
      stored::v1::ENCODING_UNSPECIFIED);
  for (const stored::v1::Job& job : {two, depth, none, other})
    EXPECT_FALSE(decode_spec("J" + job.SerializeAsString(), read)) << job.DebugString();
  EXPECT_FALSE(decode_spec("J\xff", read));
  EXPECT_FALSE(decode_spec("\xff", read));
}

}  // namespace
}  // namespace tessera::farm
