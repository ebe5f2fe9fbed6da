// SPDX-License-Identifier: Apache-2.0
// The validator process: its answers, and those for its failures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "core/sandbox/confinement.hpp"
#include "proto/blob.hpp"
#include "server/validator/validator_process.hpp"
#include "tests/support/hostile_images.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::validator {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

class Validator : public testing::Test {
 protected:
  void add_file(const std::string& path, const std::string& bytes) {
    const proto::Digest digest = proto::digest_of(bytes);
    auto writer = blobs_.write(digest);
    ASSERT_TRUE(writer && writer->append(bytes) && writer->commit());
    v1::Bundle::Asset* asset = bundle_.add_assets();
    asset->set_path(path);
    *asset->mutable_digest() = proto::to_proto(digest);
  }
  void add_scene_file(const std::string& path) {
    add_file(path, read_file(std::filesystem::path(TESSERA_SOURCE_DIR) / "scenes/cornell" / path));
  }

  core::Result<Approval> validate() {
    return validate_scene(options_, blobs_, {bundle_, overrides_, frames_});
  }
  core::Error refusal() {
    const auto approval = validate();
    EXPECT_FALSE(approval);
    return approval ? core::Error{} : approval.error();
  }
  static void expect_too_slow(const core::Error& error, const std::string& limit) {
    EXPECT_EQ(error.code, ErrorCode::kResourceExhausted);
    EXPECT_THAT(error.message, HasSubstr("could not be validated within " + limit));
    EXPECT_THAT(error.message, HasSubstr("(tessera-coordinator --validator-seconds)"));
  }
  void add_scene_with(const std::string& mesh) {
    add_file("scene.json", R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
      "materials": {"m": {"type": "lambert"}},
      "shapes": [{"type": "mesh", "material": "m", "file": ")" +
                               mesh + "\"}]}");
  }
  // Replaces the validator by a shell script.
  void replace_validator(const std::string& script) {
    const auto path = folder_.path() / "stand-in";
    write_file(path, "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    options_.path = path;
  }

  TemporaryFolder folder_;
  blobs::BlobStore blobs_ = *blobs::BlobStore::open(folder_.path() / "blobs");
  ProcessOptions options_{.path = TESSERA_VALIDATOR, .limits = {.validation_time = std::chrono::minutes(1)}};
  v1::Bundle bundle_ = [] {
    v1::Bundle bundle;
    bundle.set_scene_path("scene.json");
    return bundle;
  }();
  v1::RenderOverrides overrides_;
  std::vector<std::int32_t> frames_;
};

TEST_F(Validator, RefusesFramesThatCannotBeRendered) {
  add_file("scene.json", R"({"camera": {"position": {"keyframes": [{"frame": 0, "value": [0, 0, 4]},
                                                                   {"frame": 8, "value": [0, 0, -4]}]},
                                        "look_at": [0, 0, 0]},
    "materials": {"m": {"type": "lambert"}}, "shapes": [{"type": "sphere", "radius": 1, "material": "m"}]})");
  frames_ = {1, 2, 8};
  EXPECT_TRUE(validate());
  frames_ = {1, 2, 4};
  EXPECT_EQ(refusal().message, "scene.json: frame 4: camera.look_at: must differ from camera.position");
}

TEST_F(Validator, AnswersWithTheSettingsOverridesApplied) {
  add_scene_file("scene.json");
  add_scene_file("box.obj");
  add_scene_file("box.mtl");
  overrides_.set_width_px(77);
  overrides_.set_spp(5);
  overrides_.set_integrator(v1::INTEGRATOR_NEE);
  const auto approval = validate();
  ASSERT_TRUE(approval) << approval.error().message;
  EXPECT_EQ(approval->settings.width_px(), 77u);
  EXPECT_EQ(approval->settings.spp(), 5u);
  EXPECT_EQ(approval->settings.integrator(), v1::INTEGRATOR_NEE);
}

TEST_F(Validator, AnswersWithHowTheSceneIsFilteredAndShown) {
  add_file("scene.json", R"({
    "render": {"filter": "tent", "filter_radius": 1.25},
    "output": {"exposure": -2, "tone_curve": "agx"},
    "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
    "materials": {"lamp": {"type": "lambert", "emission": 1}},
    "shapes": [{"type": "sphere", "radius": 1, "material": "lamp"}]})");
  const auto approval = validate();
  ASSERT_TRUE(approval) << approval.error().message;
  EXPECT_EQ(approval->settings.filter(), v1::PIXEL_FILTER_TENT);
  EXPECT_EQ(approval->settings.filter_radius_px(), 1.25f);
  EXPECT_EQ(approval->display.exposure_stops(), -2);
  EXPECT_EQ(approval->display.tone_curve(), v1::TONE_CURVE_AGX);
}

TEST_F(Validator, RefusesAnOverrideInTheWordsOfALocalRender) {
  add_scene_file("scene.json");
  add_scene_file("box.obj");
  add_scene_file("box.mtl");
  overrides_.set_height_px(0);
  const core::Error error = refusal();
  EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(error.message, HasSubstr("height: must be between 1 and 65536"));
}

TEST_F(Validator, NamesFilesAsTheUserKnowsThem) {
  add_file("scene.json", "{ \"spp\": }");
  const core::Error error = refusal();
  EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(error.message, HasSubstr("scene.json:1"));
  EXPECT_THAT(error.message, Not(HasSubstr(folder_.path().string())));
}

TEST_F(Validator, OpensNothingThatIsNotInTheBundle) {
  add_scene_file("scene.json");
  add_scene_file("box.mtl");
  EXPECT_THAT(refusal().message, HasSubstr("box.obj"));
}

