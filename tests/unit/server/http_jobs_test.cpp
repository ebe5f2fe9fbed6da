// SPDX-License-Identifier: Apache-2.0
// Jobs over HTTP: from a scene's files to the image.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "core/image/encode.hpp"
#include "proto/blob.hpp"
#include "tests/unit/server/http_service.hpp"

namespace tessera::http_api {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class HttpJobs : public HttpService {
 protected:
  static std::string submission_of(const std::string& bytes, const std::string& more = {}) {
    return fmt::format(R"({{"scene_path":"a/scene.json","files":[{{"path":"a/scene.json","sha256":"{}",)"
                       R"("bytes":{}}}]{}}})",
                       proto::digest_of(bytes).hex(), bytes.size(), more);
  }
  std::string submit_page(const std::string& more = {}) {
    const Reply reply = call("POST", "/api/v1/jobs", submission_of(server::kSceneBytes, more));
    EXPECT_EQ(reply.status, 200) << reply.body;
    return wait_until_validated(reply.json()["id"]);
  }
  nlohmann::json job(const std::string& id) { return get("/api/v1/jobs/" + id).json(); }
};

TEST_F(HttpJobs, AreSubmittedWithTheirFiles) {
  start_page();
  const std::string scene = R"({"a": "scene that nobody has"})";
  const std::string hex = proto::digest_of(scene).hex();
  const Reply missing = call("POST", "/api/v1/jobs", submission_of(scene));
  EXPECT_EQ(missing.status, 412) << missing.body;
  EXPECT_EQ(missing.json()["error"]["reason"], "MISSING_BLOBS");
  EXPECT_EQ(missing.json()["error"]["missing"], nlohmann::json::array({hex}));
  const std::string files = fmt::format(R"({{"files":[{{"sha256":"{}","bytes":{}}}]}})", hex, scene.size());
  EXPECT_EQ(call("POST", "/api/v1/blobs/missing", files).json()["missing"], nlohmann::json::array({hex}));
  const Reply uploaded = call("POST", "/api/v1/blobs", scene);
  EXPECT_EQ(uploaded.status, 200) << uploaded.body;
  EXPECT_EQ(uploaded.json()["sha256"], hex);
  EXPECT_EQ(uploaded.json()["bytes"], scene.size());
  EXPECT_EQ(call("POST", "/api/v1/blobs", scene).status, 200) << "again";
  EXPECT_EQ(call("POST", "/api/v1/blobs/missing", files).json()["missing"], nlohmann::json::array());
  const Reply submitted = call("POST", "/api/v1/jobs", submission_of(scene, R"(,"request_id":"once")"));
  EXPECT_EQ(submitted.status, 200) << submitted.body;
  EXPECT_EQ(submitted.json()["state"], "validating");
  EXPECT_EQ(call("POST", "/api/v1/jobs", submission_of(scene, R"(,"request_id":"once")")).json()["id"],
            submitted.json()["id"]);
  const std::string id = wait_until_validated(submitted.json()["id"]);
  EXPECT_EQ(job(id)["state"], "running");
  EXPECT_EQ(job(id)["scene"], "a/scene.json");
  EXPECT_EQ(job(id)["files"][0]["sha256"], hex);
  EXPECT_EQ(get("/api/v1/jobs").json()["jobs"].size(), 1u);
}

TEST_F(HttpJobs, AreCountedInTheActivity) {
  start_page();
  submit_page();
  page_.reset();
  open_page();  // takes the first sample
  const nlohmann::json activity = get("/api/v1/activity").json();
  EXPECT_EQ(activity["period_seconds"], 10);
  ASSERT_GE(activity["samples"].size(), 1u);
  EXPECT_EQ(activity["samples"][0], nlohmann::json({0, 0, 1}));
}

TEST_F(HttpJobs, KeepTheirSettings) {
  start_page();
  const std::string id =
      submit_page(R"(,"name":"one","priority":-3,"max_workers":2,"labels":{"k":"v"},)"
                  R"("overrides":{"width":64,"height":32,"spp":4,"exposure":1.5,"tone_curve":"agx"})");
  const auto told = job(id);
  EXPECT_EQ(told["width"], 64);
  EXPECT_EQ(told["spp"], 4);
  EXPECT_EQ(told["priority"], -3);
  EXPECT_EQ(told["max_workers"], 2);
  EXPECT_EQ(told["labels"]["k"], "v");
  EXPECT_EQ(told["tone_curve"], "agx");
  EXPECT_EQ(get("/api/v1/jobs?label=k%3Dv&state=running,paused").json()["jobs"].size(), 1u);
  EXPECT_EQ(get("/api/v1/jobs?label=k%3Dother").json()["jobs"].size(), 0u);
  EXPECT_EQ(get("/api/v1/jobs?state=done").json()["jobs"].size(), 0u);
}

TEST_F(HttpJobs, AreRefusedWithTheField) {
  start_page();
  const auto field = [&](const std::string& body) {
    const Reply reply = call("POST", "/api/v1/jobs", body);
    EXPECT_EQ(reply.status, 400) << body;
    return reply.json()["error"].value("field", "");
  };
  EXPECT_EQ(field(R"({"scene":"x"})"), "scene");
  EXPECT_EQ(field(R"({"priority":"high"})"), "priority");
  EXPECT_EQ(field(R"({"max_workers":-1})"), "max_workers");
  EXPECT_EQ(field(R"({"frames":[1,"2"]})"), "frames[1]");
  EXPECT_EQ(field(R"({"priority":2147483648})"), "priority");
  EXPECT_EQ(field(R"({"files":[{"path":"a","sha256":"0f"}]})"), "files[0].sha256");
  EXPECT_EQ(field(R"({"overrides":{"integrator":"fast"}})"), "overrides.integrator");
  EXPECT_EQ(field(R"({"overrides":{"crop":[1,2,3]}})"), "overrides.crop");
  EXPECT_EQ(field(R"({"name":"a\nb"})"), "name");
  EXPECT_EQ(field("{"), "");
  EXPECT_EQ(field("[]"), "");
  EXPECT_EQ(get("/api/v1/jobs?state=gone").json()["error"]["field"], "state");
  EXPECT_EQ(get("/api/v1/jobs?page_size=1001").json()["error"]["field"], "page_size");
}

TEST_F(HttpJobs, WithHostileNamesStayText) {
  start_page();
  const std::string name = "</script><img src=x onerror=alert(1)>\"\\ \xE2\x80\xA8";
  const std::string id = submit_now([&] {
    v1::SubmitJobRequest request = rpc::submission();
    request.set_name(name.substr(0, name.find('\xE2')));
    (*request.mutable_labels())["l"] = "<b>";
    return request;
  }());
  const Reply reply = get("/api/v1/jobs/" + id);
  EXPECT_EQ(reply.header("Content-Type"), "application/json");
  EXPECT_EQ(reply.json()["name"], name.substr(0, name.find('\xE2')));
  const Reply image = get("/api/v1/jobs/" + id + "/image?format=pfm");
  EXPECT_EQ(image.header("Content-Disposition").find_first_of("<>\\/"), std::string::npos)
      << image.header("Content-Disposition");
}

TEST_F(HttpJobs, AreChangedByTheirOwners) {
  start_page_with_names();
  const Reply submitted = call_as("ada", "POST", "/api/v1/jobs", submission_of(server::kSceneBytes));
  const std::string id = wait_until_validated(submitted.json()["id"]);
  const std::string path = "/api/v1/jobs/" + id;
  EXPECT_EQ(call_as("ada", "GET", path).json()["owner"], "ada");
  EXPECT_EQ(call_as("ben", "GET", path).status, 200);
  EXPECT_EQ(call_as("ben", "POST", path + "/pause").status, 403);
  EXPECT_EQ(call_as("ben", "DELETE", path).status, 403);
  EXPECT_EQ(call_as("ben", "PATCH", path, R"({"priority":9})").status, 403);
  EXPECT_EQ(call_as("ada", "POST", path + "/pause").json()["state"], "paused");
  EXPECT_EQ(call_as("ada", "GET", path).json()["waiting_reason"], "paused");
  EXPECT_EQ(call_as("root", "POST", path + "/resume").json()["state"], "running");
  EXPECT_EQ(call_as("ada", "PATCH", path, R"({"priority":9})").json()["priority"], 9);
  EXPECT_EQ(call_as("ada", "POST", path + "/extend", R"({"spp":8})").json()["spp"], 8);
  EXPECT_EQ(call_as("ada", "POST", path + "/cancel").json()["state"], "cancelled");
  const Reply refused = call_as("ada", "POST", path + "/resume");
  EXPECT_EQ(refused.status, 409);
  EXPECT_EQ(refused.code(), "FAILED_PRECONDITION");
  const auto events = call_as("ada", "GET", path + "/events").json()["events"];
  EXPECT_EQ(events.front()["kind"], "submitted");
  EXPECT_EQ(events.back()["kind"], "cancelled");
  EXPECT_TRUE(events.back()["at"].is_string());
  EXPECT_EQ(call_as("root", "DELETE", path).status, 204);
  EXPECT_EQ(call_as("root", "GET", path).status, 404);
}

TEST_F(HttpJobs, HaveAPlaceWhileTheyWait) {
  start_page();
  const std::string first = submit_page();
  const std::string second = submit_page();
  const std::string urgent = submit_page(R"(,"priority":5)");
  EXPECT_EQ(job(urgent)["queue_position"], 1);
  EXPECT_EQ(job(first)["queue_position"], 2);
  EXPECT_EQ(job(second)["queue_position"], 3);
  EXPECT_EQ(job(second)["waiting_reason"], "no worker is connected");
  take_lease();
  EXPECT_EQ(job(urgent)["queue_position"], nullptr);
  EXPECT_EQ(job(urgent)["active_workers"], 1);
  EXPECT_EQ(job(urgent)["waiting_reason"], nullptr);
}

TEST_F(HttpJobs, HaveImages) {
  start_page();
  const std::string id = submit_page();
  const std::string path = "/api/v1/jobs/" + id;
  while (work_once()) {
  }
  const core::Image expected = server::ready_made_image(server::kWidthPx, server::kHeightPx, server::kSpp);
  for (const bool is_stored : {false, true}) {
    if (is_stored)
      while (job(id)["state"] != "done") std::this_thread::yield();
    const Reply pfm = get(path + "/image?format=pfm");
    EXPECT_EQ(pfm.status, 200);
    EXPECT_EQ(pfm.body, *core::encode_image(expected, core::ImageFormat::kPfm));
    const Reply png = get(path + "/image?region=0,0,64,64&exposure=1");
    EXPECT_EQ(png.header("Content-Type"), "image/png");
    EXPECT_THAT(png.header("Content-Disposition"), AllOf(HasSubstr("attachment"), HasSubstr(".png")));
    const auto pixel = get(path + "/pixel?x=100&y=70").json();
    EXPECT_EQ(pixel["samples"], server::kSpp);
    EXPECT_EQ(pixel["value"][1].get<float>(), expected.at(100, 70).g);
    EXPECT_EQ(pixel["standard_error"].size(), 3u);
    const Reply thumbnail = get(path + "/thumbnail?size=32");
    EXPECT_EQ(thumbnail.header("Content-Type"), "image/png");
    EXPECT_EQ(get(path + "/thumbnail?size=32", {{"If-None-Match", thumbnail.header("ETag")}}).status, 304);
    const auto map = get(path + "/map").json();
    EXPECT_EQ(map["columns"], 3);
    EXPECT_EQ(map["rows"], 2);
    ASSERT_EQ(map["tiles"].size(), 6u);
    EXPECT_EQ(map["tiles"][5][0], server::kSpp);
    EXPECT_EQ(map["tiles"][5][1], 0);
  }
  EXPECT_EQ(get(path + "/image?format=gif").json()["error"]["field"], "format");
  EXPECT_EQ(get(path + "/image?region=0,0,9999,1").status, 400);
  EXPECT_EQ(get(path + "/pixel?x=5").json()["error"]["field"], "y");
  EXPECT_EQ(get(path + "/pixel?x=5&y=4000").status, 400);
  EXPECT_EQ(get("/api/v1/jobs/none/image").status, 404);
}

TEST_F(HttpJobs, HaveSeveralImages) {
  start_page();
  const std::string id = submit_page(R"(,"frames":[10,12,7])");
  const std::string path = "/api/v1/jobs/" + id;
  EXPECT_EQ(job(id)["image_count"], 3);
  EXPECT_EQ(job(id)["images"][1]["frame"], 12);
  while (work_once()) {
  }
  const core::PixelRect window{0, 0, server::kWidthPx, server::kHeightPx};
  std::string thumbnails[3];
  for (const bool is_stored : {false, true}) {
    if (is_stored)
      while (job(id)["state"] != "done") std::this_thread::yield();
    for (const std::uint32_t image : {0U, 1U, 2U}) {
      const core::Image expected = server::ready_made_image(window, server::kSpp, image);
      const std::string parameter = "image=" + std::to_string(image);
      EXPECT_TRUE(get(path + "/image?format=pfm&" + parameter).body ==
                  *core::encode_image(expected, core::ImageFormat::kPfm))
          << parameter;
      EXPECT_EQ(get(path + "/pixel?x=100&y=70&" + parameter).json()["value"][1].get<float>(),
                expected.at(100, 70).g);
      const auto map = get(path + "/map?" + parameter).json();
      ASSERT_EQ(map["tiles"].size(), 6u);
      EXPECT_EQ(map["tiles"][5][0], server::kSpp) << parameter;
      thumbnails[image] = get(path + "/thumbnail?size=32&" + parameter).body;
    }
    EXPECT_THAT(get(path + "/image?format=pfm&image=2").header("Content-Disposition"),
                HasSubstr("-image2.pfm"));
    EXPECT_NE(thumbnails[0], thumbnails[1]);
    EXPECT_NE(thumbnails[1], thumbnails[2]);
    EXPECT_EQ(get(path + "/thumbnail?size=32").body, thumbnails[0]);
  }
  for (const char* what : {"image?format=pfm&", "pixel?x=1&y=1&", "map?", "thumbnail?", "tiles?"}) {
    const Reply refused = get(path + "/" + what + "image=3");
    EXPECT_EQ(refused.status, 400) << what;
    EXPECT_EQ(refused.json()["error"]["field"], "image") << what;
    EXPECT_EQ(get(path + "/" + what + "image=-1").status, 400) << what;
  }
}

// Only tiles of the image that is asked for are leased in its map.
TEST_F(HttpJobs, HaveMapsOfEachImage) {
  start_page();
  v1::SubmitJobRequest request = rpc::submission();
  for (const int frame : {1, 2}) request.add_frames(frame);
  const std::string id = submit_now(request);
  const v1::Lease lease = take_lease();
  ASSERT_GT(lease.items_size(), 0);
  int leased[2] = {0, 0}, shown[2] = {0, 0};
  for (const v1::WorkItem& item : lease.items()) ++leased[item.image()];
  for (int image = 0; image < 2; ++image) {
    const auto map = get("/api/v1/jobs/" + id + "/map?image=" + std::to_string(image)).json();
    for (const auto& tile : map["tiles"]) shown[image] += tile[1].get<int>();
  }
  EXPECT_EQ(shown[0], leased[0]);
  EXPECT_EQ(shown[1], leased[1]);
  EXPECT_GT(shown[0], 0);
}

TEST_F(HttpJobs, HaveMapsOfRenderingWorkers) {
  start_page();
  const std::string id = submit_page();
  const v1::Lease lease = take_lease();
  ASSERT_GT(lease.items_size(), 0);
  const auto map = get("/api/v1/jobs/" + id + "/map").json();
  const v1::PixelRect& rect = lease.items(0).rect();
  const auto tile = map["tiles"][rect.y0() / 64 * 3 + rect.x0() / 64];
  EXPECT_EQ(tile[0], 0);
  EXPECT_EQ(tile[1], 1);
  ASSERT_EQ(tile[2], 0);
  EXPECT_EQ(map["workers"][0]["id"], rpc::greeting_with_key('a').worker_id());
}

TEST_F(HttpJobs, ListWorkersAndDrainThem) {
  start_page();
  submit_page();
  take_lease();
  const auto workers = get("/api/v1/workers").json()["workers"];
  ASSERT_EQ(workers.size(), 1u);
  const std::string id = workers[0]["id"];
  EXPECT_EQ(call("POST", "/api/v1/workers/" + id + "/drain", "{}").json()["id"], id);
  EXPECT_THAT(get("/api/v1/workers").json()["workers"][0]["state"].get<std::string>(),
              testing::StartsWith("drain"));
  EXPECT_EQ(call("POST", "/api/v1/workers/none/drain").status, 404);
  EXPECT_EQ(get("/api/v1/quarantine").json()["entries"], nlohmann::json::array());
  EXPECT_EQ(call("DELETE", "/api/v1/quarantine/none").status, 404);
}

TEST_F(HttpJobs, AreFilteredByWhatTheTableShows) {
  start_page();
  submit_page();
  submit_page();
  EXPECT_EQ(get("/api/v1/jobs?state=queued").json()["jobs"].size(), 2u);
  take_lease();
  EXPECT_EQ(get("/api/v1/jobs?state=queued,paused").json()["jobs"].size(), 1u);
  EXPECT_EQ(get("/api/v1/jobs?state=running").json()["jobs"].size(), 2u);
  EXPECT_THAT(get("/api/v1/jobs?state=runing").json()["error"]["message"].get<std::string>(),
              HasSubstr("there is no state 'runing'; did you mean 'running'?"));
}

TEST_F(HttpJobs, ListWorkersByStatePrincipalAndTime) {
  start_page();
  submit_page();
  take_lease();
  const auto count = [&](const std::string& query) {
    return get("/api/v1/workers?" + query).json()["workers"].size();
  };
  EXPECT_EQ(count("state=working"), 1u);
  EXPECT_EQ(count("state=in%20cooldown,idle"), 0u);
  EXPECT_EQ(count("principal=nobody"), 0u);
  EXPECT_EQ(count("seen_within=60"), 1u);
  EXPECT_EQ(count("unseen_for=60"), 0u);
  const Reply unknown = get("/api/v1/workers?state=idel");
  EXPECT_EQ(unknown.status, 400);
  EXPECT_EQ(unknown.json()["error"]["field"], "state");
  EXPECT_THAT(unknown.json()["error"]["message"].get<std::string>(), HasSubstr("did you mean 'idle'?"));
  EXPECT_EQ(get("/api/v1/workers?seen_within=soon").json()["error"]["field"], "seen_within");
}

TEST_F(HttpJobs, ListTheCachesOfWorkers) {
  start_page();
  v1::SynchronizeRequest hello = rpc::greeting_with_key('a');
  const auto cache_after = [&] {
    coordinator_->dispatcher().synchronize(hello, {.answer = [](const auto&) {}});
    return get("/api/v1/workers").json()["workers"][0]["cache"].dump();
  };
  EXPECT_EQ(cache_after(), "null");
  hello.mutable_cache()->set_used_bytes(100);
  hello.mutable_cache()->set_limit_bytes(500);
  EXPECT_EQ(cache_after(), R"({"limit_bytes":500,"used_bytes":100})");
  hello.mutable_cache()->set_used_bytes(200);
  EXPECT_EQ(cache_after(), R"({"limit_bytes":500,"used_bytes":200})");
}

TEST_F(HttpJobs, AreCountedByRoute) {
  start_page();
  get("/api/v1/jobs/none");
  const auto& stats = page_->calls().methods().at("GET /api/v1/jobs/{id}");
  EXPECT_EQ(stats.ended[static_cast<std::size_t>(grpc::StatusCode::NOT_FOUND)], 1u);
  EXPECT_EQ(stats.in_progress, 0);
}

TEST_F(HttpJobs, AreLimited) {
  server::Limits limits;
  limits.blob_mib = 1;
  limits.calls_per_second = 1;
  start_page(limits);
  http::RawClient upload(page_->address());
  ASSERT_TRUE(
      upload.send("POST /api/v1/blobs HTTP/1.1\r\nHost: localhost\r\nX-Tessera: 1\r\n"
                  "Content-Length: 1048577\r\n\r\n"));
  EXPECT_THAT(upload.receive_until("\r\n"), HasSubstr("413"));
  Reply last;
  for (int i = 0; i < 20 && last.status != 429; ++i) last = get("/api/v1/jobs");
  EXPECT_EQ(last.status, 429);
  EXPECT_EQ(last.json()["error"]["reason"], "TRY_LATER");
  EXPECT_NE(last.header("Retry-After"), "");
}

}  // namespace
}  // namespace tessera::http_api
