// SPDX-License-Identifier: Apache-2.0
// Routes of the coordinator, its activity, its workers and the quarantine.
#include <cmath>

#include "proto/json.hpp"
#include "server/http/answers.hpp"
#include "server/http/handlers.hpp"
#include "server/http/read_json.hpp"
#include "server/rpc/server_info.hpp"

namespace tessera::http_api {

Answer get_server(const CallPtr& call) {
  const rpc::Services& services = call->services();
  return json_response(
      proto::to_json(rpc::server_info(services.facts, services.streams.limits, call->caller())));
}

Answer get_activity(const CallPtr& call) {
  Json samples = Json::array();
  for (const ActivitySample& sample : call->context.activity.samples())
    samples.push_back({std::llround(sample.samples_per_second), sample.busy_workers, sample.running_jobs});
  return json_response({{"period_seconds", ActivityLog::kPeriod.count()}, {"samples", std::move(samples)}});
}

Answer list_workers(const CallPtr& call) {
  const auto request = read_worker_list(call->request);
  if (!request) return core::fail(request.error());
  const auto page = call->coordinator().dispatcher().list_workers(*request);
  if (!page) return core::fail(page.error());
  Json workers = Json::array();
  for (const v1::Worker& worker : page->workers()) workers.push_back(proto::to_json(worker));
  return json_response({{"workers", std::move(workers)}, {"next_page_token", page->next_page_token()}});
}

Answer drain_worker(const CallPtr& call) {
  const auto body = read_body(call->request.body);
  if (!body) return core::fail(body.error());
  auto request = read_drain(*body);
  if (!request) return core::fail(request.error());
  request->set_worker(call->id());
  const auto drained = call->coordinator().fleet().drain(*request);
  if (!drained) return core::fail(drained.error());
  return json_response({{"id", drained->worker_id()}});
}

Answer list_quarantine(const CallPtr& call) {
  const auto request = read_quarantine_list(call->request);
  if (!request) return core::fail(request.error());
  const auto page = call->coordinator().fleet().list_quarantine(*request);
  if (!page) return core::fail(page.error());
  Json entries = Json::array();
  for (const v1::QuarantineEntry& entry : page->entries()) entries.push_back(proto::to_json(entry));
  return json_response({{"entries", std::move(entries)}, {"next_page_token", page->next_page_token()}});
}

Answer lift_quarantine(const CallPtr& call) {
  if (const auto lifted = call->coordinator().fleet().lift(call->id()); !lifted)
    return core::fail(lifted.error());
  return no_content();
}

}  // namespace tessera::http_api
