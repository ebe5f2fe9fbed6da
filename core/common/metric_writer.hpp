// SPDX-License-Identifier: Apache-2.0
// Writes the metrics of a program, in the form of prometheus-cpp: families of values of one meaning, told
// apart by labels. Names have base units (seconds, bytes); those of counters end in _total. Not thread-safe.
#pragma once

#include <prometheus/metric_family.h>

#include <string>
#include <utility>
#include <vector>

namespace tessera::common {

using MetricFamilies = std::vector<prometheus::MetricFamily>;

class MetricWriter {
 public:
  using Labels = std::vector<std::pair<std::string, std::string>>;

  // Begin a family. `help` is a sentence without a full stop at its end.
  void begin_counter(std::string name, std::string help);
  void begin_gauge(std::string name, std::string help);
  void begin_histogram(std::string name, std::string help);

  // Add to the family that was begun last.
  void add(double value, const Labels& labels = {});
  void add(prometheus::ClientMetric::Histogram histogram, const Labels& labels = {});

  // A family of one value.
  void counter(std::string name, std::string help, double value);
  void gauge(std::string name, std::string help, double value);

  MetricFamilies take() { return std::exchange(families_, {}); }

 private:
  void begin(std::string name, std::string help, prometheus::MetricType type);
  prometheus::ClientMetric& add_metric(const Labels& labels);

  MetricFamilies families_;
};

// What every program tells of itself: its release and its fingerprint, its memory, processor time and open
// files.
void write_process_metrics(MetricWriter& writer, const std::string& version, const std::string& fingerprint);

}  // namespace tessera::common
