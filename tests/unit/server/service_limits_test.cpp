// The service's own limits, over real gRPC on a free port.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "proto/blob.hpp"
#include "proto/channel.hpp"
#include "proto/status.hpp"
#include "server/rpc/server.hpp"
#include "tessera/v1/render_service.grpc.pb.h"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::rpc {
namespace {

using coordinator::greeting;
using coordinator::submission;
using testing::HasSubstr;

// Holds up those who come until it is opened.
class Barrier {
 public:
  void wait() {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_; });
  }
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void wait_for_someone() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_ > 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int waiting_ = 0;
  bool open_ = false;
};

class ServiceLimits : public testing::Test {
 protected:
  ~ServiceLimits() override { barrier_.open(); }

  // With tokens for ada and ben.
  void start_with_names(const server::Limits& limits) {
    for (const std::string name : {"ada", "ben"}) {
      write_file(folder_.path() / name, std::string(16, name[0]));
      write_file(folder_.path() / "tokens", read_file(folder_.path() / "tokens") + "submit " + name + " " +
                                                std::string(16, name[0]) + "\n");
    }
    access_ = *Access::read(folder_.path() / "tokens");
    start(limits);
  }
  std::unique_ptr<v1::RenderService::Stub> as(const std::string& name) {
    proto::ClientSecurity security;
    security.token = folder_.path() / name;
    return v1::RenderService::NewStub(*proto::open_channel(server_->address(), security));
  }
  void start(const server::Limits& limits) {
    auto state = store::StateDirectory::open(folder_.path());
    coordinator::Options options;
    options.limits = limits;
    coordinator_ = std::move(*coordinator::Coordinator::open(options, std::move(*state), check_scene_));
    server_ = std::move(
        *Server::start(*coordinator_, {.address = "127.0.0.1:0", .access = access_, .limits = limits}));
    users_ = v1::RenderService::NewStub(*proto::open_channel(server_->address()));
    workers_ = v1::WorkerService::NewStub(*proto::open_channel(server_->address()));
    auto writer = coordinator_->blobs().write(proto::digest_of(coordinator::kSceneBytes));
    ASSERT_TRUE(writer && writer->append(coordinator::kSceneBytes) && writer->commit());
  }
  void hold_up_scenes() {
    check_scene_ = [this](const v1::Bundle& bundle, const v1::RenderOverrides& overrides) {
      barrier_.wait();
      return coordinator::accept_scene(bundle, overrides);
    };
  }

