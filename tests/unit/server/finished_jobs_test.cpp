// SPDX-License-Identifier: Apache-2.0
// Finished jobs, which the store alone has: they are listed, fetched, extended and deleted like others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "proto/blob.hpp"
#include "server/jobs/retirement.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class FinishedJobs : public ScriptedFarm {
 protected:
  // Returns the id of a job that is done, stored and published.
  std::string finish(const v1::SubmitJobRequest& request = submission()) {
    const std::string id = submit(request);
    work('a');
    EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
    return id;
  }
  std::vector<std::string> listed_ids(const v1::ListJobsRequest& request = {}) {
    std::vector<std::string> ids;
    for (const v1::Job& job : listed(request)) ids.push_back(job.id());
    return ids;
  }
  std::vector<std::string> ids_of_pages(v1::ListJobsRequest request) {
    std::vector<std::string> ids;
    for (;;) {
      const auto page = coordinator().jobs().list(request);
      if (!page) return ids;
      for (const v1::Job& job : page->jobs()) ids.push_back(job.id());
      if (page->next_page_token().empty()) return ids;
      request.set_page_token(page->next_page_token());
    }
  }
  void expect_whole_image(const std::string& id, std::uint32_t spp = kSpp) {
    const auto image = coordinator().images().get(id);
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_TRUE(image->image.pixels == ready_made_image(kWidthPx, kHeightPx, spp).pixels);
  }
};

TEST_F(FinishedJobs, AreReadAsBeforeEviction) {
  v1::SubmitJobRequest request = submission();
  request.set_name("a name");
  request.set_priority(3);
  request.set_max_workers(2);
  const std::string id = submit(request);
  work('a');
  v1::Job before = job(id);
  const v1::Job after = stored_job(id);
  EXPECT_EQ(after.state(), v1::JOB_STATE_DONE);
  EXPECT_TRUE(after.has_finished_at());
  EXPECT_EQ(after.samples_done(), kSamples);
  // What a job in memory has besides.
  *before.mutable_finished_at() = after.finished_at();
  *before.add_events() = *after.events().rbegin();
  before.set_state(after.state());
  before.set_samples_per_second(0);
  EXPECT_GT(after.revision(), before.revision());
  before.set_revision(after.revision());
  EXPECT_EQ(before.SerializeAsString(), after.SerializeAsString());
  open();
  EXPECT_EQ(job(id).SerializeAsString(), after.SerializeAsString());
  expect_whole_image(id);
}

TEST_F(FinishedJobs, AllowOnlyWhatTheirStateAllows) {
  const std::string done = finish(), cancelled = submit();
  ASSERT_TRUE(coordinator().jobs().cancel(cancelled));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  jobs::JobService& jobs = coordinator().jobs();
  EXPECT_EQ(jobs.cancel(cancelled)->state(), v1::JOB_STATE_CANCELLED) << "can be repeated";
  EXPECT_EQ(jobs.cancel(done).error().message, "job " + done + " is done and cannot become cancelled");
  EXPECT_EQ(jobs.pause(done).error().code, ErrorCode::kFailedPrecondition);
  EXPECT_THAT(jobs.resume(done).error().message, HasSubstr("is done: extend it"));
  EXPECT_EQ(jobs.resume(cancelled).error().code, ErrorCode::kFailedPrecondition);
  v1::UpdateJobRequest update;
  update.set_job_id(done);
  update.set_priority(3);
  EXPECT_EQ(jobs.update(update).error().code, ErrorCode::kFailedPrecondition);
  EXPECT_EQ(jobs.extend(cancelled, 99).error().code, ErrorCode::kFailedPrecondition);
  EXPECT_EQ(jobs.extend(done, kSpp - 1).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(jobs.extend(done, kSpp)->state(), v1::JOB_STATE_DONE);
}

TEST_F(FinishedJobs, AreExtendedAlsoAfterACrash) {
  const std::string id = finish();
  open();
  EXPECT_EQ(coordinator().jobs().extend(id, kSpp + 4)->state(), v1::JOB_STATE_RUNNING);
  EXPECT_FALSE(job(id).has_finished_at());
  EXPECT_EQ(job(id).samples_done(), kSamples);
  const auto crashed = folder_.path() / "crashed";
  std::filesystem::copy(folder_.path() / "state", crashed, std::filesystem::copy_options::recursive);
  open(crashed);
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  work('b');
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  expect_whole_image(id, kSpp + 4);
}

TEST_F(FinishedJobs, CountForTheirRequestAndNotForTheirOwner) {
  limits_.open_jobs = 1;
  open();
  v1::SubmitJobRequest request = submission();
  request.set_request_id("once");
  const std::string id = finish(request);
  EXPECT_EQ(submit(request), id);
  EXPECT_EQ(coordinator().jobs().submit(request, "another").error().code, ErrorCode::kAlreadyExists);
  const std::string other = submit();
  EXPECT_EQ(coordinator().jobs().extend(id, 99).error().code, ErrorCode::kResourceExhausted);
  ASSERT_TRUE(coordinator().jobs().cancel(other));
  EXPECT_TRUE(coordinator().jobs().extend(id, 99));
  EXPECT_EQ(coordinator().jobs().submit(submission()).error().code, ErrorCode::kResourceExhausted);
}

TEST_F(FinishedJobs, LateResultsOfThemAreDropped) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  ASSERT_TRUE(coordinator().jobs().cancel(id));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  EXPECT_EQ(deliver(delivery('a', lease)).dropped_items(), static_cast<std::uint32_t>(lease.items_size()));
}

