// SPDX-License-Identifier: Apache-2.0
#include "client/farm/job_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

namespace tessera::client {
namespace {

using ::testing::HasSubstr;

v1::Job some_job() {
  v1::Job job;
  job.set_id("0123456789abcdef0123456789abcdef");
  job.set_name("cornell");
  job.set_state(v1::JOB_STATE_RUNNING);
  job.mutable_settings()->set_width_px(640);
  job.mutable_settings()->set_height_px(480);
  job.mutable_settings()->set_spp(16);
  job.mutable_settings()->set_integrator(v1::INTEGRATOR_NEE);
  job.set_samples_total(1000);
  job.set_samples_done(999);
  job.set_samples_per_second(1.5e6);
  job.set_active_workers(2);
  job.mutable_created_at()->set_seconds(1000);
  return job;
}

TEST(JobText, OnlyWhatIsCompleteIsAHundredPercent) {
  v1::ListJobsResponse jobs;
  *jobs.add_jobs() = some_job();
  EXPECT_EQ(jobs_table(jobs, 1090),
            "JOB           NAME     STATE    DONE     SIZE  SPP  SAMPLES  WORKERS  PRIORITY  SUBMITTED\n"
            "0123456789ab  cornell  running   99%  640x480   16  1.50M/s        2         0   1:30 ago\n");
}

TEST(JobText, SaysHowAJobIsServedAndWhichPartOfThePictureItIs) {
  v1::ListJobsResponse jobs;
  v1::Job& job = *jobs.add_jobs() = some_job();
  job.set_priority(-5);
  job.set_max_workers(3);
  v1::PixelRect& crop = *job.mutable_settings()->mutable_crop();
  crop.set_x0(600);
  crop.set_y0(10);
  crop.set_x1(640);
  crop.set_y1(40);
  EXPECT_THAT(jobs_table(jobs, 1090), HasSubstr("  40x30   16  1.50M/s      2/3        -5   1:30 ago\n"));
  EXPECT_THAT(job_description(job), HasSubstr("size        40x30\n"));
  EXPECT_THAT(job_description(job), HasSubstr("crop        600,10,640,40 of 640x480\n"));
  EXPECT_THAT(job_description(job), HasSubstr("priority    -5\n"));
  EXPECT_THAT(job_description(job), HasSubstr("workers     2/3\n"));
}

TEST(JobText, AJobThatIsOverHasNoSpeed) {
  v1::Job job = some_job();
  EXPECT_THAT(job_description(job), HasSubstr("1.50M/s"));
  job.set_state(v1::JOB_STATE_DONE);
  EXPECT_THAT(job_description(job), ::testing::Not(HasSubstr("/s")));
}

TEST(JobText, DescribesWhatWentWrong) {
  v1::Job job = some_job();
  job.set_state(v1::JOB_STATE_FAILED);
  job.set_failure("no such mesh");
  job.mutable_counters()->set_non_finite_samples(3);
  const std::string text = job_description(job);
  EXPECT_THAT(text, HasSubstr("failed"));
  EXPECT_THAT(text, HasSubstr("no such mesh"));
  EXPECT_THAT(text, HasSubstr("non-finite"));
  EXPECT_THAT(text, HasSubstr("nee"));
}

TEST(JobText, SaysWhatIsKnownBeforeTheSceneIsValidated) {
  v1::ListJobsResponse jobs;
  v1::Job& job = *jobs.add_jobs();
  job.set_id("0123456789abcdef0123456789abcdef");
  job.set_name("cornell");
  job.set_state(v1::JOB_STATE_VALIDATING);
  job.mutable_created_at()->set_seconds(1000);
  EXPECT_THAT(jobs_table(jobs, 1090),
              HasSubstr("cornell  validating           -    -        -        0         0"));
  EXPECT_THAT(job_description(job), HasSubstr("size        -\n"));
  EXPECT_THAT(job_description(job), HasSubstr("samples     -\n"));
  EXPECT_EQ(progress_of(job).note, "validating");
  EXPECT_FALSE(is_over(job.state()));
}

TEST(JobText, ShowsLabelsWarningsAndWorkersThatFailed) {
  v1::Job job = some_job();
  (*job.mutable_labels())["shot"] = "12";
  (*job.mutable_labels())["show"] = "vase";
  job.add_warnings("a texture is missing");
  job.mutable_failure_details()->add_workers("render-07");
  const std::string text = job_description(job);
  EXPECT_THAT(text, HasSubstr("label       shot=12\nlabel       show=vase\n"));
  EXPECT_THAT(text, HasSubstr("warning     a texture is missing\n"));
  EXPECT_THAT(text, HasSubstr("failed on   render-07\n"));
}

TEST(JobText, SaysHowWorkersAreDoing) {
  v1::ListWorkersResponse workers;
  v1::Worker& worker = *workers.add_workers();
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("working"));
  worker.set_draining(true);
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("leaving"));
  worker.set_silent(true);
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("silent"));
  worker.set_quarantined(true);
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("quarantined"));
  worker.set_name("machine");
  worker.set_audited_ranges(9);
  worker.set_disproved_ranges(2);
  worker.set_quarantine_reason("it rendered different bits");
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("9 (2 wrong)"));
  EXPECT_THAT(workers_table(workers, 0),
              HasSubstr("\nmachine () is quarantined: it rendered different bits\n"));
}