  // A stream whose first message says so many bytes, and which brings these.
  grpc::Status upload(std::uint64_t said, const std::string& bytes, int times = 1) {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    const auto stream = users_->UploadBlob(&context, &response);
    v1::UploadBlobRequest request;
    *request.mutable_chunk()->mutable_digest() = proto::to_proto(proto::digest_of(bytes));
    request.mutable_chunk()->mutable_digest()->set_size_bytes(said);
    request.mutable_chunk()->set_data(bytes);
    for (int i = 0; i < times && stream->Write(request); ++i) request.mutable_chunk()->clear_digest();
    stream->WritesDone();
    return stream->Finish();
  }
  std::size_t files_in(const std::string& folder) {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_.path() / "blobs" / folder), {}));
  }
  // An upload that has begun, and may stand still.
  struct Upload {
    grpc::ClientContext context;
    v1::UploadBlobResponse response;
    std::unique_ptr<grpc::ClientWriterInterface<v1::UploadBlobRequest>> stream;
  };
  // Sends all but the last byte, and waits until it is on the disk.
  std::unique_ptr<Upload> begin_upload(const std::string& bytes) {
    auto upload = std::make_unique<Upload>();
    upload->stream = users_->UploadBlob(&upload->context, &upload->response);
    v1::UploadBlobRequest request;
    *request.mutable_chunk()->mutable_digest() = proto::to_proto(proto::digest_of(bytes));
    request.mutable_chunk()->set_data(bytes.substr(0, bytes.size() - 1));
    const std::uint64_t before = coordinator_->blobs().used_bytes();
    EXPECT_TRUE(upload->stream->Write(request));
    const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (coordinator_->blobs().used_bytes() < before + bytes.size() - 1 &&
           std::chrono::steady_clock::now() < late)
      std::this_thread::yield();
    return upload;
  }
  grpc::Status finish_upload(Upload& upload, const std::string& bytes) {
    v1::UploadBlobRequest request;
    request.mutable_chunk()->set_data(bytes.substr(bytes.size() - 1));
    upload.stream->Write(request);
    upload.stream->WritesDone();
    return upload.stream->Finish();
  }
  // Again until it is let in: what an ended stream held is free a little later than its caller hears of the
  // end.
  void expect_upload_in_the_end(const std::string& bytes) {
    grpc::Status status;
    do {
      status = upload(bytes.size(), bytes);
    } while (status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_TRUE(status.ok()) << status.error_message();
  }
  struct Fetch {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReaderInterface<v1::GetImageResponse>> stream;
  };
  std::unique_ptr<Fetch> begin_fetch(const std::string& job) {
    auto fetch = std::make_unique<Fetch>();
    v1::GetImageRequest request;
    request.set_job_id(job);
    request.set_format(v1::IMAGE_FORMAT_PFM);
    fetch->stream = users_->GetImage(&fetch->context, request);
    return fetch;
  }
  grpc::Status finish_fetch(Fetch& fetch) {
    v1::GetImageResponse response;
    while (fetch.stream->Read(&response)) {
    }
    return fetch.stream->Finish();
  }
  std::string submit_now(const v1::SubmitJobRequest& request = submission()) {
    grpc::ClientContext context;
    v1::SubmitJobResponse response;
    EXPECT_TRUE(users_->SubmitJob(&context, request, &response).ok());
    return response.job().id();
  }
  // A picture of 24 MB: more than is on its way where nobody takes any of it.
  std::string submit_large() {
    v1::SubmitJobRequest request = submission();
    request.mutable_overrides()->set_width_px(2000);
    request.mutable_overrides()->set_height_px(1000);
    return submit_now(request);
  }
  grpc::Status list(grpc::ClientContext& context) {
    v1::ListJobsResponse response;
    return users_->ListJobs(&context, {}, &response);
  }
  struct Submission {
    Submission() { context.set_wait_for_ready(true); }
    grpc::ClientContext context;
    v1::SubmitJobRequest request = submission();
    v1::SubmitJobResponse response;
    std::promise<grpc::Status> status;
  };
  void submit(Submission& submission) { submit(*users_, submission); }
  void submit(v1::RenderService::Stub& user, Submission& submission) {
    user.async()->SubmitJob(
        &submission.context, &submission.request, &submission.response,
        [&submission](const grpc::Status& status) { submission.status.set_value(status); });
  }

  // A coordinator that stops answers those who wait.
  void open_when_it_stops() {
    coordinator_->synchronize(greeting('a'), {.answer = [this](const auto& answer) {
                                if (!answer) return barrier_.open();
                                open_when_it_stops();
                              }});
  }

  TemporaryFolder folder_;
  Access access_;
  coordinator::SceneCheck check_scene_ = coordinator::accept_scene;
  Barrier barrier_;
  std::unique_ptr<coordinator::Coordinator> coordinator_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<v1::RenderService::Stub> users_;
  std::unique_ptr<v1::WorkerService::Stub> workers_;
};

TEST_F(ServiceLimits, OfBlobsIsTheSizeThatTheyAreSaidToHave) {
  start({.blob_mib = 1});
  const grpc::Status status = upload((1 << 20) + 1, "the first of a million bytes");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(),
              HasSubstr("the file has 1048577 bytes, and this farm takes at most 1 MiB "
                        "(tessera-coordinator --max-blob-mib)"));
  EXPECT_EQ(files_in("incoming"), 0u);
  const std::string largest(1 << 20, 'x');
  EXPECT_TRUE(upload(largest.size(), largest).ok());
}

