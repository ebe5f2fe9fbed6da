// SPDX-License-Identifier: Apache-2.0
// Routes of jobs.
#include <fmt/format.h>

#include <memory>

#include "proto/json.hpp"
#include "server/http/answers.hpp"
#include "server/http/handlers.hpp"
#include "server/http/life.hpp"
#include "server/http/read_json.hpp"
#include "server/rpc/job_calls.hpp"

namespace tessera::http_api {

namespace {

Answer job_answer(const core::Result<v1::Job>& job) {
  if (!job) return core::fail(job.error());
  return json_response(proto::to_json(*job));
}

// What `change` returns, if the caller may change the job.
template <typename Change>
Answer change_job(const CallPtr& call, Change change) {
  const core::Status allowed = rpc::may_change(call->coordinator(), call->caller(), call->id());
  if (!allowed) return core::fail(allowed.error());
  return job_answer(change(call->coordinator().jobs()));
}

}  // namespace

Answer list_jobs(const CallPtr& call) {
  const auto request = read_job_list(call->request);
  if (!request) return core::fail(request.error());
  const auto listed = call->coordinator().jobs().list(*request);
  if (!listed) return core::fail(listed.error());
  Json jobs = Json::array();
  for (const v1::Job& job : listed->jobs()) jobs.push_back(proto::to_json(job));
  return json_response({{"jobs", std::move(jobs)}, {"next_page_token", listed->next_page_token()}});
}

Answer submit_job(const CallPtr& call) {
  const auto body = read_body(call->request.body);
  if (!body) return core::fail(body.error());
  const auto request = read_submission(*body);
  if (!request) return core::fail(request.error());
  const rpc::Services& services = call->services();
  auto claim = services.coordinator.files().claim(call->caller().key, blobs::files_of(request->bundle()));
  if (!claim) return core::fail(server::temporary(claim.error(), auth::kTryAgainAfter));
  const auto job = rpc::submit(services.coordinator, services.validations, *request, call->caller());
  if (job) claim->settle();
  return job_answer(job);
}

Answer get_job(const CallPtr& call) {
  return job_answer(call->coordinator().jobs().get(call->id()));
}

Answer delete_job(const CallPtr& call) {
  const core::Status allowed = rpc::may_change(call->coordinator(), call->caller(), call->id());
  if (!allowed) return core::fail(allowed.error());
  if (const auto removed = call->coordinator().jobs().remove(call->id()); !removed)
    return core::fail(removed.error());
  return no_content();
}

Answer pause_job(const CallPtr& call) {
  return change_job(call, [&](jobs::JobService& jobs) { return jobs.pause(call->id()); });
}

Answer resume_job(const CallPtr& call) {
  return change_job(call, [&](jobs::JobService& jobs) { return jobs.resume(call->id()); });
}

Answer cancel_job(const CallPtr& call) {
  return change_job(call, [&](jobs::JobService& jobs) { return jobs.cancel(call->id()); });
}

Answer extend_job(const CallPtr& call) {
  const auto body = read_body(call->request.body);
  if (!body) return core::fail(body.error());
  const auto spp = read_spp(*body);
  if (!spp) return core::fail(spp.error());
  return change_job(call, [&](jobs::JobService& jobs) { return jobs.extend(call->id(), *spp); });
}

Answer update_job(const CallPtr& call) {
  const auto body = read_body(call->request.body);
  if (!body) return core::fail(body.error());
  auto request = read_update(*body);
  if (!request) return core::fail(request.error());
  request->set_job_id(call->id());
  return change_job(call, [&](jobs::JobService& jobs) { return jobs.update(*request); });
}

Answer get_events(const CallPtr& call) {
  const auto job = call->coordinator().jobs().get_without_bundle(call->id());
  if (!job) return core::fail(job.error());
  return json_response({{"events", life_of(*job)}});
}

}  // namespace tessera::http_api
