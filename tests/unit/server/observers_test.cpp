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

// Blocks in every call.
class Held {
 public:
  void call() { barrier_.wait(); }
  void wait_for_call() { barrier_.wait_for_someone(); }
  void let_go() { barrier_.open(); }

 private:
  Barrier barrier_;
};

class HeldStream final : public Held, public WatchedStream {
 public:
  void end_if_waiting_since(Clock::time_point) override { call(); }
};

// Blocks in the rounds of the hub: nothing changes, but whoever is added is told at once that it may have.
class HeldWatcher final : public Held, public Watcher {
 public:
  explicit HeldWatcher(std::string job_id) : job_id_(std::move(job_id)) {}
  const std::string& job_id() const override { return job_id_; }
  bool notify(bool changed) override {
    if (!changed) call();
    return true;
  }
  void close() override {}

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

TEST(StallWatchTest, APollDoesNotBlockOthers) {
  HeldStream held, other;
  StallWatch watch(40ms);
  expect_nobody_is_kept_up(watch, held, other);
}

TEST(WatchHubTest, ANotificationDoesNotBlockOthers) {
  events::EventLog log(1);
  HeldWatcher held("job"), other("job");
  WatchHub hub(log);
  expect_nobody_is_kept_up(hub, held, other);
}

// Counts what it is told.
class CountingWatcher final : public Watcher {
 public:
  explicit CountingWatcher(std::string job_id) : job_id_(std::move(job_id)) {}
  const std::string& job_id() const override { return job_id_; }
  bool notify(bool changed) override {
    ++rounds;
    changes += changed ? 1 : 0;
    return wants_more;
  }
  void close() override { closed = true; }

  std::atomic<int> rounds{0}, changes{0};
  std::atomic<bool> closed{false}, wants_more{false};

 private:
  const std::string job_id_;
};

void wait_for(const std::function<bool()>& condition) {
  const auto late = std::chrono::steady_clock::now() + kFarTooLong;
  while (!condition()) {
    ASSERT_LT(std::chrono::steady_clock::now(), late);
    std::this_thread::sleep_for(1ms);
  }
}

TEST(WatchHubTest, NotifiesThoseWhomAChangeConcerns) {
  events::EventLog log(1);
  CountingWatcher one("one"), two("two"), all("");
  WatchHub hub(log);
  for (CountingWatcher* watcher : {&one, &two, &all}) hub.add(*watcher);
  EXPECT_EQ(one.changes, 1) << "at once";
  log.append(events::SubjectKind::kJob, "one");
  wait_for([&] { return one.changes == 2 && all.changes >= 2; });
  log.append(events::SubjectKind::kWorker, "two");
  const int before = all.changes;
  wait_for([&] { return all.changes > before; });
  EXPECT_EQ(two.changes, 1) << "a worker of that id is no job";
  for (CountingWatcher* watcher : {&one, &two, &all}) hub.remove(*watcher);
}

TEST(WatchHubTest, PollsWhileThereAreWatchers) {
  events::EventLog log(1);
  CountingWatcher watcher("job");
  WatchHub hub(log);
  watcher.wants_more = true;
  hub.add(watcher);
  wait_for([&] { return watcher.rounds >= 3; });
  EXPECT_EQ(watcher.changes, 1);
  watcher.wants_more = false;
  hub.remove(watcher);
}

// Also those that are added after the end.
TEST(WatchHubTest, ClosesAll) {
  events::EventLog log(1);
  CountingWatcher early("job"), late("job");
  WatchHub hub(log);
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
