// SPDX-License-Identifier: Apache-2.0
#include "core/common/metric_writer.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

namespace tessera::common {

void MetricWriter::begin(std::string name, std::string help, prometheus::MetricType type) {
  families_.push_back({std::move(name), std::move(help), type, {}});
}

void MetricWriter::begin_counter(std::string name, std::string help) {
  begin(std::move(name), std::move(help), prometheus::MetricType::Counter);
}

void MetricWriter::begin_gauge(std::string name, std::string help) {
  begin(std::move(name), std::move(help), prometheus::MetricType::Gauge);
}

void MetricWriter::begin_histogram(std::string name, std::string help) {
  begin(std::move(name), std::move(help), prometheus::MetricType::Histogram);
}

prometheus::ClientMetric& MetricWriter::add_metric(const Labels& labels) {
  prometheus::ClientMetric& metric = families_.back().metric.emplace_back();
  for (const auto& [name, value] : labels) metric.label.push_back({name, value});
  return metric;
}

void MetricWriter::add(double value, const Labels& labels) {
  const bool is_counter = families_.back().type == prometheus::MetricType::Counter;
  prometheus::ClientMetric& metric = add_metric(labels);
  (is_counter ? metric.counter.value : metric.gauge.value) = value;
}

void MetricWriter::add(prometheus::ClientMetric::Histogram histogram, const Labels& labels) {
  add_metric(labels).histogram = std::move(histogram);
}

void MetricWriter::counter(std::string name, std::string help, double value) {
  begin_counter(std::move(name), std::move(help));
  add(value);
}

void MetricWriter::gauge(std::string name, std::string help, double value) {
  begin_gauge(std::move(name), std::move(help));
  add(value);
}

namespace {

double processor_seconds() {
  rusage used{};
  if (::getrusage(RUSAGE_SELF, &used) != 0) return 0;
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

// The second number of /proc/self/statm, in pages.
double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double total = 0, resident = 0;
  file >> total >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

double open_files() {
  std::error_code failed;
  const std::filesystem::directory_iterator files("/proc/self/fd", failed);
  if (failed) return 0;
  return static_cast<double>(std::distance(begin(files), end(files)) - 1);  // without the folder itself
}

}  // namespace

void write_process_metrics(MetricWriter& writer, const std::string& version, const std::string& fingerprint) {
  writer.begin_gauge("tessera_build_info",
                     "The release and the determinism fingerprint of this program; the value is 1");
  writer.add(1, {{"version", version}, {"fingerprint", fingerprint}});
  writer.counter("process_cpu_seconds_total", "Processor time of this program", processor_seconds());
  writer.gauge("process_resident_memory_bytes", "Memory of this program", resident_bytes());
  writer.gauge("process_open_fds", "Open files and connections of this program", open_files());
}

}  // namespace tessera::common