TEST_F(ServiceLimits, AStreamThatBringsMoreThanItSaidEndsThere) {
  start({.blob_mib = 1});
  const std::string chunk(1 << 20, 'x');
  const grpc::Status more = upload(chunk.size(), chunk, 50);
  EXPECT_EQ(more.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(more.error_message(), HasSubstr("more bytes than the 1048576 its digest says"));
  EXPECT_EQ(upload(chunk.size(), "less").error_code(), grpc::StatusCode::DATA_LOSS);
  server_.reset();  // a stream may end a little later than its caller hears of it
  EXPECT_EQ(files_in("incoming"), 0u);
}

TEST_F(ServiceLimits, OfMessages) {
  start({.message_mib = 1});
  grpc::ClientContext context;
  v1::GetJobRequest request;
  request.set_job_id(std::string(2 << 20, 'x'));
  v1::GetJobResponse response;
  EXPECT_EQ(users_->GetJob(&context, request, &response).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  grpc::ClientContext after;
  EXPECT_TRUE(list(after).ok());
}

TEST_F(ServiceLimits, OfCallsSayWhenToTryAgain) {
  start({.calls_per_second = 0.5});
  for (int i = 0; i < 100; ++i) {
    grpc::ClientContext context;
    const grpc::Status status = list(context);
    if (status.ok()) continue;
    EXPECT_GE(i, 5) << "ten seconds' worth at once";
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_THAT(
        status.error_message(),
        HasSubstr("there are too many calls from here, and this farm takes at most 0.5 a second from each "
                  "caller (tessera-coordinator --max-calls-per-second)"));
    EXPECT_EQ(proto::error_from_grpc(status, context).code, core::ErrorCode::kUnavailable);
    grpc::ClientContext working;
    v1::SynchronizeResponse response;
    v1::SynchronizeRequest request = greeting('a');
    request.set_wanted_leases(0);
    request.set_draining(true);
    EXPECT_TRUE(workers_->Synchronize(&working, request, &response).ok()) << "workers count by themselves";
    return;
  }
  FAIL() << "nothing was refused";
}

TEST_F(ServiceLimits, OfWorkersCallsAsWell) {
  start({.calls_per_second = 0.5});
  for (int i = 0; i < 100; ++i) {
    grpc::ClientContext context;
    v1::SubmitResultRequest request;
    request.set_worker_id("a");
    v1::SubmitResultResponse response;
    const grpc::Status status = workers_->SubmitResult(&context, request, &response);
    if (status.error_code() != grpc::StatusCode::RESOURCE_EXHAUSTED) continue;
    EXPECT_GE(i, 5);
    return;
  }
  FAIL() << "nothing was refused";
}

TEST_F(ServiceLimits, OfScenesThatWaitToBeValidated) {
  hold_up_scenes();
  start({.validations = 1, .waiting_scenes = 1});
  Submission first, second, third;
  submit(first);
  barrier_.wait_for_someone();
  submit(second);
  submit(third);
  // One of the two waits; the other is refused before anything is opened.
  auto of_second = second.status.get_future(), of_third = third.status.get_future();
  const auto is_answered = [](auto& future) {
    return future.wait_for(std::chrono::milliseconds(1)) == std::future_status::ready;
  };
  bool second_refused = false;
  while (!(second_refused = is_answered(of_second)) && !is_answered(of_third)) {
  }
  const grpc::Status refused = (second_refused ? of_second : of_third).get();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(
      refused.error_message(),
      HasSubstr("1 scenes from here wait to be validated already, and this farm takes at most 1 from all "
                "callers (tessera-coordinator --max-waiting-scenes)"));
  EXPECT_EQ(proto::error_from_grpc(refused, second_refused ? second.context : third.context).code,
            core::ErrorCode::kUnavailable)
      << "it passes by itself";
  barrier_.open();
  EXPECT_TRUE(first.status.get_future().get().ok());
  EXPECT_TRUE((second_refused ? of_third : of_second).get().ok());
}

// The first of the answers that come, while others wait.
grpc::Status first_answer(std::vector<std::future<grpc::Status>>& futures) {
  while (true) {
    for (auto& future : futures) {
      if (future.valid() && future.wait_for(std::chrono::milliseconds(1)) == std::future_status::ready)
        return future.get();
    }
  }
}

TEST_F(ServiceLimits, NoSubmitterFillsTheQueueOfScenes) {
  hold_up_scenes();
  start_with_names({.validations = 1, .waiting_scenes = 4});
  const auto ada = as("ada"), ben = as("ben");
  std::vector<std::unique_ptr<Submission>> submissions;
  std::vector<std::future<grpc::Status>> of_ada, of_ben;
  const auto submit_as = [&](v1::RenderService::Stub& user, std::vector<std::future<grpc::Status>>& answers) {
    submissions.push_back(std::make_unique<Submission>());
    answers.push_back(submissions.back()->status.get_future());
    submit(user, *submissions.back());
  };
  submit_as(*ada, of_ada);
  barrier_.wait_for_someone();
  for (int i = 0; i < 3; ++i) submit_as(*ada, of_ada);
  const grpc::Status refused = first_answer(of_ada);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(refused.error_message(),
            "2 scenes from here wait to be validated already, and this farm takes at most 4 from all callers "
            "(tessera-coordinator --max-waiting-scenes), some of which it keeps for others");
  for (int i = 0; i < 2; ++i) submit_as(*ben, of_ben);
  EXPECT_THAT(first_answer(of_ben).error_message(), HasSubstr("1 scenes from here wait"))
      << "one of his is let in";
  barrier_.open();
  for (auto* answers : {&of_ada, &of_ben}) {
    for (auto& answer : *answers) {
      if (answer.valid()) {
        EXPECT_TRUE(answer.get().ok());
      }
    }
  }
}

TEST_F(ServiceLimits, OfUploadsAtOnce) {
  start({.uploads = 2});
  const std::string first(1000, '1'), second(1000, '2');
  const auto under_way = begin_upload(first);
  grpc::ClientContext context;
  v1::UploadBlobResponse response;
  const grpc::Status refused = users_->UploadBlob(&context, &response)->Finish();
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(refused.error_message(),
            "1 uploads from here are under way already, and this farm takes at most 2 from all callers "
            "(tessera-coordinator --max-uploads), some of which it keeps for others");
  EXPECT_EQ(proto::error_from_grpc(refused, context).code, core::ErrorCode::kUnavailable)
      << "it passes by itself";
  EXPECT_TRUE(finish_upload(*under_way, first).ok());
  expect_upload_in_the_end(second);
}

TEST_F(ServiceLimits, OfTheStoreSayWhatMakesRoom) {
  start({.store_mib = 1});
  const std::string first(700'000, '1'), second(700'000, '2');
  ASSERT_TRUE(upload(first.size(), first).ok());
  const grpc::Status refused = upload(second.size(), second);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(
      refused.error_message(),
      "the files of scenes here have 700002 bytes, 700000 more would be too many, and this farm takes at "
      "most 1 MiB (tessera-coordinator --max-store-mib): delete jobs that nobody needs any more (tessera "
      "delete); files that no job names make room for others when they were not used for a quarter of an "
      "hour");
  EXPECT_TRUE(coordinator_->blobs().contains(proto::digest_of(first))) << "nothing that is here is lost";
  EXPECT_EQ(files_in("incoming"), 0u);
}

TEST_F(ServiceLimits, AFullStoreKeepsWhatJobsNeedAndLetsGoOfTheRest) {
  start({.store_mib = 1});
  submit_now();
  const std::string unused(700'000, '1'), wanted(700'000, '2');
  ASSERT_TRUE(upload(unused.size(), unused).ok());
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::minutes(20);
  const store::BlobStore& blobs = coordinator_->blobs();
  for (const std::string& bytes : {unused, coordinator::kSceneBytes})
    std::filesystem::last_write_time(blobs.path(proto::digest_of(bytes)), long_ago);
  EXPECT_TRUE(upload(wanted.size(), wanted).ok());
  EXPECT_FALSE(blobs.contains(proto::digest_of(unused)));
  EXPECT_TRUE(blobs.contains(proto::digest_of(coordinator::kSceneBytes)));
  EXPECT_EQ(blobs.used_bytes(), wanted.size() + coordinator::kSceneBytes.size());
}

TEST_F(ServiceLimits, HalfAnUploadCountsAsLongAsItGoesOn) {
  start({.store_mib = 1});
  const std::string half(700'000, '1'), whole(700'000, '2');
  const auto under_way = begin_upload(half);
  EXPECT_EQ(upload(whole.size(), whole).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  under_way->context.TryCancel();
  under_way->stream->Finish();
  expect_upload_in_the_end(whole);
  EXPECT_EQ(files_in("incoming"), 0u);
}

TEST_F(ServiceLimits, AnUploadThatStandsStillIsEnded) {
  start({.uploads = 1, .stall_time = std::chrono::seconds(3)});
  const std::string half(1000, '1'), whole(1000, '2');
  const auto under_way = begin_upload(half);
  const grpc::Status ended = under_way->stream->Finish();
  EXPECT_EQ(ended.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(ended.error_message(),
            "nothing has come of this upload for 3 s (tessera-coordinator --stall-seconds): send it again");
  expect_upload_in_the_end(whole);
  EXPECT_EQ(files_in("incoming"), 0u);
  EXPECT_EQ(coordinator_->blobs().used_bytes(), whole.size() + coordinator::kSceneBytes.size());
}

TEST_F(ServiceLimits, OfTheMemoryForPicturesButOneIsAlwaysMade) {
  start({.image_mib = 1});
  const std::string id = submit_large();
  const auto slow = begin_fetch(id);
  slow->stream->WaitForInitialMetadata();  // it is made, and not taken
  const auto refused = begin_fetch(id);
  const grpc::Status status = finish_fetch(*refused);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(
      status.error_message(),
      "this picture takes 54 MiB of memory, and others that are being fetched 54 MiB, and this farm takes at "
      "most 1 MiB (tessera-coordinator --max-image-mib), some of which it keeps for other callers");
  EXPECT_EQ(proto::error_from_grpc(status, refused->context).code, core::ErrorCode::kUnavailable);
  EXPECT_TRUE(finish_fetch(*slow).ok());
  grpc::StatusCode later;
  do {
    later = finish_fetch(*begin_fetch(id)).error_code();
  } while (later == grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(later, grpc::StatusCode::OK);
}

TEST_F(ServiceLimits, APictureThatIsNotTakenIsEnded) {
  start({.image_mib = 1, .stall_time = std::chrono::seconds(3)});
  const std::string id = submit_large();
  const auto slow = begin_fetch(id);
  slow->stream->WaitForInitialMetadata();
  grpc::StatusCode later;
  do {
    later = finish_fetch(*begin_fetch(id)).error_code();
  } while (later == grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(later, grpc::StatusCode::OK);
  EXPECT_EQ(finish_fetch(*slow).error_code(), grpc::StatusCode::CANCELLED);
}

TEST_F(ServiceLimits, PicturesAndExtensionsDoNotWaitForScenes) {
  start({});
  grpc::ClientContext submitting;
  v1::SubmitJobResponse submitted;
  ASSERT_TRUE(users_->SubmitJob(&submitting, submission(), &submitted).ok());
  const std::string id = submitted.job().id();
  server_.reset();
  coordinator_.reset();
  hold_up_scenes();
  start({.validations = 1});
  Submission slow;
  submit(slow);
  barrier_.wait_for_someone();
  grpc::ClientContext extending, imaging;
  v1::ExtendJobRequest extension;
  extension.set_job_id(id);
  extension.set_spp(coordinator::kSpp + 2);
  v1::ExtendJobResponse extended;
  EXPECT_TRUE(users_->ExtendJob(&extending, extension, &extended).ok());
  v1::GetImageRequest request;
  request.set_job_id(id);
  request.set_format(v1::IMAGE_FORMAT_PNG);
  const auto stream = users_->GetImage(&imaging, request);
  v1::GetImageResponse response;
  while (stream->Read(&response)) {
  }
  EXPECT_TRUE(stream->Finish().ok());
  barrier_.open();
  EXPECT_TRUE(slow.status.get_future().get().ok());
}

// Those that wait are answered without being looked at.
TEST_F(ServiceLimits, StoppingDoesNotWorkOffTheScenesThatWait) {
  std::atomic<int> checked{0};
  check_scene_ = [&](const v1::Bundle&,
                     const v1::RenderOverrides&) -> core::Result<coordinator::CheckedScene> {
    ++checked;
    barrier_.wait();
    return core::fail(core::ErrorCode::kUnavailable, "stopped");  // as the validator's process answers
  };
  start({.validations = 1});
  std::vector<std::unique_ptr<Submission>> submissions;
  for (int i = 0; i < 8; ++i) submit(*submissions.emplace_back(std::make_unique<Submission>()));
  barrier_.wait_for_someone();
  open_when_it_stops();
  EXPECT_TRUE(server_->stop());
  for (const auto& submission : submissions) EXPECT_FALSE(submission->status.get_future().get().ok());
  EXPECT_EQ(checked, 1);
}

}  // namespace
}  // namespace tessera::rpc
