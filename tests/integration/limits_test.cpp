// SPDX-License-Identifier: Apache-2.0
// Limits and hostile scenes with real processes: each is rejected with a message, and the coordinator keeps
// running.
#include <gmock/gmock.h>
#include <grpcpp/client_context.h>
#include <signal.h>

#include <future>

#include "core/image/encode.hpp"
#include "proto/blob.hpp"
#include "tests/integration/farm_processes.hpp"
#include "tests/support/hostile_images.hpp"

namespace tessera::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Files = std::map<std::string, std::string>;

constexpr const char* kScene = R"({
  "render": {"width": 16, "height": 16, "spp": 2},
  "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
  "textures": {"paint": {"file": "paint.png"}},
  "materials": {"wall": {"type": "lambert", "albedo": {"texture": "paint"}}},
  "shapes": [{"type": "mesh", "file": "mesh.obj", "material": "wall"}]
})";

std::string png_of_size(int side_px) {
  return *core::encode_image(core::Image(side_px, side_px), core::ImageFormat::kPng);
}

const Files& small_scene() {
  static const Files files{{"scene.json", kScene},
                           {"mesh.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1 4/1\n"},
                           {"paint.png", png_of_size(8)}};
  return files;
}

Files with(const std::string& name, const std::string& bytes) {
  Files files = small_scene();
  files[name] = bytes;
  return files;
}

// Its wall is a light.
std::string lit_scene() {
  std::string scene = kScene;
  const std::string albedo = R"("albedo": {"texture": "paint"})";
  return scene.replace(scene.find(albedo), albedo.size(), albedo + R"(, "emission": 1)");
}

class LimitsTest : public FarmTest {
 protected:
  void start(const std::vector<std::string>& options) {
    coordinator_options_ = options;
    start_coordinator();
  }

  grpc::Status upload(const std::string& bytes) {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    const auto stream = api().UploadBlob(&context, &response);
    proto::for_each_chunk(proto::digest_of(bytes), bytes, [&](const v1::BlobChunk& chunk) {
      v1::UploadBlobRequest request;
      *request.mutable_chunk() = chunk;
      return stream->Write(request);
    });
    stream->WritesDone();
    return stream->Finish();
  }
  // Bypasses the command line, which would reject much of this itself.
  grpc::Status submit_files(const Files& files) {
    v1::SubmitJobRequest request;
    request.mutable_bundle()->set_scene_path("scene.json");
    for (const auto& [name, bytes] : files) {
      if (const grpc::Status uploaded = upload(bytes); !uploaded.ok()) return uploaded;
      v1::Bundle::Asset& asset = *request.mutable_bundle()->add_assets();
      asset.set_path(name);
      *asset.mutable_digest() = proto::to_proto(proto::digest_of(bytes));
    }
    return submit_and_validate(request);
  }
  void expect_well() {
    const grpc::Status status = submit_files(small_scene());
    EXPECT_TRUE(status.ok()) << status.error_message();
  }

  // A stand-in for the validator: crashes or loops for scenes that say so, and passes others to the real one.
  std::string moody_validator() {
    const std::filesystem::path path = folder_ / "moody";
    write_file(path, "#!/bin/sh\nquestion=$(mktemp " + (folder_ / "question-XXXXXX").string() +
                         ")\ncat > $question\n"
                         "grep -q crash $question && kill -SEGV $$\n"
                         "grep -q spin $question && while :; do :; done\n"
                         "exec " TESSERA_VALIDATOR " \"$@\" < $question\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }
};

struct Excess {
  std::string option, value;
  Files files;
  std::string found;
};

TEST_F(LimitsTest, EachRejectionNamesItsOption) {
  const std::string large(3 << 20, '\n');
  const Excess excesses[] = {
      {"--max-image-pixels", "255", small_scene(), "16 x 16 = 256 pixels"},
      {"--max-spp", "1", small_scene(), "2 samples per pixel"},
      {"--max-blob-mib", "2", with("mesh.obj", large), "3145728 bytes"},
      {"--max-triangles", "1", small_scene(), "mesh.obj:6: the file has more than the 1 triangles"},
      {"--max-lights", "1", with("scene.json", lit_scene()), "the scene has 2 lights"},
      {"--max-texture-pixels", "63", small_scene(), "8 x 8 = 64 pixels"},
      {"--max-texture-pixels", "1000", with("paint.png", png_header(30000, 30000)), "= 900000000 pixels"},
      {"--max-scene-texture-pixels", "63", small_scene(), "64 pixels"},
      {"--max-store-mib", "1", with("mesh.obj", large), "3145728 more would be too many"},
      {"--max-bundle-files", "2", small_scene(), "assets: there are more than 2"},
      {"--max-bundle-mib", "2", with("mesh.obj", large), "the 3 files of the bundle have"},
  };
  for (const Excess& excess : excesses) {
    SCOPED_TRACE(excess.option);
    start({excess.option, excess.value});
    const grpc::Status status = submit_files(excess.files);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_THAT(status.error_message(),
                AllOf(HasSubstr(excess.found), HasSubstr("(tessera-coordinator " + excess.option + ")")));
    EXPECT_EQ(sound_jobs(), 0u);
    stop_coordinator();
  }
}

TEST_F(LimitsTest, PixelsOfAnImageKeepTheirFormerName) {
  start({"--max-picture-pixels", "255"});
  const grpc::Status status = submit_files(small_scene());
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("(tessera-coordinator --max-image-pixels)"));
}

TEST_F(LimitsTest, OfStreamsAreOptionsToo) {
  start({"--max-uploads", "1", "--stall-seconds", "5", "--max-image-mib", "1"});
  grpc::ClientContext context;
  v1::UploadBlobResponse response;
  const auto still = api().UploadBlob(&context, &response);
  v1::UploadBlobRequest request;
  *request.mutable_chunk()->mutable_digest() = proto::to_proto(proto::digest_of("never sent"));
  still->Write(request);
  EXPECT_TRUE(poll_until(std::chrono::seconds(20), [this] {
    return !std::filesystem::is_empty(folder_ / "state" / "blobs" / "incoming");
  }));
  EXPECT_THAT(still->Finish().error_message(),
              HasSubstr("no data of this upload has arrived for 5 s (tessera-coordinator --stall-seconds)"));
  EXPECT_TRUE(poll_until(std::chrono::seconds(20), [this] { return upload("small").ok(); }));
  const std::string id = submit({"--spp", "1"});
  EXPECT_EQ(tessera({"image", id, "-o", folder_ / "a.png", "-o", folder_ / "b.png"}).exit_code, 0);
}

TEST_F(LimitsTest, OfOpenJobsAreReportedByTheCommandLine) {
  start({"--max-open-jobs", "1"});
  const std::string id = submit({"--spp", "1"});
  const Outcome second = tessera({"submit", kCornell});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.err,
              HasSubstr("there are 1 unfinished jobs already, and this farm takes at most 1 of all "
                        "together (tessera-coordinator --max-open-jobs)"));
  EXPECT_EQ(tessera({"cancel", id}).exit_code, 0);
  submit({"--spp", "1"});
}

