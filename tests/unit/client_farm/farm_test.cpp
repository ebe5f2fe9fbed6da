// SPDX-License-Identifier: Apache-2.0
// Commands with a coordinator that rejects their calls: when they wait, and when they do not.
#include "client/farm/farm.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "client/farm/bundle.hpp"
#include "client/farm/image_download.hpp"
#include "client/farm/submission.hpp"
#include "client/farm/upload.hpp"
#include "client/farm/watching.hpp"
#include "proto/status.hpp"

namespace tessera::client {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

// Rejects so many calls before it answers. Ends the first stream of each image and file early.
class BusyService final : public v1::RenderService::Service {
 public:
  grpc::Status GetImage(grpc::ServerContext* context, const v1::GetImageRequest*,
                        grpc::ServerWriter<v1::GetImageResponse>* writer) override {
    v1::GetImageResponse response;
    response.mutable_header()->set_size_bytes(5);
    response.mutable_header()->mutable_job()->set_state(imaged);
    response.set_data("im");
    writer->Write(response);
    if (++calls <= refusals) {
      context->TryCancel();
      return {code, "CANCELLED"};
    }
    response.clear_header();
    response.set_data("age");
    writer->Write(response);
    return grpc::Status::OK;
  }
  grpc::Status FindMissingBlobs(grpc::ServerContext*, const v1::FindMissingBlobsRequest* request,
                                v1::FindMissingBlobsResponse* response) override {
    ++questions;
    *response->mutable_missing() = request->digests();
    for (int i = 0; i < uploads; ++i) response->mutable_missing()->RemoveLast();
    return grpc::Status::OK;
  }
  grpc::Status BatchUploadBlobs(grpc::ServerContext*, const v1::BatchUploadBlobsRequest* request,
                                v1::BatchUploadBlobsResponse* response) override {
    if (++calls <= refusals) return {code, "the connection broke"};
    for (const auto& blob : request->blobs()) *response->add_results()->mutable_digest() = blob.digest();
    uploads += request->blobs_size();
    return grpc::Status::OK;
  }
  grpc::Status ListJobs(grpc::ServerContext* context, const v1::ListJobsRequest*,
                        v1::ListJobsResponse*) override {
    if (++calls > refusals) return grpc::Status::OK;
    if (!pushback.empty()) context->AddTrailingMetadata(proto::kRetryAfterKey, pushback);
    return {code, reason};
  }

  grpc::Status WatchJob(grpc::ServerContext* context, const v1::WatchJobRequest*,
                        grpc::ServerWriter<v1::WatchJobResponse>* writer) override {
    if (++calls <= refusals) {
      if (!pushback.empty()) context->AddTrailingMetadata(proto::kRetryAfterKey, pushback);
      return {code, reason};
    }
    v1::WatchJobResponse response;
    response.mutable_job()->set_state(v1::JOB_STATE_DONE);
    writer->Write(response);
    return grpc::Status::OK;
  }

  grpc::Status GetServerInfo(grpc::ServerContext*, const v1::GetServerInfoRequest*,
                             v1::GetServerInfoResponse* response) override {
    if (features.empty()) return {grpc::StatusCode::UNIMPLEMENTED, ""};
    response->mutable_features()->Add(features.begin(), features.end());
    return grpc::Status::OK;
  }

  grpc::Status ListWorkers(grpc::ServerContext*, const v1::ListWorkersRequest*,
                           v1::ListWorkersResponse* response) override {
    *response = workers;
    return grpc::Status::OK;
  }

  v1::ListWorkersResponse workers;
  std::vector<std::string> features;
  int refusals = 0;
  grpc::StatusCode code = grpc::StatusCode::RESOURCE_EXHAUSTED;
  std::string pushback = "1";
  std::string reason = "there are too many calls from here";
  std::atomic<v1::JobState> imaged{v1::JOB_STATE_DONE};
  std::atomic<int> calls{0}, questions{0}, uploads{0};
};

class FarmCalls : public testing::Test {
 protected:
  FarmCalls() {
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
    open_farm({.address = address_, .security = {}});
  }
  void open_farm(const FarmOptions& options) { farm_ = std::move(*Farm::open(options)); }
  // Makes one call; used where its kind does not matter.
  void reach() { ASSERT_TRUE(farm_->call(&Farm::Stub::FindMissingBlobs, v1::FindMissingBlobsRequest())); }
  core::Result<v1::ListJobsResponse> list() {
    testing::internal::CaptureStderr();
    auto answer = farm_->call(&Farm::Stub::ListJobs, v1::ListJobsRequest());
    told_ = testing::internal::GetCapturedStderr();
    return answer;
  }
  void expect_failure_at_once(ErrorCode code) {
    const auto answer = list();
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().code, code);
    EXPECT_EQ(answer.error().message, "there are too many calls from here");
    EXPECT_EQ(service_.calls, 1);
    EXPECT_EQ(told_, "");
  }

