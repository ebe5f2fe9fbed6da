// SPDX-License-Identifier: Apache-2.0
// Invalid scenes are rejected with the same message by a local render, by the command line, and by the
// coordinator.
#include <gmock/gmock.h>
#include <grpcpp/client_context.h>

#include "proto/blob.hpp"
#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kSmallScene = R"({
  "render": {"width": 16, "height": 16, "spp": 1},
  "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
  "textures": {"paint": {"file": "paint.png"}},
  "materials": {"wall": {"type": "lambert", "albedo": {"texture": "paint"}},
                "lamp": {"type": "lambert", "emission": [1, 1, 1]}},
  "shapes": [{"type": "mesh", "file": "mesh.obj", "material": "wall"},
             {"type": "sphere", "center": [0, 3, 0], "radius": 1, "material": "lamp"}]
})";
constexpr const char* kMesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

// A 1x1 PNG.
std::string paint() {
  return std::string(
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08\6\0\0\0\x1f\x15\xc4\x89\0\0\0\rIDATx\xda\x63\x64\x60"
      "\xf8\x5f"
      "\x0f\0\2\x87\1\x80\xeb\x47\xba\x92\0\0\0\0IEND\xae\x42\x60\x82",
      70);
}

struct BadInput {
  std::string name;
  std::string scene = kSmallScene, mesh = kMesh, texture = paint();
  std::vector<std::string> mentions;  // file, place, field
};

std::vector<BadInput> bad_inputs() {
  return {
      {.name = "NegativeSpp",
       .scene = replaced(kSmallScene, "\"spp\": 1", "\"spp\": -3"),
       .mentions = {"scene.json:2", "spp", "-3"}},
      {.name = "MisspeltKey",
       .scene = replaced(kSmallScene, "\"albedo\"", "\"albdo\""),
       .mentions = {"scene.json:5", "albdo", "albedo"}},
      {.name = "EmptyImage",
       .scene = replaced(kSmallScene, "\"width\": 16", "\"width\": 0"),
       .mentions = {"scene.json:2", "width", "0"}},
      {.name = "TruncatedObj",
       .mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
       .mentions = {"scene.json:7", "mesh.obj: 1 of 1 faces cannot be used", "line 4"}},
      {.name = "CutOffObj", .mesh = "v 0 0 0\nv 1 0 0\nv 0 1", .mentions = {"scene.json:7", "mesh.obj"}},
      {.name = "NanVertices",
       .mesh = replaced(kMesh, "v 1 0 0", "v nan 0 0"),
       .mentions = {"scene.json:7", "mesh.obj: 1 of 1 faces cannot be used", "line 7"}},
      {.name = "TextForTexture",
       .texture = "This is a text file.\n",
       .mentions = {"scene.json:4", "paint.png"}},
      {.name = "NoJson", .scene = "not JSON at all", .mentions = {"scene.json:1"}},
      {.name = "EmptyFile", .scene = "", .mentions = {"scene.json"}},
  };
}

class RefusalsTest : public FarmTest {
 protected:
  RefusalsTest() { std::filesystem::create_directory(scene_folder_); }

  void write_scene(const BadInput& input) {
    write_file(scene_folder_ / "scene.json", input.scene);
    write_file(scene_folder_ / "mesh.obj", input.mesh);
    write_file(scene_folder_ / "paint.png", input.texture);
  }

  v1::Digest upload(const std::string& bytes) {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    const auto stream = api().UploadBlob(&context, &response);
    const proto::Digest digest = proto::digest_of(bytes);
    proto::for_each_chunk(digest, bytes, [&](const v1::BlobChunk& chunk) {
      v1::UploadBlobRequest request;
      *request.mutable_chunk() = chunk;
      return stream->Write(request);
    });
    stream->WritesDone();
    const grpc::Status status = stream->Finish();
    EXPECT_TRUE(status.ok()) << status.error_message();
    return proto::to_proto(digest);
  }

  v1::SubmitJobRequest make_request(const BadInput& input) {
    v1::SubmitJobRequest request;
    request.mutable_bundle()->set_scene_path("scene.json");
    const std::map<std::string, std::string> files{
        {"mesh.obj", input.mesh}, {"paint.png", input.texture}, {"scene.json", input.scene}};
    for (const auto& [name, bytes] : files) {
      v1::Bundle::Asset& asset = *request.mutable_bundle()->add_assets();
      asset.set_path(name);
      *asset.mutable_digest() = upload(bytes);
    }
    return request;
  }

  const std::filesystem::path scene_folder_ = folder_ / "scene";
};

TEST_F(RefusalsTest, TheUnchangedSceneIsAccepted) {
  start_coordinator();
  write_scene({});
  const Outcome here = tessera({"render", "scene.json", "-o", "out.png"}, scene_folder_);
  EXPECT_EQ(here.exit_code, 0) << here.err;
  const grpc::Status status = submit_and_validate(make_request({}));
  EXPECT_TRUE(status.ok()) << status.error_message();
}

