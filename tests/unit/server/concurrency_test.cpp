// SPDX-License-Identifier: Apache-2.0
// Workers, users, checkpoints and time on their own threads at once, to find races.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <future>
#include <thread>
#include <vector>

#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

class Concurrency : public ScriptedFarm {
 protected:
  // Waits for the answer.
  core::Result<v1::SynchronizeResponse> synchronize_blocking(char worker) {
    std::promise<core::Result<v1::SynchronizeResponse>> promise;
    farm::SynchronizeCaller caller;
    caller.answer = [&](core::Result<v1::SynchronizeResponse> result) {
      promise.set_value(std::move(result));
    };
    coordinator().dispatcher().synchronize(greeting(worker), std::move(caller));
    return promise.get_future().get();
  }
  void wait_until_done(const std::string& id) {
    while (job(id).state() != v1::JOB_STATE_DONE) std::this_thread::yield();
  }
  void work_until_closed(char worker) {
    while (const auto response = synchronize_blocking(worker)) {
      for (const v1::Lease& lease : response->leases()) {
        // Delivers it twice: the second result is dropped, since nobody else can deliver it.
        EXPECT_TRUE(coordinator().dispatcher().submit_result(delivery(worker, lease)));
        EXPECT_TRUE(coordinator().dispatcher().submit_result(delivery(worker, lease)));
        EXPECT_FALSE(coordinator().dispatcher().submit_result(delivery('d', lease)));
      }
    }
  }
};

TEST_F(Concurrency, NothingIsLostOrCountedTwice) {
  constexpr std::uint32_t kExtendedSpp = 40;
  const std::vector<std::string> jobs{submit(), submit()};
  std::atomic<bool> stopping = false;
  std::vector<std::thread> threads;
  const auto repeat = [&](std::function<void()> action) {
    threads.emplace_back([&stopping, action = std::move(action)] {
      while (!stopping) action();
    });
  };
  for (const char worker : {'a', 'b', 'c'})
    threads.emplace_back([this, worker] { work_until_closed(worker); });
  repeat([&] { EXPECT_TRUE(coordinator().checkpointer().checkpoint()); });
  repeat([&] { coordinator().dispatcher().tick(); });
  repeat([&] { EXPECT_TRUE(coordinator().images().get(jobs[0])); });
  repeat([&] { EXPECT_EQ(listed().size(), jobs.size()); });
  for (std::uint32_t spp = kSpp + 1; spp <= kExtendedSpp; ++spp) {
    for (const std::string& id : jobs) EXPECT_TRUE(coordinator().jobs().extend(id, spp));
    if (!coordinator().jobs().pause(jobs[0])) wait_until_done(jobs[0]);
    if (!coordinator().jobs().resume(jobs[0])) wait_until_done(jobs[0]);
  }
  for (const std::string& id : jobs) wait_until_done(id);
  stopping = true;
  coordinator().close();
  for (std::thread& thread : threads) thread.join();

  const core::Image expected = ready_made_image(kWidthPx, kHeightPx, kExtendedSpp);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  for (const std::string& id : jobs) {
    EXPECT_EQ(coordinator().images().get(id)->image.pixels, expected.pixels);
    EXPECT_EQ(job(id).counters().samples(), std::uint64_t{kWidthPx} * kHeightPx * kExtendedSpp);
  }
}

}  // namespace
}  // namespace tessera::server
