// SPDX-License-Identifier: Apache-2.0
// Every method of the protocol, asked with each kind of credentials over real gRPC.
#include <google/protobuf/descriptor.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <future>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

using grpc::StatusCode;
using Roles = std::set<std::string>;

const Roles kViewers{"watch", "submit", "admin"}, kUsers{"submit", "admin"}, kWorkers{"work", "admin"},
    kAdministrators{"admin"};

// The roles that may call each method.
const std::map<std::string, Roles> kMayCall{
    {"RenderService/FindMissingBlobs", kUsers},
    {"RenderService/UploadBlob", kUsers},
    {"RenderService/BatchUploadBlobs", kUsers},
    {"RenderService/GetUpload", kUsers},
    {"RenderService/SubmitJob", kUsers},
    {"RenderService/GetJob", kViewers},
    {"RenderService/ListJobs", kViewers},
    {"RenderService/WatchJob", kViewers},
    {"RenderService/GetImage", kViewers},
    {"RenderService/CancelJob", kUsers},
    {"RenderService/PauseJob", kUsers},
    {"RenderService/ResumeJob", kUsers},
    {"RenderService/ExtendJob", kUsers},
    {"RenderService/UpdateJob", kUsers},
    {"RenderService/DeleteJob", kUsers},
    {"RenderService/ListWorkers", kViewers},
    {"RenderService/WatchFarm", kViewers},
    {"RenderService/WatchTiles", kViewers},
    {"RenderService/GetServerInfo", kViewers},
    {"WorkerService/Synchronize", kWorkers},
    {"WorkerService/SubmitResult", kWorkers},
    {"WorkerService/FetchBlob", kWorkers},
    {"AdminService/ListQuarantine", kAdministrators},
    {"AdminService/LiftQuarantine", kAdministrators},
    {"AdminService/DrainWorker", kAdministrators},
};

// "RenderService/GetJob" and so on, of every service of the coordinator. PeerService is that of workers.
std::vector<std::string> all_methods() {
  std::vector<std::string> methods;
  for (const auto& file : std::filesystem::directory_iterator(TESSERA_SOURCE_DIR "/proto/tessera/v1")) {
    if (file.path().filename() == "peer_service.proto") continue;
    const auto* const described = google::protobuf::DescriptorPool::generated_pool()->FindFileByName(
        "tessera/v1/" + file.path().filename().string());
    if (described == nullptr) {
      ADD_FAILURE() << file.path() << " is not linked";
      continue;
    }
    for (int s = 0; s < described->service_count(); ++s) {
      const auto& service = *described->service(s);
      for (int m = 0; m < service.method_count(); ++m)
        methods.push_back(service.name() + "/" + service.method(m)->name());
    }
  }
  return methods;
}

class MethodsTest : public LimitedService {
 protected:
  static std::string token_of(const std::string& name) { return name + "-0123456789abcdef"; }

  void start_with_roles() {
    std::string lines;
    for (const std::string role : {"watch", "submit", "work", "admin"})
      lines += role + " " + role + " " + token_of(role) + "\n";
    write_file(folder_.path() / "tokens", lines);
    access_ = *auth::Access::read(folder_.path() / "tokens");
    start({});
    channel_ = *proto::open_channel(server_->address());
  }

