// SPDX-License-Identifier: Apache-2.0
// The scheduler's basic types: ids, times, work items. Plain values.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/film/region.hpp"
#include "server/scheduler/job_shape.hpp"

namespace tessera::scheduler {

// The scheduler never reads a clock; times are arguments. Only differences matter.
using Time = std::chrono::steady_clock::time_point;
using Duration = std::chrono::steady_clock::duration;

template <typename Tag>
struct TextId {
  std::string value;
  auto operator<=>(const TextId&) const = default;
};
using JobId = TextId<struct JobTag>;
using WorkerId = TextId<struct WorkerTag>;

// Numbers jobs in the order of submission. Never reused.
using JobNumber = std::uint64_t;
// Numbers the runs of jobs. A run ends when its job is done, cancelled, failed or deleted. Never reused.
using RunNumber = std::uint64_t;

inline constexpr int kLeaseCounterBits = 40;

// The coordinator's epoch in the upper 24 bits, a counter from 1 in the lower 40. Never reused.
struct LeaseId {
  std::uint64_t value = 0;
  auto operator<=>(const LeaseId&) const = default;
};

struct LeaseIdHash {
  std::size_t operator()(LeaseId id) const { return std::hash<std::uint64_t>{}(id.value); }
};

// The unit of work: a range of samples of one tile of the job, in the numbering of its JobGrid.
struct WorkItem {
  int tile = 0;
  core::SampleRange samples;
  bool operator==(const WorkItem&) const = default;
};

// Proves that this farm granted a lease to a worker. It cannot be made without the farm's secret.
using LeaseToken = std::string;

// Makes the token of a lease. A pure function of its arguments and the farm's secret, equal in every run of
// the coordinator.
using SignLease = std::function<LeaseToken(LeaseId lease, const WorkerId& holder, const JobId& job)>;

// A lease as both sides of the protocol know it.
struct LeaseDescription {
  LeaseId id;
  JobId job;
  std::vector<WorkItem> items;
  LeaseToken token{};
  bool operator==(const LeaseDescription&) const = default;
};

inline constexpr std::size_t kMaxItemsPerLease = 32;
inline constexpr int kMaxLeasesPerWorker = 4;

}  // namespace tessera::scheduler
