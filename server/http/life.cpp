// SPDX-License-Identifier: Apache-2.0
#include "server/http/life.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <string>

#include "proto/state_text.hpp"
#include "server/watch/job_tiles.hpp"

namespace tessera::http_api {

namespace {

Json at(const google::protobuf::Timestamp& time) {
  return google::protobuf::util::TimeUtil::ToString(time);
}

Json event(Json at, const std::string& kind, const std::string& message) {
  return {{"at", std::move(at)}, {"kind", kind}, {"message", message}};
}

std::string message_of_end(const v1::Job& job) {
  if (job.state() == v1::JOB_STATE_FAILED) return job.failure();
  return fmt::format("{} of {} pixel samples", job.samples_done(), job.samples_total());
}

}  // namespace

// A job has samples to render from its validation on.
Json life_of(const v1::Job& job) {
  Json events = Json::array();
  events.push_back(event(at(job.created_at()), "submitted",
                         job.owner().empty() ? "submitted" : fmt::format("submitted by {}", job.owner())));
  if (job.samples_total() > 0)
    events.push_back(event(nullptr, "validated",
                           job.warnings().empty()
                               ? "the scene is valid"
                               : fmt::format("the scene is valid, with {} warnings", job.warnings_size())));
  if (job.samples_done() > 0) events.push_back(event(nullptr, "started", "the first samples were counted"));
  const std::string state = proto::state_name(job.state());
  if (watch::is_final(job.state())) {
    events.push_back(
        event(job.has_finished_at() ? at(job.finished_at()) : Json(nullptr), state, message_of_end(job)));
  } else {
    events.push_back(event(nullptr, state, job.waiting_reason()));
  }
  return events;
}

}  // namespace tessera::http_api
