// SPDX-License-Identifier: Apache-2.0
// The metrics of a coordinator (docs/metrics.md). Thread-safe.
#pragma once

#include "core/common/metric_writer.hpp"
#include "server/coordinator.hpp"
#include "server/rpc/server.hpp"

namespace tessera::metrics {

// Takes the state lock once, for microseconds, and asks the file system for sizes. `http_calls`: those of the
// HTTP API by route; null if it is off.
common::MetricFamilies collect(server::Coordinator& coordinator, const rpc::Server& server,
                               const rpc::CallStats* http_calls = nullptr);

}  // namespace tessera::metrics
