// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/policy.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace tessera::scheduler {

double expected_speed(const SizingOptions& options, const WorkerSnapshot& worker) {
  const double assumed = std::max(worker.threads, 1) * options.assumed_samples_per_second_and_thread;
  return worker.samples_per_second.value_or(assumed);
}

double expected_mean_speed(const SizingOptions& options, const WorkerSnapshot& worker) {
  return worker.mean_samples_per_second ? *worker.mean_samples_per_second : expected_speed(options, worker);
}

LeaseSize next_lease_size(const SizingOptions& options, const WorkerSnapshot& worker, std::uint64_t available,
                          int active_workers) {
  const double seconds = worker.samples_per_second ? options.lease_seconds : options.first_lease_seconds;
  const double most = std::max(static_cast<double>(available), 1.0);
  const double fair_part = most / (options.end_divisor * std::max(active_workers, 1));
  // A speed that is NaN gives 1, and a speed beyond all limits gives everything that is available.
  const auto size = [&](double speed) {
    const double samples =
        std::max(std::min(speed * seconds, fair_part), speed * options.shortest_lease_seconds);
    return samples > 1 ? std::min(std::floor(samples), most) : 1;
  };
  return {size(expected_mean_speed(options, worker)), size(expected_speed(options, worker))};
}

double cost_of(const SizingOptions& options, const Estimate& cost) {
  return cost.results > 0 ? cost.value : 1.0 / options.assumed_samples_per_second_and_thread;
}

void learn_cost(Estimate& cost, Estimate& pace, int threads, double seconds_per_sample) {
  constexpr double kMinCost = 1e-9, kMaxCost = 100, kMinPace = 1e-6, kMaxPace = 1e9;
  constexpr double kMaxChange = 10;
  // The fewer results an estimate has, the larger its part of the difference.
  const auto weight = [](const Estimate& estimate) {
    constexpr double kMin = 0.1;
    return std::max(kMin, 1 / (1 + static_cast<double>(estimate.results)));
  };
  if (pace.results == 0)
    pace.value = std::clamp(cost.results > 0 ? cost.value / seconds_per_sample : threads, kMinPace, kMaxPace);
  if (cost.results == 0) cost.value = std::clamp(pace.value * seconds_per_sample, kMinCost, kMaxCost);
  const double longer = std::clamp(pace.value * seconds_per_sample / cost.value, 1 / kMaxChange, kMaxChange);
  cost.value = std::clamp(cost.value * std::pow(longer, weight(cost)), kMinCost, kMaxCost);
  pace.value = std::clamp(pace.value / std::pow(longer, weight(pace)), kMinPace, kMaxPace);
  ++cost.results, ++pace.results;
}

bool chosen_for_audit(double share, std::uint64_t secret, const JobId& job, const WorkItem& item) {
  // A step of splitmix64 (Steele et al. 2014) for each part of the key.
  std::uint64_t hash = secret;
  const auto mix = [&hash](std::uint64_t value) {
    hash += value + 0x9e3779b97f4a7c15;
    hash = (hash ^ hash >> 30) * 0xbf58476d1ce4e5b9;
    hash = (hash ^ hash >> 27) * 0x94d049bb133111eb;
    hash ^= hash >> 31;
  };
  for (const char c : job.value) mix(static_cast<unsigned char>(c));
  mix(static_cast<std::uint64_t>(item.tile));
  mix(std::uint64_t{item.samples.begin} << 32 | item.samples.end);
  return static_cast<double>(hash >> 11) * 0x1p-53 < share;
}

Duration longest_patience(Duration lease_duration) {
  constexpr int kMax = 360;
  return kMax * lease_duration;
}

Duration patience(Duration lease_duration, double expected_seconds) {
  constexpr int kMin = 10;
  constexpr double kTimesExpected = 10;
  const double most = std::chrono::duration<double>(longest_patience(lease_duration)).count();
  // NaN gives the maximum.
  const double seconds = kTimesExpected * expected_seconds < most ? kTimesExpected * expected_seconds : most;
  return std::max<Duration>(kMin * lease_duration,
                            std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds)));
}

Duration cooldown_after(Duration without_progress, int times_before) {
  constexpr int kMaxDoublings = 10;
  return without_progress * (1 << std::min(times_before, kMaxDoublings));
}

std::size_t choose_job(std::span<const JobSnapshot> jobs) {
  const auto rank = [](const JobSnapshot& job) {
    return std::make_tuple(-static_cast<std::int64_t>(job.priority), job.start, job.last_served);
  };
  const auto best =
      std::min_element(jobs.begin(), jobs.end(),
                       [&](const JobSnapshot& a, const JobSnapshot& b) { return rank(a) < rank(b); });
  return static_cast<std::size_t>(best - jobs.begin());
}

}  // namespace tessera::scheduler
