// SPDX-License-Identifier: Apache-2.0
// The settings of a scheduler. Plain values.
#pragma once

#include <chrono>
#include <cstdint>

#include "server/scheduler/policy.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// How much a single event does at most of what can wait, so that none takes long because a farm is large.
// What is left is done with the next events, and does not change what each worker is told.
struct WorkPerEvent {
  // Silent workers that lose their leases or are forgotten, and waiting workers that are woken by new work.
  int expired_workers = 64, woken_workers = 16;
  // Leases of jobs that have ended.
  int revoked_leases = 64;
  // Tiles that are searched for samples of distrusted workers, and audits that are given up.
  int searched_tiles = 4096, waived_audits = 1024;
  // Jobs that need an auditor, and those of them that are reported.
  int unaudited_jobs = 32, reported_jobs = 16;
};

struct Options {
  // Identifies this run of the coordinator; must be higher than that of all earlier runs. 24 bits.
  std::uint32_t epoch = 1;
  // The heartbeat timeout: a worker that has not synchronised for so long loses its leases. A shorter one
  // means less delay when a worker dies, more heartbeats and less tolerance of a bad network.
  Duration lease_duration = std::chrono::seconds(10);
  // A worker that has not synchronised for so long is forgotten.
  Duration forget_after = std::chrono::seconds(100);
  SizingOptions sizing;
  // The share of ranges that a second worker renders again, and the secret that makes the choice
  // unpredictable.
  double audit_share = 0;
  std::uint64_t audit_secret = 0;
  // A job that lacks nothing but audits by lot, and has no worker that could do them, is done after this
  // time.
  Duration audit_patience = std::chrono::seconds(60);
  // A job that lacks nothing but samples to verify, which nobody verifies, is reported after this time.
  Duration unattended_patience = std::chrono::seconds(5);
  WorkPerEvent per_event{};
  // Signs leases. Results and reported leases count only with the token that this returns. By default all
  // tokens are empty.
  SignLease sign = [](LeaseId, const WorkerId&, const JobId&) { return LeaseToken{}; };
};

}  // namespace tessera::scheduler