TEST_F(FinishedJobs, KeepTheirFilesUntilTheyAreDeleted) {
  const std::string id = finish();
  const auto age = [&] {
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(folder_.path() / "state" / "blobs"))
      if (entry.is_regular_file())
        std::filesystem::last_write_time(
            entry, std::filesystem::file_time_type::clock::now() - std::chrono::hours(99));
  };
  const auto digest = proto::digest_of(kSceneBytes);
  for (const bool restart : {false, true}) {
    if (restart) open();
    age();
    coordinator().files().collect();
    EXPECT_TRUE(coordinator().blobs().contains(digest));
  }
  ASSERT_TRUE(coordinator().jobs().remove(id));
  coordinator().files().collect();
  EXPECT_FALSE(coordinator().blobs().contains(digest));
}

TEST_F(FinishedJobs, LeaveTheMemory) {
  const std::string id = finish(), other = submit();
  EXPECT_EQ(coordinator().jobs().count_in_memory(), 1u);
  ASSERT_TRUE(coordinator().jobs().cancel(other));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  EXPECT_EQ(coordinator().jobs().count_in_memory(), 0u);
  EXPECT_EQ(listed_ids().size(), 2u);
  open();
  EXPECT_EQ(coordinator().jobs().count_in_memory(), 0u);
  ASSERT_TRUE(coordinator().jobs().extend(id, 99));
  EXPECT_EQ(coordinator().jobs().count_in_memory(), 1u);
  ASSERT_TRUE(coordinator().jobs().remove(id));
  EXPECT_EQ(coordinator().jobs().count_in_memory(), 0u);
}

TEST_F(FinishedJobs, AreListedTogetherWithOthersInPages) {
  std::vector<std::string> ids;
  for (int i = 0; i < 9; ++i) ids.insert(ids.begin(), i % 3 == 0 ? finish() : submit());
  EXPECT_EQ(listed_ids(), ids);
  v1::ListJobsRequest request;
  for (const std::uint32_t size : {1u, 2u, 4u, 9u, 100u}) {
    request.set_page_size(size);
    EXPECT_EQ(ids_of_pages(request), ids) << size;
  }
  request.set_page_size(2);
  request.add_states(v1::JOB_STATE_RUNNING);
  std::vector<std::string> running;
  for (const std::string& id : ids)
    if (job(id).state() == v1::JOB_STATE_RUNNING) running.push_back(id);
  EXPECT_EQ(ids_of_pages(request), running);
}

TEST_F(FinishedJobs, ThatMoveBetweenPagesAreNeitherHiddenNorRepeated) {
  std::vector<std::string> ids;
  for (int i = 0; i < 6; ++i) ids.insert(ids.begin(), submit());
  v1::ListJobsRequest request;
  request.set_page_size(2);
  std::vector<std::string> found;
  for (int page = 0; page < 3; ++page) {
    const auto listed = coordinator().jobs().list(request);
    ASSERT_TRUE(listed);
    for (const v1::Job& job : listed->jobs()) found.push_back(job.id());
    request.set_page_token(listed->next_page_token());
    if (page == 0) work('a');
    if (page == 0) {
      EXPECT_TRUE(coordinator().checkpointer().checkpoint());
    }
    if (page == 1) {
      EXPECT_TRUE(coordinator().jobs().extend(ids[4], 99));
    }
    submit();
  }
  EXPECT_EQ(found, ids);
}

TEST_F(FinishedJobs, AreFilteredByOwnerStateAndTime) {
  const std::string ann = submit(submission(), "ann"), bob = submit(submission(), "bob");
  ASSERT_TRUE(coordinator().jobs().cancel(ann));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  v1::ListJobsRequest request;
  request.set_owner("ann");
  EXPECT_THAT(listed_ids(request), ElementsAre(ann));
  request.add_states(v1::JOB_STATE_DONE);
  EXPECT_THAT(listed_ids(request), IsEmpty());
  request.add_states(v1::JOB_STATE_CANCELLED);
  EXPECT_THAT(listed_ids(request), ElementsAre(ann));
  request = {};
  *request.mutable_created_before() = job(ann).created_at();
  EXPECT_THAT(listed_ids(request), IsEmpty());
  request = {};
  *request.mutable_created_from() = job(bob).created_at();
  EXPECT_EQ(listed_ids(request).front(), bob);
  request = {};
  request.set_page_token("no token");
  EXPECT_EQ(coordinator().jobs().list(request).error().code, ErrorCode::kInvalidArgument);
  request = {};
  request.add_states(static_cast<v1::JobState>(77));
  EXPECT_EQ(coordinator().jobs().list(request).error().code, ErrorCode::kInvalidArgument);
}

