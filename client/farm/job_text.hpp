// SPDX-License-Identifier: Apache-2.0
// Jobs and workers as text and JSON. Stateless; times are seconds since 1970.
#pragma once

#include <google/protobuf/message.h>
#include <google/protobuf/timestamp.pb.h>

#include <string>

#include "client/progress.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::client {

// The displayed prefix of a job's id, long enough to distinguish jobs.
std::string short_id(const std::string& id);
// "running", "paused", ...
std::string state_name(v1::JobState state);
// Whether the state is final unless the user changes it.
bool is_over(v1::JobState state);
// "640x480"; "-" if it is not known yet.
std::string size_text(const v1::RenderSettings& settings);
// "1:35 ago"
std::string ago(const google::protobuf::Timestamp& time, double now_seconds);
// From submission to completion; 0 while the job is incomplete.
double seconds_taken(const v1::Job& job);
// The job's state for the progress line.
ProgressState progress_of(const v1::Job& job);

std::string jobs_table(const v1::ListJobsResponse& jobs, double now_seconds);
std::string workers_table(const v1::ListWorkersResponse& workers, double now_seconds);
// Everything about one job, a line for each field.
std::string job_description(const v1::Job& job);

// One line of JSON with the field names of the protocol, including the line end. 64-bit numbers are
// strings, as in protobuf's JSON mapping.
std::string to_json_line(const google::protobuf::Message& message);

}  // namespace tessera::client
