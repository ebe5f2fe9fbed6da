// SPDX-License-Identifier: Apache-2.0
// The metrics of a coordinator by what they are about. Thread-safe.
#pragma once

#include "core/common/metric_writer.hpp"
#include "server/coordinator.hpp"
#include "server/farm/totals.hpp"
#include "server/rpc/server.hpp"

namespace tessera::metrics {

// ---- The farm (farm_metrics.cpp) ----
void write_jobs(common::MetricWriter& writer, const farm::Totals& totals);
void write_workers(common::MetricWriter& writer, const farm::Totals& totals);
void write_results(common::MetricWriter& writer, const farm::Totals& totals,
                   const dispatch::ResultCounts& counts);
void write_first_samples(common::MetricWriter& writer, const farm::Farm& farm);
void write_state_lock(common::MetricWriter& writer, const farm::Farm& farm);

// ---- The service (service_metrics.cpp) ----
// `http_calls` may be null.
void write_calls(common::MetricWriter& writer, const rpc::CallStats& calls, const rpc::CallStats* http_calls);
void write_traffic(common::MetricWriter& writer, const rpc::Traffic& traffic);
void write_queues(common::MetricWriter& writer, const rpc::Server& server);
void write_validations(common::MetricWriter& writer, const jobs::ValidationStats& validations);

// ---- Memory and disk (store_metrics.cpp) ----
void write_films(common::MetricWriter& writer, const film::FilmMemory& memory);
void write_checkpoints(common::MetricWriter& writer, const jobs::CheckpointStats& stats);
// Asks the file system for sizes.
void write_store(common::MetricWriter& writer, server::Coordinator& coordinator);

}  // namespace tessera::metrics