TEST(JobText, SaysWhoIsGivenNothingAndForHowLong) {
  v1::ListWorkersResponse workers;
  v1::Worker& worker = *workers.add_workers();
  worker.set_name("machine");
  worker.set_id("1234567890abcdef");
  auto& bar = *worker.add_cooldowns();
  bar.set_job_id("fedcba0987654321");
  bar.mutable_remaining()->set_seconds(95);
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("in cooldown"));
  EXPECT_THAT(workers_table(workers, 0),
              HasSubstr("\nmachine (1234567890ab) is given nothing of job fedcba098765 for 1:35, or until it "
                        "delivers some of it\n"));
  bar.set_fetching(true);
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("  fetching  "));
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("of job fedcba098765 until it has fetched its scene\n"));
  worker.set_stuck(true);
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("stuck"));
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("\nmachine (1234567890ab) still renders what went to "));
}

TEST(JobText, SaysHowMuchIsToBeVerified) {
  v1::Job job = some_job();
  EXPECT_THAT(job_description(job), ::testing::Not(HasSubstr("to verify")));
  job.set_samples_to_verify(42);
  EXPECT_THAT(job_description(job), HasSubstr("to verify"));
  EXPECT_THAT(job_description(job), HasSubstr("42 samples"));
}

TEST(JobText, ProgressSaysWhoWorks) {
  v1::Job job = some_job();
  EXPECT_EQ(progress_of(job).note, "2 workers");
  job.set_active_workers(1);
  EXPECT_EQ(progress_of(job).note, "1 worker");
  job.set_state(v1::JOB_STATE_PAUSED);
  EXPECT_EQ(progress_of(job).note, "paused");
  EXPECT_EQ(progress_of(job).samples_done, 999u);
}

TEST(JobText, JsonIsOneLineWithTheContractsNames) {
  const std::string json = to_json_line(some_job());
  EXPECT_THAT(json, HasSubstr("\"samples_done\":\"999\""));
  EXPECT_THAT(json, HasSubstr("\"state\":\"JOB_STATE_RUNNING\""));
  EXPECT_THAT(json, HasSubstr("\"priority\":0"));
  EXPECT_EQ(json.find('\n'), json.size() - 1);
}

// A coordinator may send such a time. Everything else is printed.
TEST(JobText, JsonLeavesOutTimesThatJsonCannotExpress) {
  v1::ListJobsResponse jobs;
  *jobs.add_jobs() = some_job();
  *jobs.add_jobs() = some_job();
  jobs.mutable_jobs(0)->mutable_created_at()->set_seconds(std::numeric_limits<std::int64_t>::max());
  const auto lines = nlohmann::json::parse(to_json_line(jobs));
  EXPECT_FALSE(lines["jobs"][0].contains("created_at") && !lines["jobs"][0]["created_at"].is_null());
  EXPECT_EQ(lines["jobs"][0]["id"], some_job().id());
  EXPECT_TRUE(lines["jobs"][1].contains("created_at"));
}

}  // namespace
}  // namespace tessera::client