TEST_F(RefusalsTest, BadScenesAreRefusedInTheSameWordsEverywhere) {
  start_coordinator();
  for (const BadInput& input : bad_inputs()) {
    SCOPED_TRACE(input.name);
    write_scene(input);
    const Outcome here = tessera({"render", "scene.json", "-o", "out.png"}, scene_folder_);
    EXPECT_EQ(here.exit_code, 1);
    for (const std::string& mention : input.mentions) EXPECT_THAT(here.err, HasSubstr(mention));
    EXPECT_EQ(std::count(here.err.begin(), here.err.end(), '\n'), 1) << here.err;

    const Outcome farm = tessera({"submit", "scene.json", "--wait", "-o", "out.png"}, scene_folder_);
    EXPECT_EQ(farm.exit_code, 1);
    EXPECT_EQ(farm.err, here.err);

    const grpc::Status direct = submit_and_validate(make_request(input));
    EXPECT_EQ(direct.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ("tessera: error: " + direct.error_message() + "\n", here.err);
    EXPECT_FALSE(std::filesystem::exists(scene_folder_ / "out.png"));
  }
  EXPECT_EQ(sound_jobs(), 0u);
}

TEST_F(RefusalsTest, MissingFilesAreNamed) {
  start_coordinator();
  write_scene({});
  std::filesystem::remove(scene_folder_ / "mesh.obj");
  for (const std::string scene : {"scene.json", "nowhere.json"}) {
    const Outcome here = tessera({"render", scene, "-o", "out.png"}, scene_folder_);
    const Outcome farm = tessera({"submit", scene}, scene_folder_);
    EXPECT_EQ(here.exit_code, 1);
    EXPECT_EQ(farm.exit_code, 1);
    EXPECT_EQ(farm.err, here.err);
    EXPECT_THAT(here.err, HasSubstr(scene == "scene.json" ? "mesh.obj" : "nowhere.json"));
  }
  v1::SubmitJobRequest without_mesh = make_request({});
  without_mesh.mutable_bundle()->mutable_assets()->DeleteSubrange(0, 1);
  const grpc::Status direct = submit_and_validate(without_mesh);
  EXPECT_EQ(direct.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(direct.error_message(), HasSubstr("mesh.obj"));
}

TEST_F(RefusalsTest, BadOverridesAreRefused) {
  start_coordinator();
  write_scene({});
  for (const std::vector<std::string>& flags : {std::vector<std::string>{"--spp", "-3"},
                                                {"--size", "0x0"},
                                                {"--crop", "5,5,5,9"},
                                                {"--integrator", "magic"}}) {
    std::vector<std::string> render{"render", "scene.json", "-o", "out.png"}, submit{"submit", "scene.json"};
    render.insert(render.end(), flags.begin(), flags.end());
    submit.insert(submit.end(), flags.begin(), flags.end());
    const Outcome here = tessera(render, scene_folder_), farm = tessera(submit, scene_folder_);
    EXPECT_EQ(here.exit_code, 2);
    EXPECT_EQ(farm.exit_code, 2);
    EXPECT_EQ(farm.err.substr(0, farm.err.find('\n')), here.err.substr(0, here.err.find('\n')));
  }
  v1::SubmitJobRequest request = make_request({});
  request.mutable_overrides()->set_width_px(0);
  EXPECT_THAT(submit_and_validate(request).error_message(), HasSubstr("width"));
  request.mutable_overrides()->set_width_px(16);
  request.mutable_overrides()->set_spp(0);
  EXPECT_THAT(submit_and_validate(request).error_message(), HasSubstr("spp"));
  EXPECT_EQ(submit_and_validate(request).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  request.mutable_overrides()->set_spp(1);
  request.mutable_overrides()->mutable_crop()->set_x1(17);
  request.mutable_overrides()->mutable_crop()->set_y1(1);
  EXPECT_THAT(submit_and_validate(request).error_message(), HasSubstr("crop: must be"));
  EXPECT_EQ(submit_and_validate(request).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(sound_jobs(), 0u);
}

TEST_F(RefusalsTest, NamesWithTerminalSequencesAreRefused) {
  start_coordinator();
  write_scene({});
  const std::string sentence = "--name: must be UTF-8 without line breaks and other control characters, got ";
  const Outcome submitted = tessera({"submit", "scene.json", "--name", "a\x1b[2J"}, scene_folder_);
  EXPECT_EQ(submitted.exit_code, 2);
  EXPECT_THAT(submitted.err, HasSubstr(sentence + "'a\\x1b[2J'"));
  Process& worker = start_worker("b\xff", 1);
  EXPECT_EQ(worker.wait(std::chrono::seconds(20)), 2);
  EXPECT_THAT(worker.err(), HasSubstr(sentence + "'b\\xff'"));
  EXPECT_TRUE(jobs().empty());
  EXPECT_TRUE(workers().empty());
}

TEST_F(RefusalsTest, MissingBlobsAreRequested) {
  start_coordinator();
  v1::SubmitJobRequest request = make_request({});
  *request.mutable_bundle()->mutable_assets(0)->mutable_digest() =
      proto::to_proto(proto::digest_of("never sent"));
  EXPECT_EQ(submit_and_validate(request).error_code(), grpc::StatusCode::FAILED_PRECONDITION);
}

}  // namespace
}  // namespace tessera::test
