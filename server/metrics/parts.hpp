// SPDX-License-Identifier: Apache-2.0
// The metrics of a coordinator by what they are about. Thread-safe.
#pragma once

#include "proto/metric_writer.hpp"
#include "server/coordinator.hpp"
#include "server/farm/totals.hpp"
#include "server/rpc/server.hpp"

namespace tessera::metrics {

// ---- The farm (farm_metrics.cpp) ----
void write_jobs(proto::MetricWriter& writer, const farm::Totals& totals);
void write_workers(proto::MetricWriter& writer, const farm::Totals& totals);
void write_results(proto::MetricWriter& writer, const farm::Totals& totals,
                   const dispatch::ResultCounts& counts);
void write_state_lock(proto::MetricWriter& writer, const farm::Farm& farm);

// ---- The service (service_metrics.cpp) ----
void write_calls(proto::MetricWriter& writer, const rpc::CallStats& calls);
void write_traffic(proto::MetricWriter& writer, const rpc::Traffic& traffic);
void write_queues(proto::MetricWriter& writer, const rpc::Server& server);
void write_validations(proto::MetricWriter& writer, const jobs::ValidationStats& validations);

// ---- Memory and disk (store_metrics.cpp) ----
void write_films(proto::MetricWriter& writer, const film::FilmMemory& memory);
void write_checkpoints(proto::MetricWriter& writer, const jobs::CheckpointStats& stats);
// Asks the file system for sizes.
void write_store(proto::MetricWriter& writer, server::Coordinator& coordinator);

}  // namespace tessera::metrics
