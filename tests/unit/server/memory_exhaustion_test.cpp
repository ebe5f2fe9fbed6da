// SPDX-License-Identifier: Apache-2.0
// What the coordinator does when operator new fails, at any allocation: the call fails, or it has its whole
// effect.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "proto/error_reasons.hpp"
#include "server/farm/state_lock.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace {

constexpr long kUnlimited = std::numeric_limits<long>::max();

// The allocations of this thread that succeed before the next ones fail.
thread_local long allocations_left = kUnlimited;
// Those that a part of the memory reserve is good for at least: where the C library cannot extend an arena,
// it maps pages of 4 KiB for each allocation.
constexpr long kAllocationsOfPart = 512;
thread_local int parts_used = 0;

}  // namespace

void* operator new(std::size_t size) {
  while (true) {
    const bool may = allocations_left > 0;
    if (may && allocations_left != kUnlimited) --allocations_left;
    if (void* const memory = may ? std::malloc(size == 0 ? 1 : size) : nullptr) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
    ++parts_used;
    allocations_left = kAllocationsOfPart;
  }
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace tessera::server {
namespace {

// Calls, in which no allocation after the first few succeeds. Returns whether it throws std::bad_alloc.
template <typename Call>
bool runs_out(long allocations, Call call) {
  parts_used = 0;
  allocations_left = allocations;
  bool thrown = false;
  try {
    call();
  } catch (const std::bad_alloc&) {
    thrown = true;
  }
  allocations_left = kUnlimited;
  return thrown;
}

class MemoryExhaustion : public ScriptedFarm {
 protected:
  MemoryExhaustion() { open(); }

  void SetUp() override {
#ifdef TESSERA_SANITIZED
    GTEST_SKIP() << "sanitizers end a program that the system denies memory";
#endif
  }

  // While it lives, the reserve lacks a part, and no memory can be had from the system.
  class Shortage {
   public:
    explicit Shortage(base::MemoryReserve& reserve) {
      EXPECT_EQ(getrlimit(RLIMIT_AS, &before_), 0);
      const rlimit none{1, before_.rlim_max};
      EXPECT_EQ(setrlimit(RLIMIT_AS, &none), 0);
      runs_out(0, [&] {
        const base::MemoryReserve::Scope scope(reserve);
        delete new int;
      });
    }
    ~Shortage() { EXPECT_EQ(setrlimit(RLIMIT_AS, &before_), 0); }
    Shortage(const Shortage&) = delete;
    Shortage& operator=(const Shortage&) = delete;

   private:
    rlimit before_{};
  };

  // A call whose answer does not matter.
  farm::SynchronizeCaller nobody() {
    farm::SynchronizeCaller caller;
    caller.answer = [](core::Result<v1::SynchronizeResponse>) {};
    caller.is_gone = [] { return false; };
    return caller;
  }

  void expect_sound() {
    const farm::StateLock lock(coordinator().farm());
    const auto broken = lock->scheduler.check_invariants(scheduler::CheckDepth::kEverySample);
    ASSERT_FALSE(broken) << *broken;
  }
  void expect_image(const std::string& id) {
    EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
    EXPECT_EQ(coordinator().images().get(id)->image.pixels,
              ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
  }
};

TEST_F(MemoryExhaustion, AResultIsCountedOnceOrNotAtAll) {
  std::vector<std::string> jobs;
  int thrown = 0, in_decisions = 0;
  long allocations = 0;
  for (bool all = false; !all;) {
    jobs.push_back(submit());
    while (true) {
      const WaitingCall call(coordinator(), greeting('a'));
      if (!call.answered()) break;
      ASSERT_TRUE(call.answer()) << call.answer().error().message;
      for (const v1::Lease& lease : call.answer()->leases()) {
        const v1::SubmitResultRequest request = delivery('a', lease);
        core::Result<v1::SubmitResultResponse> result = v1::SubmitResultResponse();
        while (runs_out(allocations++, [&] { result = coordinator().dispatcher().submit_result(request); })) {
          ++thrown;
          expect_sound();
        }
        ASSERT_TRUE(result) << result.error().message;
        in_decisions += parts_used > 0;
        all = parts_used == 0;
        expect_sound();
      }
    }
  }
  EXPECT_GT(thrown, 20);
  EXPECT_GT(in_decisions, 20);
  for (const std::string& job : jobs) expect_image(job);
}

TEST_F(MemoryExhaustion, AHeartbeatLosesNoLease) {
  const std::string id = submit();
  int thrown = 0;
  parts_used = 1;
  for (long allocations = 0; parts_used > 0 || allocations < 50; ++allocations) {
    const bool failed =
        runs_out(allocations, [&] { coordinator().dispatcher().synchronize(greeting('a'), nobody()); });
    thrown += failed;
    if (failed) parts_used = 1;
    expect_sound();
  }
  EXPECT_GT(thrown, 5);
  work('a');
  expect_image(id);
}

void expect_try_later(const core::Error& error) {
  EXPECT_EQ(error.code, core::ErrorCode::kResourceExhausted);
  EXPECT_EQ(core::details_of(error).reason, proto::kTryLater);
  EXPECT_EQ(core::details_of(error).retry_delay_ms, 1000U);
}

TEST_F(MemoryExhaustion, CallsAreRefusedUntilTheReserveIsBack) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  const v1::SubmitResultRequest request = delivery('a', lease);
  std::vector<core::Error> errors;
  {
    const Shortage shortage(coordinator().farm().memory_reserve());
    const auto refused = coordinator().dispatcher().submit_result(request);
    if (!refused) errors.push_back(refused.error());
    const WaitingCall call(coordinator(), greeting('a'));
    if (call.answered() && !call.answer()) errors.push_back(call.answer().error());
    const auto submitted = coordinator().jobs().submit(submission(), "");
    if (!submitted) errors.push_back(submitted.error());
    for (const auto& changed : {coordinator().jobs().extend(id, kSpp + 1), coordinator().jobs().pause(id),
                                coordinator().jobs().cancel(id)})
      if (!changed) errors.push_back(changed.error());
    if (const auto removed = coordinator().jobs().remove(id); !removed) errors.push_back(removed.error());
  }
  EXPECT_EQ(errors.size(), 7U);
  for (const core::Error& error : errors) expect_try_later(error);
  EXPECT_EQ(coordinator().dispatcher().result_counts().rejected(dispatch::RejectedFor::kMemory), 1U);
  expect_sound();

  EXPECT_EQ(deliver(request).accepted_items(), static_cast<std::uint32_t>(request.items_size()));
  work('a');
  expect_image(id);
}

TEST_F(MemoryExhaustion, AValidatedJobWaitsForMemory) {
  const std::string id = coordinator().jobs().submit(submission(), "")->id();
  {
    const Shortage shortage(coordinator().farm().memory_reserve());
    coordinator().jobs().validate(id);
  }
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_VALIDATING);
  coordinator().jobs().validate(id);
  work('a');
  expect_image(id);
}

// Here without the reserve, which StateLock provides.
TEST(SchedulerMemory, AJobIsKnownOnceItIsThere) {
  int thrown = 0;
  for (long allocations = 0;; ++allocations) {
    scheduler::Scheduler scheduler{scheduler::Options()};
    const scheduler::JobId id{std::string(32, '1')};
    const scheduler::Event event = scheduler::SubmitJob{id, {512, 512, 64}};
    const bool failed = runs_out(allocations, [&] { scheduler.handle(event, {}); });
    EXPECT_NO_THROW(scheduler.job(id, {}));
    if (!failed) break;
    ++thrown;
  }
  EXPECT_GT(thrown, 5);
}

// Whether a thread of this process sleeps.
bool sleeps(pid_t thread) {
  std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/stat");
  std::string number, name, state;
  file >> number >> name >> state;
  return state == "S";
}

// What one holder of the lock has used is missing for the next, which may wait already.
TEST_F(MemoryExhaustion, ACallThatWaitsForTheLockIsRefused) {
  core::Status expected;
  std::atomic<pid_t> waiting = 0;
  std::thread next;
  {
    const farm::StateLock lock(coordinator().farm());
    next = std::thread([&] {
      waiting = gettid();
      expected = farm::StateLock(coordinator().farm()).expect_memory();
    });
    while (waiting == 0 || !sleeps(waiting)) std::this_thread::yield();
    EXPECT_FALSE(runs_out(0, [] { delete new int; }));
  }
  next.join();
  ASSERT_FALSE(expected);
  expect_try_later(expected.error());
  EXPECT_TRUE(farm::StateLock(coordinator().farm()).expect_memory());
}

TEST_F(MemoryExhaustion, WhatIsDeferredLeavesTheReserveOfDecisionsAlone) {
  bool is_full = false;
  farm::StateLock(coordinator().farm()).later([&] {
    EXPECT_FALSE(runs_out(0, [] { delete new int; }));
    is_full = coordinator().farm().memory_reserve().is_full();
  });
  EXPECT_EQ(parts_used, 1);
  EXPECT_TRUE(is_full);
}

TEST_F(MemoryExhaustion, TheReserveIsEnoughToOfferWorkToManyWorkers) {
  const std::string workers = "0123456789abcdef";
  v1::SubmitJobRequest large = submission();
  large.mutable_overrides()->set_width_px(1920);
  large.mutable_overrides()->set_height_px(1080);
  large.mutable_overrides()->set_spp(64);
  const std::string id = submit(large);
  for (const char worker : workers) {  // so fast that their next leases have as many items as possible
    v1::SubmitResultRequest request = delivery(worker, synchronize(greeting(worker)).leases(0));
    request.mutable_render_time()->set_seconds(0);
    request.mutable_render_time()->set_nanos(1000);
    deliver(request);
  }
  ASSERT_TRUE(coordinator().jobs().pause(id));
  std::vector<std::unique_ptr<WaitingCall>> calls;
  for (const char worker : workers) {
    v1::SynchronizeRequest request = greeting(worker);
    request.set_wanted_leases(scheduler::kMaxLeasesPerWorker);
    calls.push_back(std::make_unique<WaitingCall>(coordinator(), request));
  }
  std::optional<farm::StateLock> lock;
  lock.emplace(coordinator().farm());
  EXPECT_FALSE(runs_out(0, [&] { lock->handle(scheduler::ResumeJob{{id}}); }));
  EXPECT_LE(parts_used, static_cast<int>(base::MemoryReserve::kParts) * 3 / 4);
  EXPECT_FALSE(runs_out(0, [&] { lock.reset(); }));  // their answers
  EXPECT_LE(parts_used, static_cast<int>(base::MemoryReserve::kParts) / 2);
  std::size_t items = 0;
  for (const auto& call : calls) {
    ASSERT_TRUE(call->answered());
    for (const v1::Lease& lease : call->answer()->leases())
      items += static_cast<std::size_t>(lease.items_size());
  }
  EXPECT_EQ(items, calls.size() * scheduler::kMaxLeasesPerWorker * scheduler::kMaxItemsPerLease);
  expect_sound();
}

}  // namespace
}  // namespace tessera::server
