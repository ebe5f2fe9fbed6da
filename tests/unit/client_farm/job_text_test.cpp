// SPDX-License-Identifier: Apache-2.0
#include "client/farm/job_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

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
  EXPECT_EQ(
      jobs_table(jobs, 1090),
      "JOB       NAME     OWNER  STATE    DONE %  TIME LEFT  SIZE PX  SPP  SAMPLES/S  WORKERS  PRIORITY  "
      "SUBMITTED\n"
      "01234567  cornell  -      running      99       0:00  640x480   16      1.50M        2         0   "
      "1:30 ago\n");
}

TEST(JobText, SaysHowAJobIsServedAndWhichPartOfTheImageItIs) {
  v1::ListJobsResponse jobs;
  v1::Job& job = *jobs.add_jobs() = some_job();
  job.set_priority(-5);
  job.set_max_workers(3);
  v1::PixelRect& crop = *job.mutable_settings()->mutable_crop();
  crop.set_x0(600);
  crop.set_y0(10);
  crop.set_x1(640);
  crop.set_y1(40);
  EXPECT_THAT(jobs_table(jobs, 1090), HasSubstr("  40x30   16      1.50M      2/3        -5   1:30 ago\n"));
  EXPECT_THAT(job_description(job, 1090), HasSubstr("size        40x30\n"));
  EXPECT_THAT(job_description(job, 1090), HasSubstr("crop        600,10,640,40 of 640x480\n"));
  EXPECT_THAT(job_description(job, 1090), HasSubstr("priority    -5\n"));
  EXPECT_THAT(job_description(job, 1090), HasSubstr("workers     2/3\n"));
}

TEST(JobText, AJobThatIsOverHasNoSpeed) {
  v1::Job job = some_job();
  EXPECT_THAT(job_description(job, 1090), HasSubstr("1.50M samples/s"));
  job.set_state(v1::JOB_STATE_DONE);
  EXPECT_THAT(job_description(job, 1090), ::testing::Not(HasSubstr("samples/s")));
}

// The clock of the coordinator was set ahead by ten years, or back.
TEST(JobText, TellsHowLongAJobTookWhateverTheTimeOfDayIs) {
  v1::Job job = some_job();
  job.set_samples_done(10'000'000);
  for (const std::int64_t finished : {-1000, 315'360'000}) {
    job.mutable_finished_at()->set_seconds(finished);
    EXPECT_THAT(written_text(job, {"a.exr", "a.png"}, 2.5), HasSubstr("wrote a.exr, a.png ("));
    EXPECT_THAT(written_text(job, {"a.exr"}, 2.5), HasSubstr(" in 2.50 s, 4.00M samples/s"));
  }
}

TEST(JobText, DescribesWhatWentWrong) {
  v1::Job job = some_job();
  job.set_state(v1::JOB_STATE_FAILED);
  job.set_failure("no such mesh");
  job.mutable_counters()->set_non_finite_samples(3);
  const std::string text = job_description(job, 1090);
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
              HasSubstr("cornell  -      validating       -          -        -    -          -        0"));
  EXPECT_THAT(job_description(job, 1090), HasSubstr("size        -\n"));
  EXPECT_THAT(job_description(job, 1090), HasSubstr("samples     -\n"));
  EXPECT_EQ(progress_of(job).note, "validating");
  EXPECT_FALSE(is_over(job.state()));
}

TEST(JobText, ShowsLabelsWarningsAndWorkersThatFailed) {
  v1::Job job = some_job();
  (*job.mutable_labels())["shot"] = "12";
  (*job.mutable_labels())["show"] = "vase";
  job.add_warnings("a texture is missing");
  job.mutable_failure_details()->add_workers("render-07");
  const std::string text = job_description(job, 1090);
  EXPECT_THAT(text, HasSubstr("label       shot=12\nlabel       show=vase\n"));
  EXPECT_THAT(text, HasSubstr("warning     a texture is missing\n"));
  EXPECT_THAT(text, HasSubstr("failed on   render-07\n"));
}

TEST(JobText, SaysHowWorkersAreDoing) {
  v1::ListWorkersResponse workers;
  v1::Worker& worker = *workers.add_workers();
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("idle"));
  worker.set_held_leases(1);
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

