// SPDX-License-Identifier: Apache-2.0
// The users' commands for jobs.
#include <gmock/gmock.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class JobsTest : public FarmTest {
 protected:
  // Has far more samples than this test waits for.
  std::string submit_long_job() { return submit({"--size", "256x256", "--spp", "100000", "--name", "long"}); }
};

TEST_F(JobsTest, PausedJobsWaitAndResumedOnesGiveTheSameImage) {
  start_coordinator();
  start_worker("worker", 2);
  const std::vector<std::string> options{"--size", "192x128", "--spp", "48"};
  const std::string id = submit(options);
  ASSERT_TRUE(wait_for_samples(id, 1));
  ASSERT_EQ(tessera({"pause", id}).exit_code, 0);
  ASSERT_EQ(job(id).state(), v1::JOB_STATE_PAUSED);
  ASSERT_TRUE(poll_until(std::chrono::seconds(20), [&] { return job(id).active_workers() == 0; }));
  EXPECT_LT(job(id).samples_done(), job(id).samples_total());
  ASSERT_EQ(tessera({"resume", id}).exit_code, 0);
  ASSERT_EQ(tessera({"watch", id}).exit_code, 0);
  EXPECT_TRUE(image(id, ".exr") == render_here(options, ".exr"));
}

TEST_F(JobsTest, AnExtendedJobGivesTheImageOfMoreSamples) {
  start_coordinator();
  start_worker("worker", 2);
  const std::string id = submit({"--size", "130x100", "--spp", "5"});
  ASSERT_EQ(tessera({"watch", id}).exit_code, 0);
  EXPECT_TRUE(image(id, ".exr") == render_here({"--size", "130x100", "--spp", "5"}, ".exr"));
  ASSERT_EQ(tessera({"extend", id, "--spp", "23"}).exit_code, 0);
  ASSERT_EQ(tessera({"watch", id}).exit_code, 0);
  EXPECT_EQ(job(id).samples_done(), 130u * 100 * 23);
  EXPECT_TRUE(image(id, ".exr") == render_here({"--size", "130x100", "--spp", "23"}, ".exr"));
  const Outcome fewer = tessera({"extend", id, "--spp", "3"});
  EXPECT_EQ(fewer.exit_code, 1);
  EXPECT_THAT(fewer.err, HasSubstr("3"));
}

TEST_F(JobsTest, ACancelledJobKeepsItsImageUntilItIsDeleted) {
  start_coordinator();
  start_worker("worker", 1);
  const std::string id = submit_long_job();
  ASSERT_TRUE(wait_for_samples(id, 1));
  ASSERT_EQ(tessera({"cancel", id}).exit_code, 0);
  const Outcome watched = tessera({"watch", id});
  EXPECT_EQ(watched.exit_code, 1);
  EXPECT_THAT(watched.err, HasSubstr("cancelled"));
  EXPECT_FALSE(image(id, ".png").empty());
  EXPECT_EQ(tessera({"resume", id}).exit_code, 1);
  ASSERT_EQ(tessera({"delete", id}).exit_code, 0);
  const Outcome gone = tessera({"job", id});
  EXPECT_EQ(gone.exit_code, 1);
  EXPECT_THAT(gone.err, HasSubstr("no job '" + id + "'"));

  // The worker can render other jobs at once.
  const std::string next = submit({"--size", "64x64", "--spp", "1"});
  EXPECT_EQ(tessera({"watch", next}).exit_code, 0);
}

TEST_F(JobsTest, AnUnfinishedImageCanBeFetched) {
  start_coordinator();
  start_worker("worker", 1);
  const std::string id = submit_long_job();
  ASSERT_TRUE(wait_for_samples(id, 256 * 256));
  const std::string png = image(id, ".png");
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
}

