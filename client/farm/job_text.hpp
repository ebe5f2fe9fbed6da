// SPDX-License-Identifier: Apache-2.0
// Jobs and workers as people and as programs read them. Stateless; times are seconds since 1970.
#pragma once

#include <google/protobuf/message.h>

#include <string>

#include "client/progress.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::client {

// As many digits of a job's id as are shown: enough to tell jobs apart.
std::string short_id(const std::string& id);
// "running", "paused", ...
std::string state_name(v1::JobState state);
// Whether it will not change any more by itself.
bool is_over(v1::JobState state);
// "640x480"
std::string size_text(const v1::RenderSettings& settings);
// From submission to its end; 0 while it has none.
double seconds_taken(const v1::Job& job);
// What the progress line shows of a job.
ProgressState progress_of(const v1::Job& job);

std::string jobs_table(const v1::ListJobsResponse& jobs, double now_seconds);
std::string workers_table(const v1::ListWorkersResponse& workers, double now_seconds);
// Everything about one job, a line for each field.
std::string job_description(const v1::Job& job);

// One line of JSON with the field names of the contract and a line end. 64-bit numbers are strings, as
// protobuf's JSON mapping has it.
std::string to_json_line(const google::protobuf::Message& message);

}  // namespace tessera::client
