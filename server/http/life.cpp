// SPDX-License-Identifier: Apache-2.0
#include "server/http/life.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <string>

#include "proto/state_text.hpp"
#include "server/watch/job_tiles.hpp"

namespace tessera::http_api {

namespace {

Json entry(Json at, const std::string& kind, const std::string& message) {
  return {{"at", std::move(at)}, {"kind", kind}, {"message", message}};
}

std::string message_of(const v1::JobEvent& event, const v1::Job& job) {
  switch (event.kind()) {
    case v1::JobEvent::KIND_SUBMITTED:
      return job.owner().empty() ? "" : fmt::format("by {}", job.owner());
    case v1::JobEvent::KIND_VALIDATED:
      return job.warnings().empty()
                 ? "the scene is valid"
                 : fmt::format("the scene is valid, with {} warnings", job.warnings_size());
    case v1::JobEvent::KIND_STARTED:
      return "the first samples were counted";
    case v1::JobEvent::KIND_FAILED:
      return job.failure();
    default:
      return "";
  }
}

}  // namespace

Json life_of(const v1::Job& job) {
  Json life = Json::array();
  for (const v1::JobEvent& event : job.events())
    life.push_back(entry(google::protobuf::util::TimeUtil::ToString(event.at()),
                         proto::event_name(event.kind()), message_of(event, job)));
  if (!watch::is_final(job.state()))
    life.push_back(entry(nullptr, proto::state_name(job.state()), job.waiting_reason()));
  return life;
}

}  // namespace tessera::http_api
