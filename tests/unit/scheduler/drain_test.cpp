// SPDX-License-Identifier: Apache-2.0
// Workers that an administrator drains, and principals.
#include "tests/unit/scheduler/audited_farm.hpp"

namespace tessera::scheduler {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class Drained : public Farm {
 protected:
  WorkerView worker(const std::string& id) { return *scheduler_->worker({id}, now_); }
};

TEST_F(Drained, AWorkerKeepsWhatItHoldsAndGetsNoMore) {
  submit("job", tiles(4, 4));
  const LeaseDescription lease = lease_to("a");
  EXPECT_TRUE(sync("a", {lease}).leases.size() == 1);
  EXPECT_TRUE(handle(Drain{{"a"}}).status);
  EXPECT_TRUE(worker("a").draining);
  EXPECT_EQ(sync("a", {lease}, 2).leases.size(), 1u);
  deliver("a", lease);
  EXPECT_THAT(sync("a").leases, IsEmpty());
}

TEST_F(Drained, AWaitingWorkerIsGivenNoNewWorkUntilItIsUndone) {
  EXPECT_THAT(sync("a").leases, IsEmpty());
  handle(Drain{{"a"}});
  submit("job", tiles(4, 4));
  tick();
  const Actions undone = handle(Drain{{"a"}, false});
  EXPECT_THAT(undone.wake, ElementsAre(WorkerId{"a"}));
  EXPECT_EQ(handle(TopUp{{"a"}}).reply->leases.size(), 1u);
}

TEST_F(Drained, ItOutlastsALostWorker) {
  submit("job", tiles(4, 4));
  lease_to("a");
  handle(Drain{{"a"}});
  pass(options_.lease_duration + seconds(1));
  tick();
  EXPECT_TRUE(worker("a").silent);
  EXPECT_THAT(sync("a").leases, IsEmpty());
  EXPECT_TRUE(worker("a").drain_requested);
}

TEST_F(Drained, OneThatLeavesByItselfStaysLeavingWhenItIsUndone) {
  submit("job", tiles(4, 4));
  sync("a", {}, 1, true);
  handle(Drain{{"a"}});
  handle(Drain{{"a"}, false});
  EXPECT_TRUE(worker("a").draining);
}

TEST_F(Drained, AStopIsSentAtOnceAndInEachResponse) {
  submit("job", tiles(4, 4));
  const LeaseDescription lease = lease_to("a");
  EXPECT_FALSE(sync("a", {lease}).changed);
  EXPECT_THAT(handle(Drain{{"a"}, true, true}).wake, ElementsAre(WorkerId{"a"}));
  const Reply told = *handle(TopUp{{"a"}}).reply;
  EXPECT_TRUE(told.stop && told.changed);
  const Reply again = sync("a", {lease});
  EXPECT_TRUE(again.stop);
  EXPECT_FALSE(again.changed);
  handle(Drain{{"a"}, false});
  EXPECT_FALSE(sync("a", {lease}).stop);
}

TEST_F(Drained, OtherWorkersAreUnaffected) {
  EXPECT_EQ(handle(Drain{{"a"}}).status.error().code, core::ErrorCode::kNotFound);
  submit("job", tiles(4, 4));
  lease_to("a");
  handle(Drain{{"a"}});
  render_all("b");
  EXPECT_EQ(state("job"), JobState::kDone);
}

class Principals : public AuditsOf {
 protected:
  explicit Principals(double share = 1) : AuditsOf(share) {}