TEST_F(Validator, ACrashOfItIsTheScenesFault) {
  add_file("scene.json", "{}");
  replace_validator("kill -SEGV $$");
  const core::Error error = refusal();
  EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(error.message, HasSubstr("the scene could not be validated: the validator ended by signal 11"));
}

TEST_F(Validator, GarbageFromItIsNoVerdict) {
  add_file("scene.json", "{}");
  replace_validator("echo all is well");
  EXPECT_EQ(refusal().code, ErrorCode::kInvalidArgument);
}

TEST_F(Validator, IsKilledWhenItTakesTooLong) {
  add_file("scene.json", "{}");
  replace_validator("exec /bin/sleep 600");
  options_.limits.validation_time = std::chrono::milliseconds(50);
  expect_too_slow(refusal(), "1 s");
}

TEST_F(Validator, IsEndedByTheKernelWhenItComputesTooLong) {
  add_file("scene.json", "{}");
  replace_validator("kill -XCPU $$");
  expect_too_slow(refusal(), "60 s");
}

TEST_F(Validator, IsToldItsLimits) {
  add_file("scene.json", "{}");
  replace_validator("echo \"$@\" > " + (folder_.path() / "told").string());
  options_.limits = {.triangles = 1,
                     .lights = 7,
                     .texture_pixels = 2,
                     .scene_texture_pixels = 3,
                     .validator_mib = 444,
                     .validation_time = std::chrono::seconds(5)};
  refusal();
  EXPECT_THAT(read_file(folder_.path() / "told"),
              testing::StartsWith("--max-triangles 1 --max-lights 7 --max-texture-pixels 2 "
                                  "--max-scene-texture-pixels 3 "
                                  "--validator-mib 444 --validator-seconds 5 --parent " +
                                  std::to_string(getpid())));
}

TEST_F(Validator, NamesTheLimitOfAScene) {
  add_scene_file("scene.json");
  add_scene_file("box.obj");
  add_scene_file("box.mtl");
  options_.limits.triangles = 1;
  const core::Error error = refusal();
  EXPECT_EQ(error.code, ErrorCode::kResourceExhausted);
  EXPECT_THAT(error.message, HasSubstr("box.obj"));
  EXPECT_THAT(error.message, HasSubstr("(tessera-coordinator --max-triangles)"));
}

TEST_F(Validator, NamesTheLimitOfMemory) {
  if (sandbox::kIsSanitized) GTEST_SKIP() << "sanitizers need addresses without limit";
  add_scene_with("big.obj");
  std::string obj(std::size_t{300} << 20, '\n');
  add_file("big.obj", obj);
  options_.limits.validator_mib = 256;
  const core::Error error = refusal();
  EXPECT_EQ(error.code, ErrorCode::kResourceExhausted);
  EXPECT_THAT(error.message, HasSubstr("does not fit into memory; this farm loads scenes within 256 MiB "
                                       "(tessera-coordinator --validator-mib)"));
}

TEST_F(Validator, UnpacksNoMoreThanAnImageNeeds) {
  add_file("scene.json", R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
    "textures": {"t": {"file": "bomb.png"}}, "materials": {"m": {"type": "lambert", "albedo": {"texture": "t"}}},
    "shapes": [{"type": "sphere", "radius": 1, "material": "m"}]})");
  add_file("bomb.png", png_bomb(1'000'000));  // 258 MB
  const auto approval = validate();
  EXPECT_TRUE(approval) << approval.error().message;
}

TEST_F(Validator, DoesNotFollowAMillionBrackets) {
  add_file("scene.json", std::string(1'000'000, '['));
  const core::Error error = refusal();
  EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(error.message, HasSubstr("nested more than 32 deep"));
}

TEST_F(Validator, LeavesNoFilesBehind) {
  add_file("scene.json", "{}");
  const auto entries = [&] {
    return std::distance(std::filesystem::recursive_directory_iterator(folder_.path()), {});
  };
  const auto before = entries();
  refusal();
  EXPECT_EQ(entries(), before);
}

TEST_F(Validator, IsKilledWhenTheCoordinatorStops) {
  add_file("scene.json", "{}");
  replace_validator("exec /bin/sleep 600");
  std::stop_source stopping;
  options_.stop = stopping.get_token();
  std::jthread stopper([&] { stopping.request_stop(); });
  EXPECT_EQ(refusal().code, ErrorCode::kUnavailable);
  replace_validator("exit 0");
  EXPECT_EQ(refusal().code, ErrorCode::kUnavailable) << "none is started any more";
}

TEST_F(Validator, SaysWhereItShouldBe) {
  add_file("scene.json", "{}");
  options_.path = folder_.path() / "nowhere";
  const core::Error error = refusal();
  EXPECT_EQ(error.code, ErrorCode::kInternal);
  EXPECT_THAT(error.message, HasSubstr(options_.path));
}

TEST(ValidatorProgram, MustBeThere) {
  EXPECT_TRUE(check_validator(TESSERA_VALIDATOR));
  for (const std::string& path : {std::string("/nowhere/tessera-validator"), testing::TempDir()}) {
    const core::Status found = check_validator(path);
    ASSERT_FALSE(found) << path;
    EXPECT_THAT(found.error().message, HasSubstr(path + ": there is no such program"));
    EXPECT_THAT(found.error().message, HasSubstr("--validator"));
  }
  EXPECT_THAT(check_validator("/" + std::string(5000, 'x')).error().message,
              HasSubstr(": File name too long: "));
}

}  // namespace
}  // namespace tessera::validator
