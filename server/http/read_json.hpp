// SPDX-License-Identifier: Apache-2.0
// Reads bodies and queries of requests. Errors are INVALID_ARGUMENT and name the field, also if it is
// unknown. Pure functions.
#pragma once

#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/http/server.hpp"
#include "server/http/answers.hpp"
#include "tessera/v1/admin_service.pb.h"
#include "tessera/v1/render_service.pb.h"

namespace tessera::http_api {

// An object; an empty body is an empty one.
core::Result<Json> read_body(const std::string& body);

core::Result<v1::SubmitJobRequest> read_submission(const Json& body);
core::Result<v1::UpdateJobRequest> read_update(const Json& body);
core::Result<v1::FindMissingBlobsRequest> read_files(const Json& body);
core::Result<std::uint32_t> read_spp(const Json& body);
core::Result<std::string> read_token(const Json& body);
core::Result<v1::DrainWorkerRequest> read_drain(const Json& body);

core::Result<v1::ListJobsRequest> read_job_list(const http::Request& request);
core::Result<v1::ListWorkersRequest> read_worker_list(const http::Request& request);
core::Result<v1::ListQuarantineRequest> read_quarantine_list(const http::Request& request);
core::Result<v1::GetImageRequest> read_image(const http::Request& request);

// The index of an image of a job: image=N; 0 if it is absent.
core::Result<std::uint32_t> read_image_index(const http::Request& request);
// A parameter of the query; empty if it is absent.
core::Result<std::optional<std::uint64_t>> read_number(const http::Request& request, const std::string& name,
                                                       std::uint64_t max);
// region=x0,y0,x1,y1
core::Result<std::optional<v1::PixelRect>> read_region(const http::Request& request);

}  // namespace tessera::http_api