  Reply sync_as(const std::string& id, const std::string& principal) {
    WorkerInfo info{{id}, id, "0.1.0", 1, id, principal};
    info.principal = principal;
    info.individual = true;
    return *handle(Synchronize{std::move(info), {}, 1}).reply;
  }
  bool render_one(const std::string& id, const std::string& principal, Sums sums_of = honest) {
    const Reply reply = sync_as(id, principal);
    for (const LeaseDescription& lease : reply.leases) deliver_sums(id, lease, sums_of);
    return !reply.leases.empty();
  }
  void render_until_nothing_is_left(const std::vector<std::pair<std::string, std::string>>& workers) {
    for (int rounds = 0; rounds < 1000; ++rounds) {
      bool any = false;
      for (const auto& [id, principal] : workers)
        any |= render_one(id, principal, principal == "liar" ? wrong : honest);
      if (!any) return;
    }
    ADD_FAILURE() << "there is no end to the work";
  }
};

TEST_F(Principals, WorkersOfOneDoNotAuditEachOther) {
  submit("job", tiles(2, 2));
  render_until_nothing_is_left({{"a", "ada"}, {"b", "ada"}});
  EXPECT_GT(job("job").samples_to_verify, 0u);
  render_until_nothing_is_left({{"c", "ben"}});
  EXPECT_EQ(state("job"), JobState::kDone);
}

// With names alone, two of them would outvote an honest worker.
TEST_F(Principals, ManyIdsOfOneOwnerCountOnce) {
  submit("job", tiles(2, 2));
  render_until_nothing_is_left({{"a", "liar"}, {"b", "liar"}, {"c", "liar"}, {"d", "ben"}});
  EXPECT_EQ(state("job"), JobState::kRunning) << "two principals disagree";
  for (const WorkerView& view : scheduler_->workers(now_)) EXPECT_EQ(view.disproved_ranges, 0u);
  render_until_nothing_is_left({{"e", "eve"}, {"d", "ben"}});
  EXPECT_EQ(state("job"), JobState::kDone);
  EXPECT_EQ(worker("d").disproved_ranges, 0u);
}

TEST_F(Principals, NoWorkerOfADistrustedOneAudits) {
  submit("job", tiles(2, 2));
  ASSERT_TRUE(render_one("a", "ben"));
  const Producer ada{"c", {"c"}, "c", "ada"};
  handle(Distrust{ada});
  render_until_nothing_is_left({{"b", "ada"}, {"a", "ben"}});
  EXPECT_EQ(state("job"), JobState::kRunning);
  handle(Trust{ada});
  render_until_nothing_is_left({{"b", "ada"}});
  EXPECT_EQ(state("job"), JobState::kDone);
}

class PrincipalsWithoutAudits : public Principals {
 protected:
  PrincipalsWithoutAudits() : Principals(0) {}
};

TEST_F(PrincipalsWithoutAudits, DistrustOfOneConcernsWhatAnyOfItsWorkersRendered) {
  submit("job", tiles(2, 2));
  render_until_nothing_is_left({{"a", "ada"}});
  ASSERT_EQ(state("job"), JobState::kDone);
  EXPECT_THAT(handle(Distrust{{"b", {"b"}, "b", "ben"}}).reopen, IsEmpty());
  EXPECT_THAT(handle(Distrust{{"c", {"c"}, "c", "ada"}}).reopen, ElementsAre(JobId{"job"}));
}

// The worker has not called since the coordinator was started again.
TEST_F(PrincipalsWithoutAudits, ResultsOfAnUnregisteredWorkerAreThoseOfItsPrincipal) {
  submit("job", tiles(2, 2));
  const LeaseDescription lease = sync_as("a", "ada").leases.at(0);
  restart();
  SubmitResult result{{"a"}, lease.job, lease.id, {lease.items.front()}, 0.25};
  result.principal = "ada";
  ASSERT_EQ(handle(result).verdicts, std::vector{Verdict::kAccepted});
  handle(Distrust{{"b", {"b"}, "b", "ben"}});
  EXPECT_EQ(job("job").samples_to_verify, 0u);
  sync_as("a", "ada");
  handle(Distrust{{"c", {"c"}, "c", "ada"}});
  EXPECT_GT(job("job").samples_to_verify, 0u);
}

class Fingerprints : public Farm {
 protected:
  Reply sync_with(const std::string& id, const std::string& fingerprint) {
    WorkerInfo info{{id}, id, "0.1.0", 1, id};
    info.determinism_fingerprint = fingerprint;
    return *handle(Synchronize{std::move(info), {}, 1}).reply;
  }
};

TEST_F(Fingerprints, AJobIsGivenToThoseOfItsFirstSamplesAlone) {
  submit("job", tiles(4, 4));
  const LeaseDescription lease = sync_with("a", "f00d").leases.at(0);
  SubmitResult result{{"a"}, lease.job, lease.id, lease.items, 0.25, true};
  result.determinism_fingerprint = "f00d";
  handle(result);
  EXPECT_THAT(sync_with("b", "beef").leases, IsEmpty());
  EXPECT_EQ(sync_with("a", "f00d").leases.size(), 1u);
  submit("other", tiles(4, 4));
  EXPECT_EQ(handle(TopUp{{"b"}}).reply->leases.at(0).job.value, "other");
}

}  // namespace
}  // namespace tessera::scheduler
