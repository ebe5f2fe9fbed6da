// SPDX-License-Identifier: Apache-2.0
// What has happened to a job since its submission, with times of day. Plain data; not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/scheduler/job_state.hpp"
#include "server/store/stored.pb.h"
#include "tessera/v1/types.pb.h"

namespace tessera::farm {

class JobLife {
 public:
  // Of more events, those between the first and the last ones are left out.
  static constexpr std::size_t kMaxEvents = 64, kFirstEvents = 7;

  struct Event {
    v1::JobEvent::Kind kind = v1::JobEvent::KIND_UNSPECIFIED;
    std::int64_t at_ms = 0;  // since 1970-01-01 UTC
    bool operator==(const Event&) const = default;
  };

  void note(v1::JobEvent::Kind kind, std::int64_t at_ms);
  // Oldest first. The submission, which is Job.created_at, is not among them.
  const std::vector<Event>& events() const { return events_; }
  bool operator==(const JobLife&) const = default;

 private:
  std::vector<Event> events_;
};

// What it is called that a job comes into this state.
v1::JobEvent::Kind event_of(scheduler::JobState to);
// Whether it is the end of a job.
bool is_end(v1::JobEvent::Kind kind);

void write_life(const JobLife& life, stored::v1::Counters& counters);
// JobRow::counters with these events instead of its own.
std::string counters_with(const JobLife& life, const std::string& counters);
// Leaves out events of unknown kinds and impossible times.
JobLife read_life(const stored::v1::Counters& counters);

}  // namespace tessera::farm