  // Calls with an empty message. OK as soon as there is any answer.
  StatusCode ask(const std::string& method, const std::string& token) {
    grpc::ClientContext context;
    if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
    grpc::CompletionQueue queue;
    const auto next = [&] {
      void* tag = nullptr;
      bool ok = false;
      queue.Next(&tag, &ok);
      return ok;
    };
    const auto call = grpc::GenericStub(channel_).PrepareCall(&context, "/tessera.v1." + method, &queue);
    call->StartCall(nullptr);
    next();
    const grpc::Slice nothing;
    call->WriteLast(grpc::ByteBuffer(&nothing, 1), {}, nullptr);
    next();
    grpc::ByteBuffer answer;
    call->Read(&answer, nullptr);
    const bool is_answered = next();
    if (is_answered) context.TryCancel();  // some streams do not end by themselves
    grpc::Status status;
    call->Finish(&status, nullptr);
    next();
    return is_answered ? StatusCode::OK : status.error_code();
  }
  // At once, since rejections are delayed.
  std::map<std::string, StatusCode> ask_all(const std::string& token) {
    std::map<std::string, std::future<StatusCode>> calls;
    for (const std::string& method : all_methods())
      calls.emplace(method,
                    std::async(std::launch::async, [this, method, token] { return ask(method, token); }));
    std::map<std::string, StatusCode> answers;
    for (auto& [method, call] : calls) answers.emplace(method, call.get());
    return answers;
  }

  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(MethodsTest, AllHaveARole) {
  const std::vector<std::string> methods = all_methods();
  EXPECT_EQ(methods.size(), kMayCall.size());
  for (const std::string& method : methods) EXPECT_TRUE(kMayCall.contains(method)) << method;
}

TEST_F(MethodsTest, AreAnsweredToTheRolesOfTheTableAlone) {
  start_with_roles();
  for (const std::string& token : {std::string(), token_of("other")})
    for (const auto& [method, code] : ask_all(token)) EXPECT_EQ(code, StatusCode::UNAUTHENTICATED) << method;
  for (const std::string role : {"watch", "submit", "work", "admin"}) {
    for (const auto& [method, code] : ask_all(token_of(role))) {
      EXPECT_NE(code, StatusCode::UNAUTHENTICATED) << method << " with the role " << role;
      EXPECT_NE(code, StatusCode::UNIMPLEMENTED) << method;
      EXPECT_EQ(code != StatusCode::PERMISSION_DENIED, kMayCall.at(method).contains(role))
          << method << " with the role " << role << ": " << code;
    }
  }
}

// A watcher's jobs of an earlier role are no exception.
TEST_F(MethodsTest, AWatcherSeesEverythingAndChangesNothing) {
  start_with_roles();
  const auto submitted = coordinator_->jobs().submit(submission(), "watch");
  ASSERT_TRUE(submitted);
  coordinator_->jobs().validate(submitted->id());
  const auto context = [] {
    auto made = std::make_unique<grpc::ClientContext>();
    made->AddMetadata("authorization", "Bearer " + token_of("watch"));
    return made;
  };
  v1::ListJobsResponse jobs;
  const auto listing = context();
  EXPECT_TRUE(users_->ListJobs(listing.get(), {}, &jobs).ok());
  ASSERT_EQ(jobs.jobs_size(), 1);
  v1::CancelJobRequest cancel;
  cancel.set_job_id(submitted->id());
  v1::CancelJobResponse cancelled;
  const auto cancelling = context();
  const grpc::Status status = users_->CancelJob(cancelling.get(), cancel, &cancelled);
  EXPECT_EQ(status.error_code(), StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(status.error_message(), "the token of watch is for 'watch', and this needs one for 'submit'");
  EXPECT_EQ(coordinator_->jobs().get(submitted->id())->state(), v1::JOB_STATE_RUNNING);
}

TEST_F(MethodsTest, TheServerTellsWhatTheCallerIs) {
  start_with_roles();
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer " + token_of("admin"));
  v1::GetServerInfoResponse info;
  ASSERT_TRUE(users_->GetServerInfo(&context, {}, &info).ok());
  EXPECT_EQ(info.principal(), "admin");
  EXPECT_EQ(info.role(), "admin");
  ASSERT_EQ(info.determinism_fingerprints_size(), 1);
  EXPECT_EQ(info.determinism_fingerprints(0), server::kFingerprint);
  EXPECT_EQ(info.limits().spp(), server::Limits().spp);
  EXPECT_GT(info.started_at().seconds(), 0);
  EXPECT_FALSE(info.version().empty());
}

TEST_F(MethodsTest, NewTokensCountForTheNextCalls) {
  start_with_roles();
  write_file(folder_.path() / "tokens", "submit eve " + token_of("eve") + "\n");
  server_->replace_access(*auth::Access::read(folder_.path() / "tokens"));
  EXPECT_EQ(ask("RenderService/ListJobs", token_of("submit")), StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(ask("RenderService/ListJobs", token_of("eve")), StatusCode::OK);
}

// A worker's call that waits is not lost when its token is.
TEST_F(MethodsTest, NewTokensEndNoCall) {
  start_with_roles();
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer " + token_of("work"));
  const v1::SynchronizeRequest request = greeting_with_key('a');
  v1::SynchronizeResponse response;
  std::promise<grpc::Status> answer;
  workers_->async()->Synchronize(&context, &request, &response,
                                 [&](const grpc::Status& status) { answer.set_value(status); });
  while (coordinator_->dispatcher().workers().empty()) std::this_thread::yield();
  write_file(folder_.path() / "tokens", "submit submit " + token_of("submit") + "\n");
  server_->replace_access(*auth::Access::read(folder_.path() / "tokens"));
  const auto job = coordinator_->jobs().submit(submission(), "submit");
  ASSERT_TRUE(job);
  coordinator_->jobs().validate(job->id());
  const grpc::Status status = answer.get_future().get();
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.leases_size(), 1);
}

}  // namespace
}  // namespace tessera::rpc
