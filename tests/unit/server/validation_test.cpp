// SPDX-License-Identifier: Apache-2.0
// Jobs in the state VALIDATING, their labels, and what programs learn of failures and refusals.
#include <gmock/gmock.h>

#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "proto/blob.hpp"
#include "proto/error_reasons.hpp"
#include "server/jobs/labels.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::ElementsAre;
using testing::HasSubstr;

class Validation : public ScriptedFarm {
 protected:
  // Submits a job without validating it.
  v1::Job submit_only(const v1::SubmitJobRequest& request = submission(), const std::string& owner = {}) {
    const auto job = coordinator().jobs().submit(request, owner);
    EXPECT_TRUE(job) << job.error().message;
    return job.value_or(v1::Job());
  }
  core::ErrorDetails details_of_refusal(const v1::SubmitJobRequest& request) {
    const auto job = coordinator().jobs().submit(request);
    EXPECT_FALSE(job);
    return job ? core::ErrorDetails{} : core::details_of(job.error());
  }
};

TEST_F(Validation, AJobIsStoredBeforeItsSceneIsRead) {
  v1::SubmitJobRequest request = submission();
  request.set_request_id("once");
  request.set_priority(3);
  request.mutable_overrides()->set_width_px(20);
  const v1::Job submitted = submit_only(request, "ada");
  EXPECT_EQ(submitted.state(), v1::JOB_STATE_VALIDATING);
  EXPECT_EQ(submitted.settings().width_px(), 20u);
  EXPECT_EQ(submitted.settings().height_px(), 0u) << "the scene says";
  EXPECT_EQ(submitted.bundle().assets_size(), 1);
  for (int start = 0; start < 2; ++start) {
    v1::Job now = job(submitted.id());
    EXPECT_GE(now.revision(), submitted.revision());
    now.set_revision(submitted.revision());
    EXPECT_EQ(now.SerializeAsString(), submitted.SerializeAsString());
    EXPECT_EQ(submit_only(request, "ada").id(), submitted.id());
    EXPECT_EQ(coordinator().jobs().submit(request, "ben").error().code, ErrorCode::kAlreadyExists);
    ASSERT_EQ(listed().size(), 1u);
    EXPECT_EQ(listed()[0].state(), v1::JOB_STATE_VALIDATING);
    EXPECT_FALSE(listed()[0].has_bundle());
    EXPECT_TRUE(coordinator().checkpointer().checkpoint());
    open();
  }
  EXPECT_EQ(coordinator().jobs().unvalidated().size(), 1u);
  coordinator().jobs().validate(submitted.id());
  EXPECT_TRUE(coordinator().jobs().unvalidated().empty());
  for (int start = 0; start < 2; ++start) {
    EXPECT_EQ(job(submitted.id()).state(), v1::JOB_STATE_RUNNING);
    EXPECT_EQ(job(submitted.id()).settings().width_px(), 20u);
    EXPECT_EQ(job(submitted.id()).settings().height_px(), 100u);
    EXPECT_EQ(job(submitted.id()).priority(), 3);
    EXPECT_EQ(submit_only(request, "ada").id(), submitted.id());
    open();
  }
  work('a');
  EXPECT_EQ(stored_job(submitted.id()).state(), v1::JOB_STATE_DONE);
}

TEST_F(Validation, IsOfOneAtATime) {
  const std::string id = submit_only().id();
  EXPECT_TRUE(coordinator().jobs().unvalidated().empty()) << "its submitter validates it";
  open();
  ASSERT_EQ(coordinator().jobs().unvalidated().size(), 1u);
  EXPECT_TRUE(coordinator().jobs().queue_validation(id));
  EXPECT_FALSE(coordinator().jobs().queue_validation(id));
  EXPECT_TRUE(coordinator().jobs().unvalidated().empty());
  EXPECT_FALSE(coordinator().jobs().queue_validation("nobody"));
}

TEST_F(Validation, WithoutAResultIsRepeatedLater) {
  bool is_stopping = true;
  check_scene_ = [&](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                     const std::vector<std::int32_t>&, const std::stop_token&) {
    if (is_stopping) return core::Result<jobs::CheckedScene>(core::fail(ErrorCode::kUnavailable, "stopped"));
    return accept_scene(bundle, overrides);
  };
  open();
  const std::string id = submit();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_VALIDATING);
  EXPECT_TRUE(coordinator().jobs().unvalidated().empty()) << "not at once";
  now_ += std::chrono::seconds(10);
  ASSERT_EQ(coordinator().jobs().unvalidated().size(), 1u);
  is_stopping = false;
  EXPECT_TRUE(coordinator().jobs().queue_validation(id));
  coordinator().jobs().validate(id);
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
}