TEST_F(JobsTest, ListsAreForPeopleAndForPrograms) {
  start_coordinator();
  start_worker("somebody", 1);
  ASSERT_TRUE(wait_for_workers(1));
  const std::string id = submit_long_job();
  const Outcome jobs = tessera({"jobs"});
  EXPECT_THAT(jobs.out, HasSubstr(id.substr(0, 8)));
  EXPECT_THAT(jobs.out, HasSubstr("long"));
  EXPECT_THAT(tessera({"jobs", "--json"}).out, HasSubstr("\"id\":\"" + id + "\""));
  EXPECT_THAT(tessera({"workers"}).out, HasSubstr("somebody"));
  EXPECT_THAT(tessera({"workers", "--json"}).out, HasSubstr("\"name\":\"somebody\""));
  EXPECT_THAT(tessera({"workers", "--seen-within", "1h"}).out, HasSubstr("somebody"));
  EXPECT_THAT(tessera({"workers", "--state", "quarantined", "--state", "in cooldown"}).out,
              Not(HasSubstr("somebody")));
  EXPECT_THAT(tessera({"workers", "--unseen-for", "1h"}).out, Not(HasSubstr("somebody")));
  EXPECT_THAT(tessera({"workers", "--principal", "nobody"}).out, Not(HasSubstr("somebody")));
  EXPECT_THAT(tessera({"workers", "--state", "idel"}).err, HasSubstr("did you mean 'idle'?"));
  EXPECT_THAT(tessera({"jobs", "--state", "queud"}).err, HasSubstr("did you mean 'queued'?"));
  EXPECT_EQ(tessera({"jobs", "--state", "queued", "--json"}).exit_code, 0);
  EXPECT_THAT(tessera({"job", id.substr(0, 6)}).out, HasSubstr(id)) << "the beginning of an id names the job";
}

TEST_F(JobsTest, EveryCommandPrintsJsonInOneVocabulary) {
  start_coordinator();
  const Outcome submitted = tessera({"submit", kCornell, "--size", "32x32", "--spp", "2", "--json"});
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  EXPECT_THAT(submitted.err, HasSubstr("no worker is connected"));
  const auto job = nlohmann::json::parse(submitted.out);
  EXPECT_EQ(job["state"], "running");
  EXPECT_EQ(job["spp"], 2);
  const std::string id = job["id"];
  start_worker("worker", 1);
  std::istringstream changes(tessera({"watch", id, "--json"}).out);
  nlohmann::json last;
  for (std::string line; std::getline(changes, line);) last = nlohmann::json::parse(line);
  EXPECT_EQ(last["state"], "done");
  EXPECT_EQ(last["samples_done"], 32 * 32 * 2);
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"jobs"}, {"job", id}, {"workers"}, {"server"}, {"extend", id, "--spp", "4"}, {"delete", id}}) {
    std::vector<std::string> words = command;
    words.emplace_back("--json");
    const Outcome outcome = tessera(words);
    EXPECT_TRUE(nlohmann::json::parse(outcome.out, nullptr, false).is_object()) << outcome.out << outcome.err;
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1);
  }
}

TEST_F(JobsTest, AnImageCanBeFetchedInPart) {
  start_coordinator();
  start_worker("worker", 1);
  const std::string id = submit({"--size", "64x48", "--spp", "2"});
  ASSERT_EQ(tessera({"watch", id}).exit_code, 0);
  const std::string part = folder_ / "part.pfm", window = folder_ / "window.pfm";
  ASSERT_EQ(tessera({"image", id, "-o", part, "--region", "10,5,40,30"}).exit_code, 0);
  ASSERT_EQ(
      tessera({"render", kCornell, "--size", "64x48", "--spp", "2", "--crop", "10,5,40,30", "-o", window})
          .exit_code,
      0);
  EXPECT_TRUE(read_file(part) == read_file(window));
  EXPECT_EQ(tessera({"image", id, "-o", part, "--region", "10,5,40,49"}).exit_code, 1);
}

TEST_F(JobsTest, AreViewedUntilTheyEnd) {
  start_coordinator();
  const std::string id = submit({"--size", "64x48", "--spp", "8"});
  Process view = start_tessera({"view", id, "--protocol", "blocks"});
  start_worker("worker", 1);
  EXPECT_EQ(view.wait(std::chrono::seconds(60)), 0);
  EXPECT_THAT(view.out(), HasSubstr("\033[38;2;"));
  EXPECT_THAT(view.out(), HasSubstr("  done  64x48 pixels  100 %"));
  EXPECT_THAT(view.out(), ::testing::EndsWith("\033[?25h\n")) << "the cursor is shown again";
}

