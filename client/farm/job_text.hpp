// SPDX-License-Identifier: Apache-2.0
// Jobs and workers as text and JSON. Stateless; times are seconds since 1970.
#pragma once

#include <google/protobuf/timestamp.pb.h>

#include <string>

#include "client/progress.hpp"
#include "client/terminal.hpp"
#include "proto/json.hpp"
#include "proto/state_text.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::client {

using proto::is_queued;
using proto::short_id;
using proto::state_name;

// state_name(), or "queued" for a running job that waits for workers.
std::string shown_state(const v1::Job& job);
// The colour of a state of a job or worker.
Color state_color(const std::string& state);
// Whether the state is final unless the user changes it.
bool is_over(v1::JobState state);
// "640x480"; "-" if it is not known yet.
std::string size_text(const v1::RenderSettings& settings);
// "1:35 ago"
std::string ago(const google::protobuf::Timestamp& time, double now_seconds);
// What was written of a done job, and how long it took. The coordinator's clock may have been set meanwhile,
// so the job's times do not count.
std::string written_text(const v1::Job& job, const std::vector<std::string>& paths, double seconds);
// The job's state for the progress line.
ProgressState progress_of(const v1::Job& job);

// Ids are shortened to prefixes that are unique in the table. Lines below the table say why jobs wait, and
// why workers receive no work.
std::string jobs_table(const v1::ListJobsResponse& jobs, double now_seconds, const TextStyle& style = {});
std::string workers_table(const v1::ListWorkersResponse& workers, double now_seconds,
                          const TextStyle& style = {});
// Everything about one job, a line for each field; long ones are wrapped on a terminal.
std::string job_description(const v1::Job& job, double now_seconds, const TextStyle& style = {});

// One line of JSON, including the line end: see proto/json.hpp.
template <typename Message>
std::string to_json_line(const Message& message) {
  return proto::to_line(proto::to_json(message)) + "\n";
}
// The same, a line for each message.
template <typename Messages>
std::string to_json_lines(const Messages& messages) {
  std::string lines;
  for (const auto& message : messages) lines += to_json_line(message);
  return lines;
}

}  // namespace tessera::client