TEST(JobText, NamesWorkersInCooldownAndItsEnd) {
  v1::ListWorkersResponse workers;
  v1::Worker& worker = *workers.add_workers();
  worker.set_name("machine");
  worker.set_id("1234567890abcdef");
  auto& bar = *worker.add_cooldowns();
  bar.set_job_id("fedcba0987654321");
  bar.mutable_remaining()->set_seconds(95);
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("in cooldown"));
  EXPECT_THAT(
      workers_table(workers, 0),
      HasSubstr("\nmachine (12345678) gets no lease of job fedcba098765 for 95 s, or until it delivers "
                "some of it\n"));
  bar.set_fetching(true);
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("  fetching  "));
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("of job fedcba098765 until it has fetched its scene\n"));
  worker.set_stuck(true);
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("stuck"));
  EXPECT_THAT(workers_table(workers, 0),
              HasSubstr("\nmachine (12345678) still renders a lease that it lost"));
}

TEST(JobText, SaysHowMuchIsToBeVerified) {
  v1::Job job = some_job();
  EXPECT_THAT(job_description(job, 1090), ::testing::Not(HasSubstr("to verify")));
  job.set_samples_to_verify(42);
  EXPECT_THAT(job_description(job, 1090), HasSubstr("to verify"));
  EXPECT_THAT(job_description(job, 1090), HasSubstr("42 samples"));
}

TEST(JobText, ProgressNamesTheWorkers) {
  v1::Job job = some_job();
  EXPECT_EQ(progress_of(job).note, "2 workers");
  job.set_active_workers(1);
  EXPECT_EQ(progress_of(job).note, "1 worker");
  job.set_state(v1::JOB_STATE_PAUSED);
  EXPECT_EQ(progress_of(job).note, "paused");
  EXPECT_EQ(progress_of(job).samples_done, 999u);
}

TEST(JobText, ARunningJobWithoutWorkersIsQueued) {
  v1::ListJobsResponse jobs;
  v1::Job& job = *jobs.add_jobs() = some_job();
  job.set_active_workers(0);
  job.set_samples_per_second(0);
  job.set_queue_position(2);
  job.set_waiting_reason("no worker is connected");
  EXPECT_THAT(jobs_table(jobs, 1090), HasSubstr("  queued (2)  "));
  EXPECT_THAT(jobs_table(jobs, 1090), HasSubstr("\ncornell (01234567) is queued: no worker is connected\n"));
  EXPECT_EQ(progress_of(job).note, "queued, place 2: no worker is connected");
  EXPECT_THAT(job_description(job, 1090), HasSubstr("no worker is connected"));
  job.set_active_workers(1);
  EXPECT_THAT(jobs_table(jobs, 1090), ::testing::Not(HasSubstr("queued")));
}

TEST(JobText, IdsInTablesAreUniquePrefixes) {
  v1::ListJobsResponse jobs;
  *jobs.add_jobs() = some_job();
  jobs.add_jobs()->set_id(
      "01234567"
      "8"
      "0000000000000000000000000");
  jobs.add_jobs()->set_id(
      "0123456789"
      "0000000000000000000000");
  EXPECT_THAT(jobs_table(jobs, 0), HasSubstr("\n0123456789a  "));
}

TEST(JobText, TablesFitNarrowTerminals) {
  v1::ListJobsResponse jobs;
  *jobs.add_jobs() = some_job();
  for (const int columns : {40, 60, 80}) {
    std::istringstream lines(jobs_table(jobs, 0, {.columns = columns}));
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(line.size(), static_cast<std::size_t>(columns)) << line;
  }
  EXPECT_THAT(jobs_table(jobs, 0, {.columns = 60}), HasSubstr("TIME LEFT"));
}

TEST(JobText, StatesAreColoredOnTerminalsAlone) {
  v1::ListJobsResponse jobs;
  *jobs.add_jobs() = some_job();
  EXPECT_THAT(jobs_table(jobs, 0, {.colored = true}), HasSubstr("\033[36mrunning\033[0m  "));
  EXPECT_EQ(jobs_table(jobs, 0).find('\033'), std::string::npos);
}

TEST(JobText, AListIsAnObjectInEachLine) {
  v1::ListJobsResponse jobs;
  *jobs.add_jobs() = some_job();
  *jobs.add_jobs() = some_job();
  const std::string line = to_json_line(some_job());
  EXPECT_EQ(to_json_lines(jobs.jobs()), line + line);
  EXPECT_EQ(line.find('\n'), line.size() - 1);
}

}  // namespace
}  // namespace tessera::client