TEST_F(Validation, TakesNoChangesButCancelAndDelete) {
  const std::string cancelled = submit_only().id(), deleted = submit_only().id();
  v1::UpdateJobRequest update;
  update.set_job_id(cancelled);
  update.set_priority(1);
  jobs::JobService& jobs = coordinator().jobs();
  for (const core::ErrorCode code :
       {jobs.pause(cancelled).error().code, jobs.resume(cancelled).error().code,
        jobs.extend(cancelled, 100).error().code, jobs.update(update).error().code,
        coordinator().images().get(cancelled).error().code})
    EXPECT_EQ(code, ErrorCode::kFailedPrecondition);
  EXPECT_EQ(jobs.cancel(cancelled)->state(), v1::JOB_STATE_CANCELLED);
  EXPECT_TRUE(jobs.remove(deleted));
  EXPECT_EQ(jobs.get(deleted).error().code, ErrorCode::kNotFound);
  for (const std::string& id : {cancelled, deleted}) jobs.validate(id);
  for (int start = 0; start < 2; ++start) {
    EXPECT_EQ(job(cancelled).state(), v1::JOB_STATE_CANCELLED);
    EXPECT_TRUE(job(cancelled).has_finished_at());
    EXPECT_EQ(job(cancelled).samples_total(), 0u);
    EXPECT_EQ(coordinator().images().get(cancelled).error().code, ErrorCode::kFailedPrecondition);
    EXPECT_EQ(listed().size(), 1u);
    open();
  }
  EXPECT_TRUE(coordinator().jobs().remove(cancelled));
}

TEST_F(Validation, JobsInItAreListedWithTheOthers) {
  std::vector<std::string> ids;
  for (int i = 0; i < 6; ++i) {
    ids.insert(ids.begin(), i % 2 == 0 ? submit() : submit_only().id());
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // so that their times differ
  }
  std::vector<std::string> found;
  for (const v1::Job& job : listed()) found.push_back(job.id());
  EXPECT_EQ(found, ids);
  v1::ListJobsRequest first_three;
  first_three.set_page_size(3);
  found.clear();
  for (const v1::Job& job : listed(first_three)) found.push_back(job.id());
  EXPECT_EQ(found, std::vector<std::string>(ids.begin(), ids.begin() + 3));
}

// Jobs to be validated, jobs in progress and finished ones are one list.
TEST_F(Validation, JobsInItAreListedInPagesAndByState) {
  const std::string finished = submit(submission(), "ada");
  ASSERT_TRUE(coordinator().jobs().cancel(finished));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  const std::string running = submit(submission(), "ada"), validating = submit_only(submission(), "ada").id();
  submit_only(submission(), "ben");
  v1::ListJobsRequest request;
  request.set_page_size(1);
  request.set_owner("ada");
  std::vector<std::string> found;
  for (int page = 0; page < 3; ++page) {
    const auto listed = coordinator().jobs().list(request);
    ASSERT_TRUE(listed && listed->jobs_size() == 1);
    found.push_back(listed->jobs(0).id());
    request.set_page_token(listed->next_page_token());
    if (page == 0) coordinator().jobs().validate(validating);
  }
  EXPECT_EQ(request.page_token(), "");
  EXPECT_THAT(found, ElementsAre(validating, running, finished));
  v1::ListJobsRequest of_state;
  of_state.add_states(v1::JOB_STATE_VALIDATING);
  ASSERT_EQ(listed(of_state).size(), 1u);
  EXPECT_EQ(listed(of_state)[0].owner(), "ben");
  of_state.add_states(v1::JOB_STATE_CANCELLED);
  EXPECT_EQ(listed(of_state).size(), 2u);
}

