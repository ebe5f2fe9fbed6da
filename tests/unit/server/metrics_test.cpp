// SPDX-License-Identifier: Apache-2.0
// The metrics of a coordinator, as Prometheus gets them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <regex>
#include <sstream>
#include <string>

#include "server/metrics/collect.hpp"
#include "server/metrics/histogram.hpp"
#include "tests/support/metric_table.hpp"
#include "tests/unit/server/limited_service.hpp"

namespace tessera::metrics {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using test::metric_value;

TEST(DurationHistogram, CountsWhatEachBoundTakes) {
  base::DurationHistogram histogram({microseconds(10), milliseconds(1)});
  for (const auto duration : {microseconds(0), microseconds(10), microseconds(11), microseconds(2000)})
    histogram.observe(duration);
  const auto shown = to_prometheus(histogram);
  ASSERT_EQ(shown.bucket.size(), 3u);
  EXPECT_EQ(shown.bucket[0].cumulative_count, 2u);
  EXPECT_EQ(shown.bucket[0].upper_bound, 1e-5);
  EXPECT_EQ(shown.bucket[1].cumulative_count, 3u);
  EXPECT_EQ(shown.bucket[2].cumulative_count, 4u);
  EXPECT_EQ(shown.sample_count, 4u);
  EXPECT_DOUBLE_EQ(shown.sample_sum, 2021e-6);
}

class CoordinatorMetrics : public rpc::LimitedService {
 protected:
  common::MetricFamilies collected() { return collect(*coordinator_, *server_); }
  double value(const std::string& name, const std::vector<prometheus::ClientMetric::Label>& labels = {}) {
    return metric_value(collected(), name, labels);
  }
  v1::Lease lease_to(char worker) {
    grpc::ClientContext context;
    v1::SynchronizeResponse response;
    const grpc::Status status = workers_->Synchronize(&context, greeting_with_key(worker), &response);
    EXPECT_TRUE(status.ok() && response.leases_size() == 1) << status.error_message();
    return response.leases_size() == 1 ? response.leases(0) : v1::Lease();
  }
  grpc::Status deliver(const v1::SubmitResultRequest& request) {
    grpc::ClientContext context;
    v1::SubmitResultResponse response;
    return workers_->SubmitResult(&context, request, &response);
  }
  static v1::SynchronizeRequest greeting_with_key(char worker) { return server::greeting_with_key(worker); }
};

TEST_F(CoordinatorMetrics, AreDocumentedEachAndNoOthers) {
  start({});
  const auto shown = test::metric_rows(collected());
  const auto documented = test::documented_metric_rows({"Coordinator", "Processes"});
  for (const std::string& row : shown)
    EXPECT_TRUE(documented.contains(row)) << "docs/metrics.md lacks the line\n" << row;
  for (const std::string& row : documented)
    EXPECT_TRUE(shown.contains(row)) << "docs/metrics.md has a line too many\n" << row;
}

// Of the alert rules: tests/alerts compares their names with the documented ones.
TEST_F(CoordinatorMetrics, HaveTheLabelsThatAlertRulesName) {
  start({});
  const auto families = collected();
  const std::string rules = read_file(TESSERA_SOURCE_DIR "/deploy/prometheus/tessera.rules.yml");
  const std::regex selector(R"re((tessera_[a-z_]+)\{([a-z]+)(?:=~|!=|=)"([^"]+)"\})re");
  int checked = 0;
  for (std::sregex_iterator next(rules.begin(), rules.end(), selector), end; next != end; ++next) {
    std::istringstream values((*next)[3]);
    for (std::string value; std::getline(values, value, '|'); ++checked)
      EXPECT_TRUE(test::has_label(families, (*next)[1], (*next)[2], value)) << (*next)[0];
  }
  EXPECT_GE(checked, 6);
}

TEST_F(CoordinatorMetrics, CountJobsWorkersAndSamples) {
  start({});
  submit_now();
  EXPECT_EQ(value("tessera_jobs", {{"state", "running"}}), 1);
  EXPECT_EQ(value("tessera_backlog_samples"), server::kSamples);
  EXPECT_EQ(value("tessera_backlog_seconds"), std::numeric_limits<double>::infinity());
  const v1::Lease lease = lease_to('a');
  EXPECT_EQ(value("tessera_workers", {{"state", "busy"}}), 1);
  EXPECT_EQ(value("tessera_leases_granted_total", {{"kind", "new"}}), 1);
  std::uint64_t samples = 0;
  for (const v1::WorkItem& item : lease.items())
    samples += std::uint64_t{item.sample_end() - item.sample_begin()} *
               static_cast<std::uint64_t>((item.rect().x1() - item.rect().x0()) *
                                          (item.rect().y1() - item.rect().y0()));
  ASSERT_TRUE(deliver(server::delivery_with_key('a', lease)).ok());
  EXPECT_EQ(value("tessera_samples_accepted_total"), samples);
  EXPECT_EQ(value("tessera_backlog_samples"), server::kSamples - samples);
  EXPECT_EQ(value("tessera_result_items_total", {{"verdict", "accepted"}}), lease.items_size());
  ASSERT_TRUE(deliver(server::delivery_with_key('a', lease)).ok());
  EXPECT_EQ(value("tessera_result_items_total", {{"verdict", "dropped"}}), lease.items_size());
  EXPECT_GT(value("tessera_received_bytes_total", {{"of", "results"}}), 0);
  EXPECT_EQ(value("tessera_validations_total", {{"outcome", "accepted"}}), 1);
}

TEST_F(CoordinatorMetrics, CountJobsWhereverTheyAre) {
  start({});
  const std::string cancelled = submit_now();
  submit_now();
  const auto validating = coordinator_->jobs().submit(server::submission());
  ASSERT_TRUE(validating);
  EXPECT_EQ(value("tessera_jobs", {{"state", "validating"}}), 1);
  ASSERT_TRUE(coordinator_->jobs().cancel(cancelled));
  ASSERT_TRUE(coordinator_->checkpointer().checkpoint());
  EXPECT_EQ(coordinator_->jobs().count_in_memory(), 1u);
  EXPECT_EQ(value("tessera_jobs", {{"state", "cancelled"}}), 0) << "it is in the store alone";
  EXPECT_EQ(value("tessera_jobs_ended_total", {{"state", "cancelled"}}), 1);
  EXPECT_EQ(value("tessera_jobs", {{"state", "running"}}), 1);
  ASSERT_TRUE(coordinator_->jobs().cancel(validating->id()));
  EXPECT_EQ(value("tessera_jobs_ended_total", {{"state", "cancelled"}}), 2);
}

TEST_F(CoordinatorMetrics, CountRejectedResultsByTheirReason) {
  start({});
  submit_now();
  const v1::Lease lease = lease_to('a');
  v1::SubmitResultRequest request = server::delivery_with_key('a', lease);
  request.set_lease_token("forged");
  EXPECT_FALSE(deliver(request).ok());
  EXPECT_EQ(value("tessera_results_rejected_total", {{"reason", "token"}}), 1);
  request = server::delivery_with_key('a', lease);
  request.mutable_items(0)->set_planes_zstd("damaged");
  for (int i = 0; i < farm::Quarantine::kRejectionsUntilQuarantine; ++i) EXPECT_FALSE(deliver(request).ok());
  EXPECT_EQ(value("tessera_results_rejected_total", {{"reason", "malformed"}}),
            farm::Quarantine::kRejectionsUntilQuarantine);
  EXPECT_EQ(value("tessera_quarantined_workers"), 1);
  EXPECT_FALSE(deliver(server::delivery_with_key('a', lease)).ok());
  EXPECT_EQ(value("tessera_results_rejected_total", {{"reason", "quarantine"}}), 1);
}

TEST_F(CoordinatorMetrics, CountCallsByMethodAndCode) {
  start_with_names({});
  grpc::ClientContext without_token;
  EXPECT_EQ(list(without_token).error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(value("tessera_calls_total", {{"method", "ListJobs"}, {"code", "UNAUTHENTICATED"}}), 1);
  EXPECT_EQ(value("tessera_rejected_callers_total", {{"code", "UNAUTHENTICATED"}}), 1);
  const auto ada = as("ada");
  v1::GetJobRequest request;
  request.set_job_id("none");
  v1::GetJobResponse response;
  for (int i = 0; i < 3; ++i) {
    grpc::ClientContext context;
    EXPECT_EQ(ada->GetJob(&context, request, &response).error_code(), grpc::StatusCode::NOT_FOUND);
  }
  EXPECT_EQ(value("tessera_calls_total", {{"method", "GetJob"}, {"code", "NOT_FOUND"}}), 3);
  EXPECT_EQ(value("tessera_calls_total", {{"method", "GetJob"}, {"code", "OK"}}), 0);
  EXPECT_EQ(value("tessera_call_duration_seconds", {{"method", "GetJob"}}), 3);
  EXPECT_EQ(value("tessera_calls_in_progress", {{"method", "GetJob"}}), 0);
  grpc::ClientContext context;
  v1::ListJobsResponse jobs;
  EXPECT_TRUE(ada->ListJobs(&context, {}, &jobs).ok());
  EXPECT_EQ(value("tessera_calls_total", {{"method", "ListJobs"}, {"code", "OK"}}), 1);
}

TEST_F(CoordinatorMetrics, ShowCallsInProgressAndTheirEnd) {
  start({});
  grpc::ClientContext context;
  v1::WatchJobRequest request;
  request.set_job_id(submit_now());
  const auto watch = users_->WatchJob(&context, request);
  v1::WatchJobResponse response;
  ASSERT_TRUE(watch->Read(&response));
  EXPECT_EQ(value("tessera_calls_in_progress", {{"method", "WatchJob"}}), 1);
  context.TryCancel();
  EXPECT_EQ(watch->Finish().error_code(), grpc::StatusCode::CANCELLED);
  while (value("tessera_calls_in_progress", {{"method", "WatchJob"}}) > 0) std::this_thread::yield();
  EXPECT_EQ(value("tessera_calls_total", {{"method", "WatchJob"}, {"code", "CANCELLED"}}), 1);
}

TEST_F(CoordinatorMetrics, CountTheBytesOfFilesEitherWay) {
  start({});
  const std::string bytes(3000, 'x');
  ASSERT_TRUE(upload(bytes.size(), bytes).ok());
  EXPECT_EQ(value("tessera_received_bytes_total", {{"of", "blobs"}}), 3000);
  grpc::ClientContext context;
  v1::FetchBlobRequest request;
  *request.mutable_digest() = proto::to_proto(proto::digest_of(bytes));
  const auto stream = workers_->FetchBlob(&context, request);
  v1::FetchBlobResponse response;
  while (stream->Read(&response)) {
  }
  ASSERT_TRUE(stream->Finish().ok());
  EXPECT_EQ(value("tessera_sent_bytes_total", {{"of", "blobs"}}), 3000);
}

TEST_F(CoordinatorMetrics, ShowTasksThatWait) {
  hold_up_scenes();
  server::Limits limits;
  limits.validations = 1;
  start(limits);
  Submission first, second;
  submit(first);
  barrier_.wait_for_someone();
  submit(second);
  while (value("tessera_queued_tasks", {{"pool", "validating"}}) == 0) std::this_thread::yield();
  EXPECT_EQ(value("tessera_queued_tasks", {{"pool", "validating"}}), 1);
  barrier_.open();
  EXPECT_TRUE(first.status.get_future().get().ok());
  EXPECT_TRUE(second.status.get_future().get().ok());
}

TEST_F(CoordinatorMetrics, ShowCheckpointsAndTheStateFolder) {
  start({});
  EXPECT_GT(value("tessera_store_bytes", {{"part", "database"}}), 0);
  EXPECT_GT(value("tessera_store_free_bytes"), 0);
  EXPECT_GT(value("tessera_store_capacity_bytes"), value("tessera_store_free_bytes"));
  const double before = value("tessera_checkpoint_duration_seconds");
  ASSERT_TRUE(coordinator_->checkpointer().checkpoint());
  EXPECT_GT(value("tessera_checkpoint_duration_seconds"), before);
  EXPECT_EQ(value("tessera_checkpoints_failed_total"), 0);
  std::filesystem::remove(folder_.path() / "tessera.db");
  EXPECT_FALSE(coordinator_->checkpointer().checkpoint());
  EXPECT_GT(value("tessera_checkpoints_failed_total"), 0);
  const double age = value("tessera_checkpoint_age_seconds");
  EXPECT_FALSE(coordinator_->checkpointer().checkpoint());
  EXPECT_GT(value("tessera_checkpoint_age_seconds"), age) << "a failed checkpoint saves nothing";
}

TEST_F(CoordinatorMetrics, CountEachHoldOfTheStateLock) {
  start({});
  const double before = value("tessera_state_lock_hold_seconds");
  static_cast<void>(coordinator_->dispatcher().workers());
  EXPECT_GT(value("tessera_state_lock_hold_seconds"), before);
}

}  // namespace
}  // namespace tessera::metrics
