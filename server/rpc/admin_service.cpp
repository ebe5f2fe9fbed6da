// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/admin_service.hpp"

#include <utility>

#include "server/rpc/reactors.hpp"

namespace tessera::rpc {

AdminService::AdminService(server::Coordinator& coordinator, auth::AuthInterceptor& gate,
                           base::FairPool& pool, StreamLimits& streams)
    : GuardedService("tessera.v1.AdminService", gate, streams), coordinator_(coordinator), pool_(pool) {
  add_unary("ListQuarantine", &AdminService::list_quarantine);
  add_unary("LiftQuarantine", &AdminService::lift_quarantine);
  add_unary("DrainWorker", &AdminService::drain_worker);
}

void AdminService::list_quarantine(UnaryCall<v1::ListQuarantineRequest, v1::ListQuarantineResponse>& call) {
  run_unary(call, pool_, [this, &call]() -> core::Status {
    auto page = coordinator_.fleet().list_quarantine(call.request());
    if (!page) return core::fail(page.error());
    call.response() = *std::move(page);
    return {};
  });
}

void AdminService::lift_quarantine(UnaryCall<v1::LiftQuarantineRequest, v1::LiftQuarantineResponse>& call) {
  run_unary(call, pool_, [this, &call] { return coordinator_.fleet().lift(call.request().id()); });
}

void AdminService::drain_worker(UnaryCall<v1::DrainWorkerRequest, v1::DrainWorkerResponse>& call) {
  run_unary(call, pool_, [this, &call]() -> core::Status {
    auto drained = coordinator_.fleet().drain(call.request());
    if (!drained) return core::fail(drained.error());
    call.response() = *std::move(drained);
    return {};
  });
}

}  // namespace tessera::rpc
