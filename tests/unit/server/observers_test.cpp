// SPDX-License-Identifier: Apache-2.0
// Observers that are slow to answer delay nobody else.
#include <atomic>
#include <chrono>
#include <future>

#include "server/rpc/stall_watch.hpp"
#include "server/rpc/watch_hub.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

using namespace std::chrono_literals;

constexpr auto kFarTooLong = 60s;  // for steps that take microseconds on an idle machine

bool returns(const std::function<void()>& call, std::future<void>& done) {
  done = std::async(std::launch::async, call);
  return done.wait_for(kFarTooLong) == std::future_status::ready;
}

// Blocks in every call, except for the first calls of all.
class Held {
 public:
  explicit Held(int free_calls) : free_calls_(free_calls) {}
  void call() {
    if (free_calls_-- <= 0) barrier_.wait();
  }
  void wait_for_call() { barrier_.wait_for_someone(); }
  void let_go() { barrier_.open(); }

 private:
  std::atomic<int> free_calls_;
  Barrier barrier_;
};

class HeldStream final : public Held, public WatchedStream {
 public:
  HeldStream() : Held(0) {}
  void end_if_waiting_since(Clock::time_point) override { call(); }
};

class HeldWatcher final : public Held, public Watcher {
 public:
  explicit HeldWatcher(std::string job_id) : Held(1), job_id_(std::move(job_id)) {}
  const std::string& job_id() const override { return job_id_; }
  void tell(const core::Result<v1::Job>&) override { call(); }

 private:
  const std::string job_id_;
};

// While one observer is being called, others are added and removed; it is removed after the call.
template <typename List, typename Observer>
void expect_nobody_is_kept_up(List& list, Observer& held, Observer& other) {
  list.add(held);
  held.wait_for_call();
  std::future<void> others, own;
  EXPECT_TRUE(returns(
      [&] {
        list.add(other);
        list.remove(other);
      },
      others));
  own = std::async(std::launch::async, [&] { list.remove(held); });
  EXPECT_EQ(own.wait_for(100ms), std::future_status::timeout) << "it is called still";
  held.let_go();
  other.let_go();
}

TEST(StallWatchTest, OneThatIsAskedKeepsUpNobody) {
  HeldStream held, other;
  StallWatch watch(40ms);
  expect_nobody_is_kept_up(watch, held, other);
}

class WatchHubTest : public LimitedService {};

TEST_F(WatchHubTest, OneThatIsToldKeepsUpNobody) {
  start({});
  const std::string job = submit_now();
  HeldWatcher held(job), other(job);
  WatchHub hub(*coordinator_);
  expect_nobody_is_kept_up(hub, held, other);
}

// Also those that are added after the end.
TEST_F(WatchHubTest, AllAreToldThatItIsClosed) {
  struct Listener final : Watcher {
    const std::string& job_id() const override { return id; }
    void tell(const core::Result<v1::Job>& job) override {
      if (!job && job.error().code == core::ErrorCode::kUnavailable) closed = true;
    }
    std::string id;
    std::atomic<bool> closed{false};
  };
  start({});
  Listener early, late;
  early.id = late.id = submit_now();
  WatchHub hub(*coordinator_);
  hub.add(early);
  EXPECT_FALSE(early.closed);
  hub.close();
  EXPECT_TRUE(early.closed);
  hub.add(late);
  EXPECT_TRUE(late.closed);
  hub.remove(early);
  hub.remove(late);
}

TEST(ObserverListTest, CallsEachOnceInARound) {
  ObserverList<int> list;
  int numbers[5] = {};
  for (int& number : numbers) list.add(number);
  list.remove(numbers[3]);
  list.for_each([&](int& number) {
    ++number;
    if (&number == &numbers[0]) list.remove(numbers[1]);
  });
  EXPECT_EQ(numbers[0] + numbers[2] + numbers[4], 3);
  EXPECT_EQ(numbers[3], 0);
  EXPECT_EQ(numbers[1], 0);
}

}  // namespace
}  // namespace tessera::rpc
