// SPDX-License-Identifier: Apache-2.0
#include "server/metrics/histogram.hpp"

#include <chrono>
#include <limits>

namespace tessera::metrics {

prometheus::ClientMetric::Histogram to_prometheus(const base::DurationHistogram& histogram) {
  using Seconds = std::chrono::duration<double>;
  const base::DurationHistogram::Snapshot snapshot = histogram.snapshot();
  prometheus::ClientMetric::Histogram result;
  for (std::size_t i = 0; i < snapshot.counts.size(); ++i) {
    result.sample_count += snapshot.counts[i];
    const double bound = i < histogram.bounds().size() ? Seconds(histogram.bounds()[i]).count()
                                                       : std::numeric_limits<double>::infinity();
    result.bucket.push_back({result.sample_count, bound});
  }
  result.sample_sum = Seconds(snapshot.sum).count();
  return result;
}

}  // namespace tessera::metrics
