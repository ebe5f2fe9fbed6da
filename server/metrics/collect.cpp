// SPDX-License-Identifier: Apache-2.0
#include "server/metrics/collect.hpp"

#include <string>

#include "core/base/determinism_fingerprint.hpp"
#include "core/base/version.hpp"
#include "server/metrics/parts.hpp"

namespace tessera::metrics {

common::MetricFamilies collect(server::Coordinator& coordinator, const rpc::Server& server,
                               const rpc::CallStats* http_calls) {
  common::MetricWriter writer;
  const farm::Totals totals = farm::totals_of(coordinator.farm());
  write_jobs(writer, totals);
  write_first_samples(writer, coordinator.farm());
  write_workers(writer, totals);
  write_results(writer, totals, coordinator.dispatcher().result_counts());
  write_state_lock(writer, coordinator.farm());
  write_calls(writer, server.calls(), http_calls);
  write_traffic(writer, server.calls().traffic);
  write_queues(writer, server);
  write_validations(writer, coordinator.validations());
  write_films(writer, coordinator.film_memory());
  write_checkpoints(writer, coordinator.checkpointer().stats());
  write_store(writer, coordinator);
  common::write_process_metrics(writer, std::string(core::version()),
                                std::string(core::kDeterminismFingerprint));
  return writer.take();
}

}  // namespace tessera::metrics
