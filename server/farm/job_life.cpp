// SPDX-License-Identifier: Apache-2.0
#include "server/farm/job_life.hpp"

#include "server/farm/wire.hpp"

namespace tessera::farm {

using Kind = v1::JobEvent::Kind;

void JobLife::note(Kind kind, std::int64_t at_ms) {
  if (events_.size() == kMaxEvents) events_.erase(events_.begin() + kFirstEvents);
  events_.push_back({kind, at_ms});
}

Kind event_of(scheduler::JobState to) {
  switch (to) {
    case scheduler::JobState::kRunning:
      return v1::JobEvent::KIND_RESUMED;
    case scheduler::JobState::kPaused:
      return v1::JobEvent::KIND_PAUSED;
    case scheduler::JobState::kDone:
      return v1::JobEvent::KIND_DONE;
    case scheduler::JobState::kCancelled:
      return v1::JobEvent::KIND_CANCELLED;
    case scheduler::JobState::kFailed:
      return v1::JobEvent::KIND_FAILED;
  }
  return v1::JobEvent::KIND_UNSPECIFIED;
}

bool is_end(Kind kind) {
  return kind == v1::JobEvent::KIND_DONE || kind == v1::JobEvent::KIND_CANCELLED ||
         kind == v1::JobEvent::KIND_FAILED;
}

void write_life(const JobLife& life, stored::v1::Counters& counters) {
  counters.clear_events();
  for (const JobLife::Event& each : life.events()) {
    stored::v1::Event& event = *counters.add_events();
    event.set_kind(static_cast<std::uint32_t>(each.kind));
    event.set_at_ms(each.at_ms);
  }
}

std::string counters_with(const JobLife& life, const std::string& counters) {
  stored::v1::Counters message;
  if (!message.ParseFromString(counters)) message.Clear();
  write_life(life, message);
  return message.SerializeAsString();
}

JobLife read_life(const stored::v1::Counters& counters) {
  JobLife life;
  for (const stored::v1::Event& each : counters.events()) {
    const bool is_known = each.kind() > v1::JobEvent::KIND_SUBMITTED && each.kind() <= v1::JobEvent::Kind_MAX;
    if (is_known && ms_from_timestamp(timestamp_from_ms(each.at_ms())) == each.at_ms())
      life.note(static_cast<Kind>(each.kind()), each.at_ms());
  }
  return life;
}

}  // namespace tessera::farm
