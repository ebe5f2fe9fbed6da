// SPDX-License-Identifier: Apache-2.0
// Heartbeats wait for nothing that uses the disk.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/available_resources.hpp"
#include "server/farm/totals.hpp"
#include "server/rpc/reactors.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

using std::chrono::seconds;
using std::chrono::steady_clock;

// A file of the store that whoever opens it waits for, as on a disk that hangs.
class HangingFile {
 public:
  explicit HangingFile(std::filesystem::path path) : path_(std::move(path)) {
    std::filesystem::remove(path_);
    EXPECT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  }
  HangingFile(const HangingFile&) = delete;
  HangingFile& operator=(const HangingFile&) = delete;
  ~HangingFile() { let_go(); }

  void let_go() {
    if (!other_end_) other_end_ = base::Fd(::open(path_.c_str(), O_RDWR | O_CLOEXEC));
  }

 private:
  const std::filesystem::path path_;
  base::Fd other_end_;
};

class Heartbeats : public LimitedService {
 protected:
  static constexpr int kWorkers = 8;
  // At least as many as a pool has.
  static inline const int kThreads = 2 + static_cast<int>(core::available_threads());

  // The first call of each worker is answered with a lease.
  void expect_answers() {
    for (int i = 0; i < kWorkers; ++i) {
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + seconds(30));
      v1::SynchronizeResponse response;
      const grpc::Status status =
          workers_->Synchronize(&context, greeting_with_key(static_cast<char>('a' + i)), &response);
      ASSERT_TRUE(status.ok()) << status.error_message();
      EXPECT_GT(response.leases_size(), 0);
    }
  }
  std::uint64_t waiting_tasks() const {
    std::uint64_t tasks = 0;
    for (const Server::QueueDepth& queue : server_->queue_depths()) tasks += queue.tasks;
    return tasks;
  }

  struct Download {
    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReaderInterface<v1::FetchBlobResponse>> stream;
  };
  std::unique_ptr<Download> begin_download(const proto::Digest& digest) {
    auto download = std::make_unique<Download>();
    v1::FetchBlobRequest request;
    *request.mutable_digest() = proto::to_proto(digest);
    download->stream = workers_->FetchBlob(&download->context, request);
    return download;
  }
  static void finish(Download& download) {
    v1::FetchBlobResponse response;
    while (download.stream->Read(&response)) continue;
    EXPECT_FALSE(download.stream->Finish().ok());
  }

  // Every thread of the pool waits for the barrier.
  template <typename Pool>
  void hold_up(Pool& pool) {
    for (int i = 0; i < kThreads && post(pool, "caller", [this] { barrier_.wait(); }); ++i) continue;
  }
};

TEST_F(Heartbeats, AreAnsweredWhileTheDiskHangsUnderFilesThatAreFetched) {
  start({.fetches = 1000});
  submit_of_size(2000, 1000);
  const std::string bytes = "a file";
  const proto::Digest digest = proto::digest_of(bytes);
  ASSERT_TRUE(upload(bytes.size(), bytes).ok());
  HangingFile file(coordinator_->blobs().path(digest));
  std::vector<std::unique_ptr<Download>> downloads;
  for (int i = 0; i < 2 * kThreads; ++i) downloads.push_back(begin_download(digest));
  const auto late = steady_clock::now() + seconds(60);
  bool some_wait = false;
  while (!some_wait && steady_clock::now() < late) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    some_wait = waiting_tasks() >= 2;
  }
  EXPECT_TRUE(some_wait) << "all threads for files wait for the disk";
  expect_answers();
  file.let_go();
  for (const auto& download : downloads) finish(*download);
}

TEST_F(Heartbeats, AreAnsweredWhileEveryOtherThreadIsHeldUp) {
  start({});
  submit_of_size(2000, 1000);
  const Pools pools = server_->services().pools;
  for (base::ThreadPool* const pool : {&pools.results, &pools.receiving, &pools.sending}) hold_up(*pool);
  for (base::FairPool* const pool : {&pools.users, &pools.watching, &pools.slow, &pools.clearing})
    hold_up(*pool);
  const std::string bytes = "a file";
  auto uploaded = std::async(std::launch::async, [&] { return upload(bytes.size(), bytes); });
  expect_answers();
  EXPECT_EQ(uploaded.wait_for(seconds(0)), std::future_status::timeout) << "it has threads of its own";
  barrier_.open();
  EXPECT_TRUE(uploaded.get().ok());
}

// By themselves they would wait for some minutes.
TEST_F(Heartbeats, OfCallersThatHaveGoneAreRemovedAtOnce) {
  lease_duration_ = std::chrono::minutes(10);
  start({});
  const auto waiting = [this] { return farm::totals_of(coordinator_->farm()).waiting_calls; };
  grpc::ClientContext context;
  const v1::SynchronizeRequest request = greeting_with_key('a');
  v1::SynchronizeResponse response;
  std::promise<grpc::StatusCode> ended;
  workers_->async()->Synchronize(&context, &request, &response,
                                 [&](const grpc::Status& status) { ended.set_value(status.error_code()); });
  const auto late = steady_clock::now() + seconds(60);
  while (waiting() == 0 && steady_clock::now() < late) std::this_thread::yield();
  ASSERT_EQ(waiting(), 1u);
  context.TryCancel();
  EXPECT_EQ(ended.get_future().get(), grpc::StatusCode::CANCELLED);
  while (waiting() > 0 && steady_clock::now() < late) std::this_thread::yield();
  EXPECT_EQ(waiting(), 0u);
}

}  // namespace
}  // namespace tessera::rpc
