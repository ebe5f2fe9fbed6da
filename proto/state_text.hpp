// SPDX-License-Identifier: Apache-2.0
// The states of jobs and workers in words: the same in tables, JSON and the page. Pure functions.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tessera/v1/types.pb.h"

namespace tessera::proto {

// The displayed prefix of an id, long enough to distinguish jobs and workers.
std::string short_id(const std::string& id);

// "validating", "running", "paused", "done", "cancelled" or "failed"; "unknown" for states of later releases.
std::string state_name(v1::JobState state);

// "submitted", "validated", "started", "paused", "resumed", "extended", "done", "cancelled" or "failed";
// "unknown" for kinds of later releases.
std::string event_name(v1::JobEvent::Kind kind);

// Whether a running job waits for workers.
bool is_queued(const v1::Job& job);

v1::WorkerState state_of(const v1::Worker& worker);
// "quarantined", "silent", "draining", "drained", "leaving", "stuck", "fetching", "in cooldown", "working" or
// "idle"; "unknown" for states of later releases.
std::string state_name(v1::WorkerState state);
inline std::string worker_state(const v1::Worker& worker) {
  return state_name(state_of(worker));
}

// All values of JobState or WorkerState by their names, but for the unspecified one.
std::map<std::string, v1::JobState> job_states_by_name();
std::map<std::string, v1::WorkerState> worker_states_by_name();

// Why a worker receives no work, or no work of some jobs: predicates whose subject is the worker. They
// contain text of the worker: escape it for display.
std::vector<std::string> worker_remarks(const v1::Worker& worker);

// The time until a running job is complete at its present speed. Empty if there is none.
std::optional<double> seconds_left(const v1::Job& job);

}  // namespace tessera::proto
