// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/rare_events.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/scale/scheduler_farm.hpp"

namespace tessera::scheduler {
namespace {

const JobShape kLargeJob{32768, 32768, 1u << 16};
constexpr int kWorkers = 10'000, kProducers = 1'000;

// The job as a coordinator restores it when every tile has its first sample.
RestoreJob large_job() {
  RestoreJob job{{"large"}, kLargeJob, 0, JobState::kRunning, "", {}, 0, {}};
  for (int tile = 0; tile < kLargeJob.grid().tile_count(); ++tile) {
    const std::string name = fmt::format("producer-{}", tile % kProducers);
    job.done.push_back({{0, 1}});
    job.provenance.push_back({{tile, {0, 1}}, {name, {name}, name}, {}, Due::kNo});
  }
  return job;
}

struct Times {
  double event = 0, longest_tick = 0;
  int ticks = 0;
};

Times measure(SchedulerFarm& farm, const Event& event) {
  std::vector<Actions> kept;  // destroyed when nobody waits
  Times times;
  times.event = farm.seconds_of(event, &kept.emplace_back());
  for (; farm.is_behind(); ++times.ticks)
    times.longest_tick = std::max(times.longest_tick, farm.seconds_of(Tick{}, &kept.emplace_back()));
  return times;
}

void print(const char* what, const std::function<Times()>& run) {
  const Times times = run();
  fmt::print("| {} | {:.3f} | {} | {:.3f} |\n", what, 1e3 * times.event, times.ticks,
             1e3 * times.longest_tick);
  std::fflush(stdout);
}

std::unique_ptr<SchedulerFarm> farm_with_large_job(int workers) {
  auto farm = std::make_unique<SchedulerFarm>();
  farm->handle(large_job());
  farm->add_workers(workers);
  return farm;
}

}  // namespace

void print_rare_events() {
  fmt::print("| event | ms | ticks that follow | the longest, ms |\n|---|--:|--:|--:|\n");
  print("submit a job of 32,768 x 32,768 pixels", [] {
    SchedulerFarm farm;
    return measure(farm, SubmitJob{{"large"}, kLargeJob});
  });
  print("extend it", [] {
    return measure(*farm_with_large_job(1), ExtendJob{{"large"}, kLargeJob.spp * 2});
  });
  print("cancel it, with 20,000 leases",
        [] { return measure(*farm_with_large_job(kWorkers), CancelJob{{"large"}}); });
  print("delete it, with 20,000 leases",
        [] { return measure(*farm_with_large_job(kWorkers), DeleteJob{{"large"}}); });
  print("distrust a worker that has rendered 262 tiles of it", [] {
    const auto farm = farm_with_large_job(1);
    farm->handle(Synchronize{{{"producer-7"}, "producer-7", "0.2.0", 1, "producer-7"}, {}, 0});
    return measure(*farm, Dismiss{{"producer-7"}, true});
  });
  print("submit a job while 10,000 idle workers wait", [] {
    SchedulerFarm farm;
    farm.add_workers(kWorkers);
    return measure(farm, SubmitJob{{"job"}, {1920, 1080, 1u << 16}});
  });
  print("10,000 workers fall silent with 20,000 leases", [] {
    const auto farm = farm_with_large_job(kWorkers);
    farm->pass(std::chrono::seconds(10));
    return measure(*farm, Tick{});
  });
}

}  // namespace tessera::scheduler
