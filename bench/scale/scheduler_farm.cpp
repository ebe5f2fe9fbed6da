// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/scheduler_farm.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <utility>

namespace tessera::scheduler {
namespace {

// So many samples that no job is ever done.
const JobShape kJob{1920, 1080, 1u << 20};
constexpr int kLeases = 2;
constexpr double kRenderSeconds = 2;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A random id, as those of jobs and workers are.
std::string id_of(int number) {
  const auto mix = [](std::uint64_t value) {
    value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9;
    value = (value ^ value >> 27) * 0x94d049bb133111eb;
    return value ^ value >> 31;
  };
  const auto seed = static_cast<std::uint64_t>(number);
  return fmt::format("{:016x}{:016x}", mix(2 * seed + 1), mix(2 * seed + 2));
}

template <typename Check>
double seconds_of_check(const Check& check) {
  const double start = cpu_seconds();
  const auto wrong = check();
  const double seconds = cpu_seconds() - start;
  if (!wrong) return seconds;
  fmt::print(stderr, "{}\n", *wrong);
  std::abort();
}

}  // namespace

void SchedulerFarm::add_jobs(int count) {
  for (; count > 0; --count) handle(SubmitJob{{id_of(++jobs_)}, kJob});
}

void SchedulerFarm::add_workers(int count) {
  const std::size_t first = workers_.size();
  for (; count > 0; --count) {
    const auto number = static_cast<int>(workers_.size());
    const std::string name = fmt::format("node-{:05}", number);
    workers_.push_back({{{id_of(number)}, name, "0.2.0", 1, name}, {}});
    synchronize(workers_.back());
  }
  // The first leases are those of workers of unknown speed.
  for (std::size_t w = first; w < workers_.size(); ++w) {
    deliver_all(workers_[w]);
    synchronize(workers_[w]);
    synchronize(workers_[w]);
  }
}

SchedulerFarm::BusyWorker& SchedulerFarm::next_worker() {
  constexpr std::size_t kStride = 7919;  // a prime: neighbours in memory do not follow each other
  turn_ = (turn_ + kStride) % workers_.size();
  return workers_[turn_];
}

Actions SchedulerFarm::handle(const Event& event) {
  return scheduler_.handle(event, now_ += std::chrono::microseconds(1));
}

double SchedulerFarm::seconds_of(const Event& event, Actions* actions) {
  const double start = cpu_seconds();
  Actions result = handle(event);
  const double seconds = cpu_seconds() - start;
  *actions = std::move(result);
  return seconds;
}

bool SchedulerFarm::is_behind() const {
  const std::optional<Time> due = scheduler_.next_deadline();
  return due && *due <= now_;
}

SubmitResult SchedulerFarm::result_of(const BusyWorker& worker, const LeaseDescription& lease) {
  SubmitResult result{worker.info.id, lease.job, lease.id, lease.items, kRenderSeconds, true};
  result.fingerprints.resize(lease.items.size());
  return result;
}

void SchedulerFarm::deliver_all(BusyWorker& worker) {
  for (const LeaseDescription& lease : worker.leases) handle(result_of(worker, lease));
  worker.leases.clear();
}

double SchedulerFarm::synchronize(BusyWorker& worker) {
  Actions actions;
  const double seconds = seconds_of(Synchronize{worker.info, worker.leases, kLeases}, &actions);
  worker.leases = actions.reply->leases;
  return seconds;
}

double SchedulerFarm::synchronize_with_two_grants() {
  BusyWorker& worker = next_worker();
  deliver_all(worker);
  return synchronize(worker);
}

double SchedulerFarm::renew() {
  return synchronize(next_worker());
}

double SchedulerFarm::deliver() {
  BusyWorker& worker = next_worker();
  const LeaseDescription lease = worker.leases.front();
  worker.leases.erase(worker.leases.begin());
  Actions actions;
  const double seconds = seconds_of(result_of(worker, lease), &actions);
  synchronize(worker);
  return seconds;
}

double SchedulerFarm::tick() {
  Actions actions;
  return seconds_of(Tick{}, &actions);
}

double SchedulerFarm::check() {
  return seconds_of_check([this] { return scheduler_.check_invariants(CheckDepth::kCounters); });
}

double SchedulerFarm::check_slice() {
  return seconds_of_check([this] { return scheduler_.check_some(cursor_, 100); });
}

}  // namespace tessera::scheduler