  BusyService service_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
  std::unique_ptr<Farm> farm_;
  std::string told_;  // on stderr
};

TEST_F(FarmCalls, ThatAreAskedToWaitAreTriedAgain) {
  service_.refusals = 3;
  EXPECT_TRUE(list());
  EXPECT_EQ(service_.calls, 4);
  EXPECT_EQ(told_, "tessera: warning: there are too many calls from here; trying again for up to 60 s\n");
  service_.calls = 0;
  EXPECT_TRUE(list());
  EXPECT_EQ(told_, "") << "it is told once";
}

TEST_F(FarmCalls, ThatWaitSayEachReasonOnce) {
  for (const char* reason : {"2 scenes wait", "17 scenes wait", "it is stopping", "3 scenes wait"}) {
    service_.calls = 0;
    service_.refusals = 1;
    service_.reason = reason;
    EXPECT_TRUE(list());
    EXPECT_EQ(told_.empty(), reason[0] == '1' || reason[0] == '3') << reason << told_;
  }
}

TEST_F(FarmCalls, ForImagesThatTheCoordinatorEndedAreTriedAgain) {
  reach();
  const std::string path = testing::TempDir() + "/ended.pfm";
  service_.refusals = 2;
  service_.code = grpc::StatusCode::CANCELLED;
  testing::internal::CaptureStderr();
  const auto job = download_images(*farm_, "id", {path}, {});
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("ended the call: it is stopping, or"));
  EXPECT_TRUE(job) << job.error().message;
  EXPECT_EQ(service_.calls, 3);
  std::ifstream file(path, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "image");
}

TEST_F(FarmCalls, ForImagesOfAJobThatRunsAgainWriteNothing) {
  const std::string path = testing::TempDir() + "/finished.pfm";
  std::filesystem::remove(path);
  service_.imaged = v1::JOB_STATE_RUNNING;
  auto job = download_finished_images(*farm_, "id", {path});
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(job->state(), v1::JOB_STATE_RUNNING);
  EXPECT_FALSE(std::filesystem::exists(path));
  service_.imaged = v1::JOB_STATE_DONE;
  job = download_finished_images(*farm_, "id", {path});
  ASSERT_TRUE(job) << job.error().message;
  EXPECT_EQ(job->state(), v1::JOB_STATE_DONE);
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST_F(FarmCalls, OfJobsWithLayersNeedACoordinatorThatKnowsThem) {
  core::RenderSettings settings;
  EXPECT_TRUE(check_features(*farm_, settings)) << "without layers, nothing is asked";
  settings.layers = core::LayerSet().with(core::Layer::kNormal);
  const std::string refusal = check_features(*farm_, settings).error().message;
  EXPECT_THAT(refusal, HasSubstr(address_ + " is of an earlier release, which renders no layers: "
                                            "update it, or submit the job without them (--layers none)"));
  service_.features = {"images"};
  EXPECT_EQ(check_features(*farm_, settings).error().code, ErrorCode::kFailedPrecondition);
  service_.features = {"images", "layers"};
  EXPECT_TRUE(check_features(*farm_, settings));
}

TEST_F(FarmCalls, OfJobsWithLayersTellThatNoWorkerRendersThem) {
  core::RenderSettings plain, layered;
  layered.layers = core::LayerSet().with(core::Layer::kNormal);
  v1::Worker& silent = *service_.workers.add_workers();
  silent.set_silent(true);
  silent.set_renders_layers(true);
  EXPECT_EQ(lack_of_workers(*farm_, plain),
            "no worker is connected; the job waits for one: tessera-worker --coordinator " + address_);
  v1::Worker& old = *service_.workers.add_workers();
  old.set_draining(true);
  EXPECT_THAT(lack_of_workers(*farm_, plain), HasSubstr("all connected workers are drained or stopping"));
  old.set_draining(false);
  EXPECT_EQ(lack_of_workers(*farm_, plain), "");
  EXPECT_EQ(lack_of_workers(*farm_, layered),
            "no connected worker that takes work renders layers; the job waits for one: update the workers");
  old.set_renders_layers(true);
  EXPECT_EQ(lack_of_workers(*farm_, layered), "");
}

// A restarted coordinator has forgotten the previous answer.
TEST_F(FarmCalls, AnUploadThatBrokeAsksFirstWhatIsMissing) {
  const auto local = bundle_scene(TESSERA_SOURCE_DIR "/scenes/cornell/scene.json", {});
  ASSERT_TRUE(local);
  service_.refusals = 1;
  service_.code = grpc::StatusCode::UNAVAILABLE;
  testing::internal::CaptureStderr();
  const core::Status uploaded = upload_missing(*farm_, *local);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("the connection broke; trying again"));
  EXPECT_TRUE(uploaded);
  EXPECT_EQ(service_.questions, 2);
  EXPECT_EQ(service_.uploads, local->bundle.assets_size());
}

