// SPDX-License-Identifier: Apache-2.0
// The tables of docs/metrics.md.
#pragma once

#include <prometheus/metric_family.h>

#include <fstream>
#include <set>
#include <string>
#include <vector>

namespace tessera::test {

// The row of the table that a family must have.
inline std::string metric_row(const prometheus::MetricFamily& family) {
  const char* type = "gauge";
  if (family.type == prometheus::MetricType::Counter) type = "counter";
  if (family.type == prometheus::MetricType::Histogram) type = "histogram";
  std::string labels;
  if (!family.metric.empty())
    for (const auto& label : family.metric.front().label)
      labels += (labels.empty() ? "`" : ", `") + label.name + "`";
  return "| `" + family.name + "` | " + type + " | " + labels + (labels.empty() ? "| " : " | ") +
         family.help + " |";
}

inline std::set<std::string> metric_rows(const std::vector<prometheus::MetricFamily>& families) {
  std::set<std::string> rows;
  for (const auto& family : families) rows.insert(metric_row(family));
  return rows;
}

// The rows of the sections with these headings.
inline std::set<std::string> documented_metric_rows(const std::set<std::string>& headings) {
  std::ifstream page(TESSERA_SOURCE_DIR "/docs/metrics.md");
  std::set<std::string> rows;
  bool is_wanted = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) is_wanted = headings.contains(line.substr(3));
    const bool is_metric = line.starts_with("| `tessera_") || line.starts_with("| `process_");
    if (is_wanted && is_metric) rows.insert(line);
  }
  return rows;
}

// Whether there is a series with this name and label; of a histogram, one of its buckets.
inline bool has_label(const std::vector<prometheus::MetricFamily>& families, const std::string& series,
                      const std::string& label, const std::string& value) {
  for (const auto& family : families)
    for (const auto& metric : family.metric) {
      if (label == "le" && series == family.name + "_bucket")
        for (const auto& bucket : metric.histogram.bucket)
          if (bucket.upper_bound == std::stod(value)) return true;
      if (series != family.name) continue;
      for (const auto& shown : metric.label)
        if (shown.name == label && shown.value == value) return true;
    }
  return false;
}

// A single value; the family must have it. Labels as pairs in their order.
inline double metric_value(const std::vector<prometheus::MetricFamily>& families, const std::string& name,
                           const std::vector<prometheus::ClientMetric::Label>& labels = {}) {
  for (const auto& family : families) {
    if (family.name != name) continue;
    for (const auto& metric : family.metric) {
      if (metric.label != labels) continue;
      if (family.type == prometheus::MetricType::Histogram)
        return static_cast<double>(metric.histogram.sample_count);
      return family.type == prometheus::MetricType::Counter ? metric.counter.value : metric.gauge.value;
    }
  }
  return -1;
}

}  // namespace tessera::test
