// SPDX-License-Identifier: Apache-2.0
#include "proto/json.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "proto/blob.hpp"
#include "proto/state_text.hpp"

namespace tessera::proto {
namespace {

v1::Job running_job() {
  v1::Job job;
  job.set_id("0123");
  job.set_name("vase");
  job.set_state(v1::JOB_STATE_RUNNING);
  job.mutable_settings()->set_width_px(640);
  job.mutable_settings()->set_height_px(480);
  job.mutable_settings()->set_integrator(v1::INTEGRATOR_MIS);
  job.mutable_settings()->set_clamp_indirect(0.1f);
  job.mutable_settings()->set_seed(std::numeric_limits<std::uint64_t>::max());
  job.set_samples_total(1000);
  job.set_samples_done(400);
  job.set_samples_per_second(100);
  job.mutable_created_at()->set_seconds(1'700'000'000);
  return job;
}

TEST(Json, AJobHasNamesOfSceneFilesAndNumbers) {
  const auto json = to_json(running_job());
  EXPECT_EQ(json["state"], "running");
  EXPECT_EQ(json["integrator"], "mis");
  EXPECT_EQ(json["heuristic"], "balance");
  EXPECT_EQ(json["filter"], "box");
  EXPECT_EQ(json["tone_curve"], "none");
  EXPECT_EQ(json["seed"], std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(json["clamp_indirect"].dump(), "0.1");
  EXPECT_EQ(json["created_at"], "2023-11-14T22:13:20Z");
  EXPECT_EQ(json["seconds_left"], 6.0);
  EXPECT_EQ(json["image_count"], 1);
  EXPECT_FALSE(json.contains("images"));
  for (const char* absent : {"crop", "finished_at", "failure", "queue_position", "waiting_reason"})
    EXPECT_TRUE(json.at(absent).is_null()) << absent;
  EXPECT_TRUE(json["labels"].is_object());
  EXPECT_FALSE(json.contains("files")) << "a list has no bundles";
  EXPECT_FALSE(json.contains("events"));
}

TEST(Json, AJobTellsWhatHasHappenedToIt) {
  v1::Job job = running_job();
  job.add_events()->set_kind(v1::JobEvent::KIND_STARTED);
  job.mutable_events(0)->mutable_at()->set_seconds(1'700'000'000);
  EXPECT_EQ(to_json(job)["events"].dump(), R"([{"at":"2023-11-14T22:13:20Z","kind":"started"}])");
}

TEST(Json, AJobListsItsImages) {
  v1::Job job = running_job();
  job.set_image_count(2);
  job.add_images()->set_frame(10);
  v1::Image& second = *job.add_images();
  second.set_frame(12);
  second.set_name("<b>");
  second.set_samples_total(500);
  second.set_samples_done(100);
  const auto json = to_json(job);
  EXPECT_EQ(json["image_count"], 2);
  EXPECT_EQ(json["images"][0]["frame"], 10);
  EXPECT_EQ(json["images"][1]["name"], "<b>");
  EXPECT_EQ(json["images"][1]["samples_total"], 500);
  EXPECT_EQ(json["images"][1]["samples_done"], 100);
}

TEST(Json, AJobWithItsBundleNamesItsFiles) {
  v1::Job job = running_job();
  job.mutable_bundle()->set_scene_path("scene.json");
  auto& asset = *job.mutable_bundle()->add_assets();
  asset.set_path("scene.json");
  *asset.mutable_digest() = to_proto(digest_of("abc"));
  const auto json = to_json(job);
  EXPECT_EQ(json["scene"], "scene.json");
  EXPECT_EQ(json["files"][0]["sha256"], "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(json["files"][0]["bytes"], 3);
}

TEST(Json, AFailureSaysWhy) {
  v1::Job job = running_job();
  job.set_state(v1::JOB_STATE_FAILED);
  job.set_failure("no such mesh");
  job.mutable_failure_details()->set_reason(v1::Failure::REASON_INVALID_SCENE);
  const auto json = to_json(job);
  EXPECT_EQ(json["failure"]["reason"], "invalid_scene");
  EXPECT_EQ(json["failure"]["message"], "no such mesh");
  EXPECT_TRUE(json["seconds_left"].is_null());
}

// Times come from others: a coordinator, or a worker's clock.
TEST(Json, TimesThatCannotBeExpressedAreNull) {
  v1::Job job = running_job();
  job.mutable_created_at()->set_seconds(std::numeric_limits<std::int64_t>::max());
  EXPECT_TRUE(to_json(job)["created_at"].is_null());
}

TEST(Json, TheStateOfAWorkerIsTheFirstThatApplies) {
  v1::Worker worker;
  EXPECT_EQ(worker_state(worker), "idle");
  worker.set_held_leases(1);
  EXPECT_EQ(worker_state(worker), "working");
  worker.add_cooldowns()->set_fetching(true);
  EXPECT_EQ(worker_state(worker), "fetching");
  worker.add_cooldowns();
  EXPECT_EQ(worker_state(worker), "in cooldown");
  worker.set_silent(true);
  EXPECT_EQ(to_json(worker)["state"], "silent");
}

TEST(Json, AWorkerTellsHowFullItsCacheIs) {
  v1::Worker worker;
  EXPECT_TRUE(to_json(worker).at("cache").is_null());
  worker.mutable_cache()->set_used_bytes(1000);
  worker.mutable_cache()->set_limit_bytes(5000);
  EXPECT_EQ(to_json(worker)["cache"].dump(), R"({"used_bytes":1000,"limit_bytes":5000})");
}

TEST(Json, AnErrorHasItsDetails) {
  const Digest digest = digest_of("abc");
  const core::Error error = core::Error{core::ErrorCode::kFailedPrecondition, "blobs are missing"}.with(
      {.reason = "MISSING_BLOBS", .missing = {blob_name(digest), "other"}});
  const auto json = error_to_json(error);
  EXPECT_EQ(json["code"], "FAILED_PRECONDITION");
  EXPECT_EQ(json["reason"], "MISSING_BLOBS");
  EXPECT_EQ(json["missing"][0], digest.hex());
  EXPECT_EQ(json["missing"][1], "other");
  EXPECT_FALSE(json.contains("field"));
}

TEST(Json, ALineControlsNoTerminal) {
  v1::Job job = running_job();
  job.set_name("a\n\033[31m\xc2\x9b\xff");
  const std::string line = to_line(to_json(job));
  for (const char c : line) EXPECT_TRUE(c >= ' ' && c < 127);
}

}  // namespace
}  // namespace tessera::proto