// The command says why it waits; it says that the coordinator is back only if it was lost.
TEST_F(FarmCalls, ReportWhyAWatchWaits) {
  const auto notices = [&] {
    std::vector<std::string> all;
    const auto job = watch_job(
        *farm_, "id", [](const v1::Job&) {}, [&](const std::string& notice) { all.push_back(notice); });
    EXPECT_TRUE(job);
    return all;
  };
  service_.refusals = 2;
  EXPECT_THAT(notices(), testing::ElementsAre(service_.reason + "; trying again"));
  service_.calls = 0;
  service_.code = grpc::StatusCode::UNAVAILABLE;
  service_.pushback = "";
  EXPECT_THAT(notices(), testing::ElementsAre(HasSubstr("lost the coordinator at " + address_),
                                              "the coordinator is back"));
}

TEST_F(FarmCalls, ThatAreOverALimitFailAtOnce) {
  service_.refusals = 3;
  service_.pushback = "";
  expect_failure_at_once(ErrorCode::kResourceExhausted);
}

TEST_F(FarmCalls, ThatAreNotToBeTriedAgainFailAtOnce) {
  service_.refusals = 3;
  service_.pushback = "-1";
  expect_failure_at_once(ErrorCode::kResourceExhausted);
}

TEST_F(FarmCalls, DoNotWaitForHours) {
  service_.refusals = 3;
  service_.pushback = "7200000";
  expect_failure_at_once(ErrorCode::kResourceExhausted);
}

TEST_F(FarmCalls, OfLongerTasksAreNotTriedAgainForWhatACallHasWaitedFor) {
  reach();
  service_.refusals = 3;
  service_.pushback = "7200000";
  const auto answer = patiently<v1::ListJobsResponse>(
      *farm_, [&](bool&) { return farm_->call(&Farm::Stub::ListJobs, v1::ListJobsRequest()); });
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().message, service_.reason);
  EXPECT_EQ(service_.calls, 1);
}

TEST_F(FarmCalls, DoNotWaitForACoordinatorThatNeverAnswered) {
  service_.refusals = 3;
  service_.pushback = "";
  service_.code = grpc::StatusCode::UNAVAILABLE;
  expect_failure_at_once(ErrorCode::kUnavailable);
}

TEST_F(FarmCalls, OfLongerTasksAreTriedAgain) {
  reach();
  service_.refusals = 2;
  service_.pushback = "";
  service_.code = grpc::StatusCode::UNAVAILABLE;
  testing::internal::CaptureStderr();
  const auto answer = patiently<v1::ListJobsResponse>(
      *farm_, [&](bool&) { return farm_->call(&Farm::Stub::ListJobs, v1::ListJobsRequest()); });
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("; trying again"));
  EXPECT_TRUE(answer);
  EXPECT_EQ(service_.calls, 3);
}

// At whichever call it is lost: the command says that it waits, and in the end that it made no progress.
TEST_F(FarmCalls, ToACoordinatorThatIsLostAreTriedAgainForAWhile) {
  open_farm({.address = address_, .security = {}, .patience = std::chrono::seconds(1)});
  const auto local = bundle_scene(TESSERA_SOURCE_DIR "/scenes/cornell/scene.json", {});
  ASSERT_TRUE(local);
  reach();
  server_->Shutdown(std::chrono::system_clock::now());
  const std::string lost = "lost the coordinator at " + address_;
  testing::internal::CaptureStderr();
  const core::Status uploaded = upload_missing(*farm_, *local);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr(lost + "; trying again for up to 1 s"));
  ASSERT_FALSE(uploaded);
  EXPECT_EQ(uploaded.error().message, lost + "; this was tried for 1 s");
  const auto image = download_images(*farm_, "id", {testing::TempDir() + "/lost.pfm"}, {});
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().message, HasSubstr(lost + "; this was tried for 1 s"));
}

