// SPDX-License-Identifier: Apache-2.0
// What the routes do. Each calls the same services as the method of gRPC with the same purpose.
#pragma once

#include <memory>

#include "server/http/call.hpp"

namespace tessera::http_api {

// ---- Jobs (job_handlers.cpp) ----
Answer list_jobs(const CallPtr& call);
Answer submit_job(const CallPtr& call);
Answer get_job(const CallPtr& call);
Answer delete_job(const CallPtr& call);
Answer pause_job(const CallPtr& call);
Answer resume_job(const CallPtr& call);
Answer cancel_job(const CallPtr& call);
Answer extend_job(const CallPtr& call);
Answer update_job(const CallPtr& call);
Answer get_events(const CallPtr& call);

// ---- Images (image_handlers.cpp, image_download.cpp, job_map.cpp, tile_views.cpp) ----
Answer get_image(const CallPtr& call);
Answer get_thumbnail(const CallPtr& call);
Answer get_pixel(const CallPtr& call);
Answer get_map(const CallPtr& call);
Answer watch_tiles(const CallPtr& call);

// ---- The farm (farm_handlers.cpp) ----
Answer get_server(const CallPtr& call);
Answer get_activity(const CallPtr& call);
Answer list_workers(const CallPtr& call);
Answer drain_worker(const CallPtr& call);
Answer list_quarantine(const CallPtr& call);
Answer lift_quarantine(const CallPtr& call);

// ---- Files (blob_handlers.cpp) ----
Answer find_missing(const CallPtr& call);
core::Result<std::unique_ptr<http::BodySink>> receive_blob(const CallPtr& call);

}  // namespace tessera::http_api