TEST_F(Validation, JobsThatEndInItLeaveTheMemoryWithoutAnImage) {
  v1::SubmitJobRequest request = submission();
  request.set_request_id("once");
  (*request.mutable_labels())["shot"] = "12";
  const std::string id = submit_only(request, "ada").id();
  ASSERT_TRUE(coordinator().jobs().cancel(id));
  const v1::Job before = job(id);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  EXPECT_EQ(coordinator().jobs().count_in_memory(), 0u);
  v1::UpdateJobRequest update;
  update.set_job_id(id);
  update.set_priority(1);
  for (int start = 0; start < 2; ++start) {
    jobs::JobService& jobs = coordinator().jobs();
    EXPECT_EQ(job(id).SerializeAsString(), before.SerializeAsString());
    EXPECT_EQ(submit_only(request, "ada").id(), id);
    EXPECT_EQ(jobs.submit(request, "ben").error().code, ErrorCode::kAlreadyExists);
    EXPECT_EQ(jobs.cancel(id)->state(), v1::JOB_STATE_CANCELLED);
    for (const core::ErrorCode code :
         {jobs.pause(id).error().code, jobs.resume(id).error().code, jobs.extend(id, 100).error().code,
          jobs.update(update).error().code, coordinator().images().get(id).error().code})
      EXPECT_EQ(code, ErrorCode::kFailedPrecondition);
    v1::ListJobsRequest list;
    (*list.mutable_labels())["shot"] = "12";
    EXPECT_EQ(listed(list).size(), 1u);
    open();
    EXPECT_EQ(coordinator().jobs().count_in_memory(), 0u);
  }
}

TEST_F(Validation, KeepsWarnings) {
  check_scene_ = [](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                    const std::vector<std::int32_t>&, const std::stop_token&) {
    jobs::CheckedScene scene = *accept_scene(bundle, overrides);
    scene.warnings = {"a texture is missing"};
    return core::Result<jobs::CheckedScene>(scene);
  };
  open();
  const std::string id = submit();
  open();
  EXPECT_THAT(job(id).warnings(), ElementsAre("a texture is missing"));
  EXPECT_THAT(coordinator().jobs().get_without_bundle(id)->warnings(), ElementsAre("a texture is missing"));
  EXPECT_TRUE(listed()[0].warnings().empty());
}

TEST_F(Validation, FailsAJobWhoseFileIsDamaged) {
  const std::string id = submit_only().id();
  write_file(coordinator().blobs().path(proto::digest_of(kSceneBytes)), "[]");
  coordinator().jobs().validate(id);
  EXPECT_EQ(job(id).failure_details().reason(), v1::Failure::REASON_FILE_LOST);
  EXPECT_THAT(job(id).failure(), HasSubstr("folder/scene.json: "));
}

TEST_F(Validation, OfAnExceptionFailsTheJob) {
  check_scene_ = [](const v1::Bundle&, const v1::RenderOverrides&, const std::vector<std::int32_t>&,
                    const std::stop_token&) -> core::Result<jobs::CheckedScene> {
    throw std::runtime_error("no such thing");
  };
  open();
  const std::string id = submit();
  EXPECT_EQ(job(id).state(), v1::JOB_STATE_FAILED);
  EXPECT_EQ(job(id).failure_details().reason(), v1::Failure::REASON_INTERNAL);
}

TEST_F(Validation, RefusalsNameTheFieldTheOptionOrWhatIsMissing) {
  v1::SubmitJobRequest request = submission();
  request.set_name("a\nb");
  EXPECT_EQ(details_of_refusal(request).reason, proto::kInvalidField);
  EXPECT_EQ(details_of_refusal(request).field, "name");
  request = submission();
  request.mutable_bundle()->set_scene_path("other");
  EXPECT_EQ(details_of_refusal(request).field, "bundle.scene_path");
  request = submission();
  request.mutable_bundle()->mutable_assets(0)->mutable_digest()->clear_sha256();
  EXPECT_EQ(details_of_refusal(request).field, "bundle.assets[0].digest");
  request = submission();
  *request.mutable_bundle()->add_assets() = request.bundle().assets(0);
  EXPECT_EQ(details_of_refusal(request).field, "bundle.assets[1].path");
  request = submission();
  request.mutable_display()->set_exposure_stops(1000);
  EXPECT_EQ(details_of_refusal(request).field, "display");
  request = submission();
  const proto::Digest missing = proto::digest_of("never sent");
  *request.mutable_bundle()->mutable_assets(0)->mutable_digest() = proto::to_proto(missing);
  EXPECT_EQ(details_of_refusal(request).reason, proto::kMissingBlobs);
  EXPECT_THAT(details_of_refusal(request).missing, ElementsAre(proto::blob_name(missing)));
  limits_.open_jobs = 1;
  open();
  submit();
  EXPECT_EQ(details_of_refusal(submission()).reason, proto::kQuotaExceeded);
  EXPECT_EQ(details_of_refusal(submission()).option, "--max-open-jobs");
  limits_.bundle_files = 0;
  open();
  EXPECT_EQ(details_of_refusal(submission()).reason, proto::kLimitExceeded);
}