// Closes connections at once, as a coordinator at its connection limit does.
class ClosingDoor {
 public:
  explicit ClosingDoor(int port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const int yes = 1;
    ::setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(socket_, 16), 0);
    thread_ = std::thread([this] {
      for (int taken = 0; (taken = ::accept(socket_, nullptr, nullptr)) >= 0;) ::close(taken);
    });
  }
  ~ClosingDoor() {
    ::shutdown(socket_, SHUT_RDWR);
    thread_.join();
    ::close(socket_);
  }

 private:
  const int socket_;
  std::thread thread_;
};

// The same for a watch.
TEST_F(FarmCalls, ToACoordinatorThatTurnsThemAwaySayWhy) {
  open_farm({.address = address_, .security = {}, .patience = std::chrono::seconds(1)});
  reach();
  server_->Shutdown(std::chrono::system_clock::now());
  const ClosingDoor door(std::stoi(address_.substr(address_.rfind(':') + 1)));
  const std::string why = "lost the coordinator at " + address_ +
                          ": it closed a new connection, since it is stopping or has as many as it takes "
                          "(tessera-coordinator --max-connections, --max-machine-connections)";
  const auto told = [this] { return list().error().message; };
  std::string last = told();  // the existing connection may have been closed
  for (int i = 0; i < 100 && last != why; ++i) last = told();
  EXPECT_EQ(last, why);
  struct Told {
    std::string notice;
  };
  const auto throw_notice = [](const std::string& notice) { throw Told{notice}; };
  try {
    static_cast<void>(watch_job(
        *farm_, "id", [](const v1::Job&) {}, throw_notice));
    ADD_FAILURE() << "it waits";
  } catch (const Told& first) {
    EXPECT_EQ(first.notice, why + "; waiting for it to come back");
  }
}

// Before the first answer: the command waits for a start, says so once, and gives up in the end.
TEST_F(FarmCalls, ToACoordinatorThatNeverAnsweredWaitForItsStart) {
  server_->Shutdown(std::chrono::system_clock::now());
  open_farm({.address = address_, .security = {}, .start_patience = std::chrono::seconds(1)});
  const auto local = bundle_scene(TESSERA_SOURCE_DIR "/scenes/cornell/scene.json", {});
  ASSERT_TRUE(local);
  testing::internal::CaptureStderr();
  const core::Status uploaded = upload_missing(*farm_, *local);
  const std::string told = testing::internal::GetCapturedStderr();
  EXPECT_EQ(told, "tessera: warning: no connection to the coordinator at " + address_ +
                      " yet; trying again for up to 1 s\n");
  ASSERT_FALSE(uploaded);
  EXPECT_THAT(uploaded.error().message, HasSubstr("no coordinator answers at " + address_));
  EXPECT_THAT(uploaded.error().message, testing::EndsWith("; this was tried for 1 s"));
}

TEST_F(FarmCalls, ReachACoordinatorThatStartsMeanwhile) {
  server_->Shutdown(std::chrono::system_clock::now());
  open_farm({.address = address_, .security = {}, .start_patience = std::chrono::seconds(60)});
  std::thread starter([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    grpc::ServerBuilder builder;
    builder.AddListeningPort(address_, grpc::InsecureServerCredentials());
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
  });
  const auto answer = list();
  starter.join();
  EXPECT_TRUE(answer) << answer.error().message;
  EXPECT_THAT(told_, HasSubstr("; trying again for up to 60 s\n"));
}

// An unknown host name does not mean that a coordinator is starting.
TEST_F(FarmCalls, ToAnUnknownHostFailAtOnce) {
  open_farm({.address = "nowhere.invalid:7420",
             .security = {.insecure = true},
             .start_patience = std::chrono::seconds(60)});
  const auto answer = list();
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().message, HasSubstr("no machine is known by the name"));
  EXPECT_EQ(told_, "");
}

TEST_F(FarmCalls, WarnOfWorldReadableSecrets) {
  const std::string token = testing::TempDir() + "/exposed.token";
  std::ofstream(token) << "secret\n";
  const auto told_of = [&](std::filesystem::perms rights) {
    std::filesystem::permissions(token, rights);
    testing::internal::CaptureStderr();
    EXPECT_TRUE(Farm::open({.address = address_, .security = {.token = token}}));
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(told_of(std::filesystem::perms(0640)), "");
  EXPECT_EQ(told_of(std::filesystem::perms(0644)),
            "tessera: warning: every user of this machine can read the secret in '" + token +
                "': chmod 600 '" + token + "'\n");
  EXPECT_THAT(told_of(std::filesystem::perms(0666)), HasSubstr("can change the secret"));
}

}  // namespace
}  // namespace tessera::client