TEST_F(LimitsTest, OfConnectionsAreReportedAndRetried) {
  start({"--max-connections", "2"});
  const std::vector<std::string> options{"--size", "64x64", "--spp", "64"};
  const std::string id = submit(options);
  EXPECT_EQ(jobs().size(), 1u);  // this test's own connection
  const auto is_in = [](const Process& worker) {
    return poll_until(std::chrono::seconds(60), [&] {
      return worker.err().find("registered with the coordinator") != std::string::npos;
    });
  };
  Process& first = start_worker("first", 1);
  ASSERT_TRUE(is_in(first));
  const Outcome refused = tessera({"jobs"});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("has as many as it takes (tessera-coordinator --max-connections,"));
  Process& second = start_worker("second", 1);
  const auto says_closed = [&] {
    return coordinator().err().find("closed a connection of 127.0.0.1: there are 2") != std::string::npos;
  };
  EXPECT_TRUE(poll_until(std::chrono::seconds(60), says_closed));
  EXPECT_EQ(workers().size(), 1u);
  first.signal(SIGKILL);
  EXPECT_TRUE(is_in(second));
  EXPECT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  second.signal(SIGTERM);
  EXPECT_EQ(second.wait(std::chrono::seconds(60)), 0);
  EXPECT_TRUE(poll_until(std::chrono::seconds(60), [&] { return tessera({"jobs"}).exit_code == 0; }));
  EXPECT_TRUE(image(id, ".exr") == render_here(options, ".exr"));
}

TEST_F(LimitsTest, HostileScenesAffectNoOther) {
  start({"--validator", moody_validator(), "--validator-seconds", "3"});
  const struct {
    Files files;
    grpc::StatusCode code;
    std::string sentence;
  } hostile[] = {
      {with("scene.json", std::string(1'000'000, '[')), grpc::StatusCode::INVALID_ARGUMENT, "nested"},
      {with("crash", "crash"), grpc::StatusCode::INVALID_ARGUMENT, "the validator ended by signal 11"},
      {with("spin", "spin"), grpc::StatusCode::RESOURCE_EXHAUSTED,
       "could not be validated within 3 s, which is all that this farm takes for one (tessera-coordinator "
       "--validator-seconds)"},
  };
  for (const auto& scene : hostile) {
    const grpc::Status status = submit_files(scene.files);
    EXPECT_EQ(status.error_code(), scene.code);
    EXPECT_THAT(status.error_message(), HasSubstr(scene.sentence));
    expect_well();
  }
  EXPECT_EQ(sound_jobs(), std::size(hostile));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "state" / "blobs" / "incoming"));
}

TEST_F(LimitsTest, AStoppingCoordinatorDoesNotWaitForScenes) {
  start({"--validator", moody_validator(), "--validations", "1"});
  std::vector<std::future<grpc::Status>> submissions;
  for (int i = 0; i < 6; ++i)
    submissions.push_back(
        std::async(std::launch::async, [this, i] { return submit_files(with("spin", std::to_string(i))); }));
  const auto spins = [this] {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      if (entry.path().filename().string().starts_with("question")) return true;
    return false;
  };
  EXPECT_TRUE(poll_until(std::chrono::seconds(60), spins));
  stop_coordinator();
  for (auto& submission : submissions) EXPECT_FALSE(submission.get().ok());
}

}  // namespace
}  // namespace tessera::test