TEST_F(FinishedJobs, AreNotListedAmongQueuedOnes) {
  finish();
  now_ += std::chrono::seconds(20);
  coordinator().dispatcher().tick();  // the call of the worker waits no longer
  const std::string first = submit(), second = submit(), paused = submit();
  ASSERT_TRUE(coordinator().jobs().pause(paused));
  v1::ListJobsRequest queued;
  queued.set_queued(true);
  EXPECT_THAT(listed_ids(queued), ElementsAre(second, first)) << "nobody works on them";
  const WaitingCall working(coordinator(), greeting('b'));
  ASSERT_TRUE(working.answered() && working.answer());
  const bool works_on_first = working.answer()->leases(0).job_id() == first;
  EXPECT_THAT(listed_ids(queued), ElementsAre(works_on_first ? second : first));
  queued.add_states(v1::JOB_STATE_PAUSED);
  queued.add_states(v1::JOB_STATE_DONE);
  EXPECT_EQ(listed_ids(queued).size(), 3u) << "or in one of these states";
  queued.set_page_size(1);
  EXPECT_EQ(ids_of_pages(queued).size(), 3u);
  v1::ListJobsRequest running;
  running.add_states(v1::JOB_STATE_RUNNING);
  EXPECT_THAT(listed_ids(running), ElementsAre(second, first)) << "queued jobs run, too";
}

TEST_F(FinishedJobs, TheOldestAreRetired) {
  std::vector<std::string> ids;
  for (int i = 0; i < 4; ++i) ids.push_back(finish());
  const std::string running = submit();
  ASSERT_TRUE(coordinator().jobs().retire({}));
  EXPECT_EQ(listed_ids().size(), 5u);
  ASSERT_TRUE(coordinator().jobs().retire({{}, 2}));
  EXPECT_THAT(listed_ids(), ElementsAre(running, ids[3], ids[2]));
  ASSERT_TRUE(coordinator().jobs().retire({std::chrono::hours(1), {}}));
  EXPECT_EQ(listed_ids().size(), 3u);
  ASSERT_TRUE(coordinator().jobs().retire({std::chrono::seconds(-60), {}}));
  EXPECT_THAT(listed_ids(), ElementsAre(running));
}

TEST(KeepFinished, IsANumberOfJobsOrATime) {
  EXPECT_EQ(jobs::read_keep_finished("5000")->jobs, 5000u);
  EXPECT_EQ(jobs::read_keep_finished("0")->jobs, 0u);
  EXPECT_EQ(jobs::read_keep_finished("90m")->time, std::chrono::minutes(90));
  EXPECT_EQ(jobs::read_keep_finished("30d")->time, std::chrono::hours(720));
  for (const char* const text : {"", "d", "-1", "1.5h", "3 h", "3w", "99999999999999999999", "2000000000d"})
    EXPECT_FALSE(jobs::read_keep_finished(text)) << text;
}

// The worker that rendered the job turns out to be wrong in another one, after a restart.
TEST_F(FinishedJobs, RunAgainWhenTheirWorkerIsQuarantined) {
  const std::string id = finish();
  open();
  {
    const std::string other = submit();
    v1::SubmitResultRequest wrong;
    for (int i = 0; i < 3; ++i) {
      wrong = delivery('a', synchronize(greeting('a')).leases(0));
      wrong.mutable_items(0)->set_sums_xxh3(0);
      EXPECT_FALSE(coordinator().dispatcher().submit_result(wrong));
    }
    ASSERT_TRUE(coordinator().jobs().remove(other));
  }
  coordinator().jobs().reopen();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
  EXPECT_EQ(job(id).samples_to_verify(), kSamples);
  work('b');
  EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  expect_whole_image(id);
}

// While a job is extended, finished and read again and again, it is always there.
TEST_F(FinishedJobs, AreFoundWhileTheyMove) {
  const std::string id = finish();
  std::atomic<bool> stopping = false;
  std::vector<std::thread> readers;
  for (int i = 0; i < 3; ++i)
    readers.emplace_back([&] {
      while (!stopping) {
        EXPECT_TRUE(coordinator().jobs().get(id));
        EXPECT_EQ(listed_ids().size(), 1u);
        EXPECT_TRUE(coordinator().images().get(id));
      }
    });
  for (std::uint32_t spp = kSpp + 1; spp < kSpp + 20; ++spp) {
    EXPECT_TRUE(coordinator().jobs().extend(id, spp));
    work('a');
    EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  }
  stopping = true;
  for (std::thread& reader : readers) reader.join();
  expect_whole_image(id, kSpp + 19);
}

}  // namespace
}  // namespace tessera::server