TEST_F(JobsTest, AreFoundByTheirLabels) {
  start_coordinator();
  const std::string shot = submit({"--spp", "1", "--label", "shot=12", "--label", "show=vase"});
  const std::string other = submit({"--spp", "1", "--label", "shot=13"});
  const std::string listed = tessera({"jobs", "--label", "shot=12", "--label", "show=vase"}).out;
  EXPECT_THAT(listed, HasSubstr(shot.substr(0, 8)));
  EXPECT_THAT(listed, Not(HasSubstr(other.substr(0, 8))));
  EXPECT_THAT(tessera({"job", shot}).out, HasSubstr("show=vase"));
  const Outcome wrong = tessera({"submit", kCornell, "--label", "nothing"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--label: must be KEY=VALUE; got 'nothing'"));
}

TEST_F(JobsTest, WithoutACoordinatorCommandsWaitForItsStartAndSayHowToStartOne) {
  start_coordinator();
  kill_coordinator();
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"jobs"}, {"workers"}, {"watch", "1"}, {"submit", kCornell}}) {
    const Outcome outcome = tessera(command);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("no coordinator answers at " + address()));
    EXPECT_THAT(outcome.err, HasSubstr("tessera-coordinator"));
    EXPECT_THAT(outcome.err, ::testing::StartsWith("tessera: warning: no connection to the coordinator at "));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 2) << outcome.err;
  }
}

TEST_F(JobsTest, AnUpdateChangesWorkerLimitAndPriority) {
  start_coordinator();
  for (const char* name : {"one", "two", "three"}) start_worker(name, 1);
  ASSERT_TRUE(wait_for_workers(3));
  const std::vector<std::string> long_job{"--size", "256x256", "--spp", "100000"};
  const auto submit_with = [&](std::vector<std::string> options) {
    options.insert(options.end(), long_job.begin(), long_job.end());
    return submit(options);
  };
  const auto workers_of = [&](const std::string& id) { return job(id).active_workers(); };
  const auto comes_to = [&](const std::string& id, std::uint32_t count) {
    return poll_until(std::chrono::seconds(60), [&] { return workers_of(id) == count; });
  };
  const std::string limited = submit_with({"--max-workers", "1", "--priority", "3"});
  ASSERT_TRUE(wait_for_samples(limited, 1));
  EXPECT_EQ(workers_of(limited), 1u) << "two are idle";
  const std::string other = submit_with({});
  EXPECT_TRUE(comes_to(other, 2)) << "they have something to do now";

  const Outcome raised = tessera({"update", limited, "--max-workers", "2"});
  ASSERT_EQ(raised.exit_code, 0) << raised.err;
  EXPECT_THAT(raised.out, HasSubstr("priority 3, at most 2 workers"));
  EXPECT_TRUE(comes_to(limited, 2));
  EXPECT_THAT(tessera({"jobs"}).out, HasSubstr("2/2"));
  // Its priority is below that of the other job, which may have all workers.
  ASSERT_EQ(tessera({"update", limited, "--priority", "-1"}).exit_code, 0);
  EXPECT_TRUE(comes_to(limited, 0));
  EXPECT_TRUE(comes_to(other, 3));
  ASSERT_EQ(tessera({"update", other, "--max-workers", "1"}).exit_code, 0);
  EXPECT_TRUE(comes_to(other, 1));
  EXPECT_TRUE(comes_to(limited, 2));

  kill_coordinator();
  restart_coordinator();
  EXPECT_EQ(job(limited).priority(), -1);
  EXPECT_EQ(job(limited).max_workers(), 2u);
  EXPECT_EQ(job(other).max_workers(), 1u);
  EXPECT_TRUE(comes_to(limited, 2));

  EXPECT_EQ(tessera({"update", limited}).exit_code, 2) << "nothing to change";
  ASSERT_EQ(tessera({"cancel", limited}).exit_code, 0);
  const Outcome over = tessera({"update", limited, "--priority", "9"});
  EXPECT_EQ(over.exit_code, 1);
  EXPECT_THAT(over.err, HasSubstr("is cancelled"));
}

}  // namespace
}  // namespace tessera::test
