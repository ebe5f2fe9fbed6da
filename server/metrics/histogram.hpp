// SPDX-License-Identifier: Apache-2.0
// A histogram of durations in the form of prometheus-cpp. Pure function.
#pragma once

#include <prometheus/client_metric.h>

#include "server/base/duration_histogram.hpp"

namespace tessera::metrics {

// With cumulative counts, and bounds in seconds, of which the last is infinite.
prometheus::ClientMetric::Histogram to_prometheus(const base::DurationHistogram& histogram);

}  // namespace tessera::metrics