TEST_F(Validation, LabelsAreKeptAndFindJobs) {
  v1::SubmitJobRequest request = submission();
  (*request.mutable_labels())["shot"] = "12";
  (*request.mutable_labels())["show"] = "vase";
  const std::string both = submit(request);
  request.mutable_labels()->erase("show");
  const std::string one = submit_only(request).id();
  submit();
  open();
  EXPECT_EQ(job(both).labels().at("show"), "vase");
  const auto found = [&](const std::map<std::string, std::string>& labels) {
    v1::ListJobsRequest list;
    for (const auto& [key, value] : labels) (*list.mutable_labels())[key] = value;
    std::set<std::string> ids;
    for (const v1::Job& job : listed(list)) ids.insert(job.id());
    return ids;
  };
  EXPECT_EQ(found({{"shot", "12"}}), (std::set<std::string>{both, one}));
  EXPECT_EQ(found({{"shot", "12"}, {"show", "vase"}}), std::set<std::string>{both});
  EXPECT_EQ(found({{"shot", "13"}}), std::set<std::string>{});
  EXPECT_EQ(found({{"show", ""}}), std::set<std::string>{});
  EXPECT_EQ(found({}).size(), 3u);
}

TEST_F(Validation, LabelsAreLimited) {
  const auto refused = [&](const std::map<std::string, std::string>& labels) {
    v1::SubmitJobRequest request = submission();
    for (const auto& [key, value] : labels) (*request.mutable_labels())[key] = value;
    return details_of_refusal(request).field;
  };
  EXPECT_EQ(refused({{"", "x"}}), "labels");
  EXPECT_EQ(refused({{std::string(64, 'k'), "x"}}), "labels");
  EXPECT_EQ(refused({{"k", std::string(256, 'v')}}), "labels");
  EXPECT_EQ(refused({{"k", "a\nb"}}), "labels");
  std::map<std::string, std::string> many;
  for (int i = 0; i <= 32; ++i) many[std::to_string(i)] = "x";
  EXPECT_EQ(refused(many), "labels");
  many.erase("32");
  v1::SubmitJobRequest request = submission();
  for (const auto& [key, value] : many) (*request.mutable_labels())[key] = value;
  (*request.mutable_labels())[std::string(63, 'k')] = std::string(255, 'v');
  request.mutable_labels()->erase("0");
  submit(request);
}

TEST_F(Validation, FailuresOfWorkersNameTheSamplesAndTheWorkers) {
  const std::string id = submit();
  for (const char worker : {'a', 'b', 'c'}) {
    const v1::Lease lease = synchronize(greeting(worker)).leases(0);
    v1::SubmitResultRequest declined = delivery(worker, lease);
    declined.clear_items();
    declined.set_decline_reason("out of memory");
    deliver(declined);
  }
  for (int start = 0; start < 2; ++start) {
    const v1::Failure failure = stored_job(id).failure_details();
    EXPECT_EQ(failure.reason(), v1::Failure::REASON_DECLINED);
    EXPECT_EQ(failure.message(), job(id).failure());
    EXPECT_THAT(failure.workers(), ElementsAre("host-a", "host-b", "host-c"));
    EXPECT_FALSE(failure.has_item());
    open();
  }
}

TEST_F(Validation, ALostFileIsAReason) {
  const std::string id = submit();
  const proto::Digest scene = proto::digest_of(kSceneBytes);
  coordinator().blobs().discard(scene);
  coordinator().jobs().blob_is_lost(scene, {ErrorCode::kNotFound, "gone"});
  EXPECT_FALSE(job(id).has_failure_details()) << "it is not stored yet";
  EXPECT_EQ(stored_job(id).failure_details().reason(), v1::Failure::REASON_FILE_LOST);
}

}  // namespace
}  // namespace tessera::server
