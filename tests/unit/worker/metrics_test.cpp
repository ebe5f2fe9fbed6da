// SPDX-License-Identifier: Apache-2.0
#include "worker/metrics.hpp"

#include <gtest/gtest.h>

#include "tests/support/metric_table.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::worker {
namespace {

using namespace std::chrono_literals;
using test::metric_value;

class WorkerMetrics : public testing::Test {
 protected:
  common::MetricFamilies collected() const { return collect(metrics_, identity_, cache_); }

  const TemporaryFolder folder_;
  const BlobCache cache_ = BlobCache::open(folder_.path() / "cache", 1000).value();
  const Identity identity_{.version = "0.2.0", .determinism_fingerprint = "f00d", .threads = 3};
  Metrics metrics_;
};

TEST_F(WorkerMetrics, AreDocumentedEachAndNoOthers) {
  const auto shown = test::metric_rows(collected());
  const auto documented = test::documented_metric_rows({"Worker", "Processes"});
  for (const std::string& row : shown)
    EXPECT_TRUE(documented.contains(row)) << "docs/metrics.md lacks the line\n" << row;
  for (const std::string& row : documented)
    EXPECT_TRUE(shown.contains(row)) << "docs/metrics.md has a line too many\n" << row;
}

TEST_F(WorkerMetrics, AreALineForTheServiceManagerWhileTheWorkerCallsTheCoordinator) {
  const auto status = [this] { return status_of(metrics_, "farm:7420", 1h); };
  EXPECT_EQ(status(), "no connection to farm:7420");
  metrics_.connected = true;
  metrics_.leases_held = 3;
  EXPECT_EQ(status(), "connected to farm:7420, with 3 leases");
  metrics_.next_call_by = Metrics::Clock::now() + 1h;
  EXPECT_TRUE(status());
  metrics_.next_call_by = Metrics::Clock::now() - 1ms;
  EXPECT_FALSE(status());
}

TEST_F(WorkerMetrics, SayThatAWorkerIsAliveAlsoWithoutCoordinator) {
  EXPECT_TRUE(check_alive(metrics_, 1h));
  EXPECT_FALSE(check_ready(metrics_, 1h));
  metrics_.connected = true;
  EXPECT_TRUE(check_ready(metrics_, 1h));
}

TEST_F(WorkerMetrics, SayThatAWorkerIsNotAliveIfEitherThreadHangs) {
  metrics_.connected = true;
  metrics_.step_began = Metrics::Clock::now() - 30min;
  EXPECT_TRUE(check_ready(metrics_, 1h)) << "a large scene";
  metrics_.step_began = Metrics::Clock::now() - 90min;
  EXPECT_FALSE(check_alive(metrics_, 1h)) << "rendering";
  EXPECT_FALSE(check_ready(metrics_, 1h));
  EXPECT_FALSE(status_of(metrics_, "farm:7420", 1h));
  metrics_.step_began = Metrics::Clock::time_point::max();
  EXPECT_TRUE(check_alive(metrics_, 1h)) << "waiting for work";
  metrics_.next_call_by = Metrics::Clock::now() - 1ms;
  EXPECT_FALSE(check_alive(metrics_, 1h)) << "synchronising";
  EXPECT_FALSE(check_ready(metrics_, 1h));
}

TEST_F(WorkerMetrics, ShowWhatTheWorkerHasCounted) {
  metrics_.samples_rendered += 500;
  Metrics::add(metrics_.render_ns, std::chrono::milliseconds(2500));
  ++metrics_.results_delivered;
  const auto families = collected();
  EXPECT_EQ(metric_value(families, "tessera_worker_samples_rendered_total"), 500);
  EXPECT_EQ(metric_value(families, "tessera_worker_render_seconds_total"), 2.5);
  EXPECT_EQ(metric_value(families, "tessera_worker_results_total", {{"answer", "taken"}}), 1);
  EXPECT_EQ(metric_value(families, "tessera_worker_threads"), 3);
  EXPECT_EQ(metric_value(families, "tessera_worker_connected"), 0);
  EXPECT_EQ(metric_value(families, "tessera_build_info", {{"version", "0.2.0"}, {"fingerprint", "f00d"}}), 1);
}

TEST_F(WorkerMetrics, ShowTheSizeOfTheCacheWithoutFilesOfOthers) {
  write_file(folder_.path() / "cache" / std::string(64, 'a'), "12345");
  write_file(folder_.path() / "cache" / "notes", "not ours");
  EXPECT_EQ(metric_value(collected(), "tessera_worker_cache_bytes"), 5);
  EXPECT_EQ(metric_value(collected(), "tessera_worker_cache_limit_bytes"), 1000);
}

}  // namespace
}  // namespace tessera::worker
