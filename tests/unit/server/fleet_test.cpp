// SPDX-License-Identifier: Apache-2.0
// What administrators do with workers: the list, its pages, quarantine and draining.
#include "server/fleet/fleet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "server/base/wall_clock.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using farm::WorkerPrincipal;
using testing::HasSubstr;

const WorkerPrincipal kAda{.name = "ada", .individual = true, .origin = "ada"};
const WorkerPrincipal kBen{.name = "ben", .individual = true, .origin = "ben"};
const WorkerPrincipal kShared{.name = "farm", .individual = false, .origin = "farm at here"};

// A worker of a machine.
v1::SynchronizeRequest greeting_of_machine(char worker, char machine) {
  v1::SynchronizeRequest request = greeting(worker);
  request.set_worker_key(std::string(32, machine) + std::string(16, worker));
  return request;
}

class FleetTest : public ScriptedFarm {
 protected:
  FleetTest() { submit(); }

  // The worker of this machine delivers damaged results until it is quarantined.
  void quarantine(char worker, char machine, const WorkerPrincipal& principal = {}) {
    const v1::Lease lease = synchronize(greeting_of_machine(worker, machine), principal).leases(0);
    v1::SubmitResultRequest lie = delivery(worker, lease);
    lie.mutable_items(0)->set_sums_xxh3(lie.items(0).sums_xxh3() ^ 1);
    for (int i = 0; i < farm::Quarantine::kRejectionsUntilQuarantine; ++i)
      EXPECT_FALSE(coordinator().dispatcher().submit_result(lie, principal));
  }
  // A page of the quarantine.
  v1::ListQuarantineResponse quarantined(std::uint32_t page_size = 0, const std::string& token = {}) {
    v1::ListQuarantineRequest request;
    request.set_page_size(page_size);
    request.set_page_token(token);
    const auto page = coordinator().fleet().list_quarantine(request);
    EXPECT_TRUE(page) << page.error().message;
    return page ? *page : v1::ListQuarantineResponse();
  }
  // The code with which a worker's call is refused; empty if it gets a lease or waits for one.
  std::optional<ErrorCode> refusal_of(char worker, char machine, const WorkerPrincipal& principal = {}) {
    const WaitingCall call(coordinator(), greeting_of_machine(worker, machine), principal);
    if (!call.answered() || call.answer()) return std::nullopt;
    return call.answer().error().code;
  }
  // Worker a, which holds the lease and knows its job.
  static v1::SynchronizeRequest greeting_with(const v1::Lease& lease) {
    v1::SynchronizeRequest request = greeting('a');
    *request.add_held() = lease;
    request.add_known_job_ids(lease.job_id());
    return request;
  }
  core::Result<v1::DrainWorkerResponse> drain(const std::string& worker, bool undo = false,
                                              bool stop = false) {
    v1::DrainWorkerRequest request;
    request.set_worker(worker);
    request.set_undo(undo);
    request.set_stop(stop);
    return coordinator().fleet().drain(request);
  }
  v1::Worker worker(char id) {
    for (const v1::Worker& each : coordinator().dispatcher().workers())
      if (each.id() == std::string(32, id)) return each;
    return {};
  }
  std::vector<std::string> listed_names(const v1::ListWorkersRequest& request) {
    const auto page = coordinator().dispatcher().list_workers(request);
    EXPECT_TRUE(page) << page.error().message;
    return page ? names(*page) : std::vector<std::string>();
  }
  std::vector<std::string> names(const v1::ListWorkersResponse& page) {
    std::vector<std::string> names;
    for (const v1::Worker& each : page.workers()) names.push_back(each.name());
    return names;
  }
};

TEST_F(FleetTest, QuarantineIsListedAndLifted) {
  quarantine('a', 'm', kShared);
  const v1::ListQuarantineResponse list = quarantined();
  ASSERT_EQ(list.entries_size(), 1);
  EXPECT_EQ(list.entries(0).worker_id(), std::string(32, 'a'));
  EXPECT_EQ(list.entries(0).worker_name(), "host-a");
  EXPECT_EQ(list.entries(0).principal(), "farm");
  EXPECT_THAT(list.entries(0).reason(), HasSubstr("in a row were rejected"));
  EXPECT_GT(list.entries(0).since().seconds(), 0);
  EXPECT_EQ(refusal_of('b', 'm', kShared), ErrorCode::kFailedPrecondition);

  EXPECT_EQ(coordinator().fleet().lift(std::string(32, 'b')).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(coordinator().fleet().lift(list.entries(0).id()));
  EXPECT_EQ(quarantined().entries_size(), 0);
  EXPECT_EQ(synchronize(greeting_of_machine('a', 'm'), kShared).leases_size(), 1);
  EXPECT_EQ(refusal_of('b', 'm', kShared), std::nullopt);
  EXPECT_FALSE(worker('a').quarantined());
}

TEST_F(FleetTest, QuarantineIsListedInPages) {
  for (const char worker : {'a', 'b', 'c', 'd', 'e'}) quarantine(worker, worker);
  std::vector<std::string> ids;
  std::string token;
  for (const int size : {2, 2, 1}) {
    const v1::ListQuarantineResponse page = quarantined(2, token);
    EXPECT_EQ(page.entries_size(), size);
    for (const v1::QuarantineEntry& entry : page.entries()) ids.push_back(entry.id());
    token = page.next_page_token();
    EXPECT_EQ(token.empty(), size == 1);
  }
  EXPECT_EQ(ids.size(), std::set<std::string>(ids.begin(), ids.end()).size());
  EXPECT_EQ(quarantined(5).next_page_token(), "") << "nothing follows";
  v1::ListQuarantineRequest request;
  for (const char* const odd : {"x", "7", "-", "99999999999999999999-a"}) {
    request.set_page_token(odd);
    EXPECT_EQ(coordinator().fleet().list_quarantine(request).error().code, ErrorCode::kInvalidArgument)
        << odd;
  }
}

TEST_F(FleetTest, QuarantineSurvivesARestartUntilItIsLifted) {
  quarantine('a', 'm');
  const v1::ListQuarantineResponse before = quarantined();
  ASSERT_TRUE(coordinator().fleet().save());
  open();
  EXPECT_EQ(quarantined().SerializeAsString(), before.SerializeAsString());
  EXPECT_EQ(refusal_of('a', 'm'), ErrorCode::kFailedPrecondition);
  EXPECT_EQ(refusal_of('b', 'm'), ErrorCode::kFailedPrecondition);
  ASSERT_TRUE(coordinator().fleet().lift(std::string(32, 'a')));
  open();
  EXPECT_EQ(quarantined().entries_size(), 0);
  EXPECT_EQ(refusal_of('a', 'm'), std::nullopt);
}

TEST_F(FleetTest, ADamagedEntryOfTheQuarantineKeepsNothingElseBack) {
  quarantine('a', 'm');
  quarantine('b', 'n');
  ASSERT_TRUE(coordinator().fleet().save());
  coordinator_.reset();
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder_.path() / "state" / "tessera.db").c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "UPDATE quarantine SET content = x'00' WHERE id LIKE 'aaaa%'", nullptr,
                         nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  open();
  EXPECT_EQ(refusal_of('a', 'm'), std::nullopt);
  EXPECT_EQ(refusal_of('b', 'n'), ErrorCode::kFailedPrecondition);
}

// What it rendered before is verified, also after a restart.
TEST_F(FleetTest, SamplesOfAQuarantinedWorkerAreStillToBeVerifiedWhenItIsLifted) {
  const std::string id = listed()[0].id();
  work('a', 1);
  quarantine('a', 'a');
  const std::uint64_t to_verify = job(id).samples_to_verify();
  EXPECT_GT(to_verify, 0u);
  ASSERT_TRUE(coordinator().fleet().lift(std::string(32, 'a')));
  EXPECT_EQ(job(id).samples_to_verify(), to_verify);
  work('a', 1);
  EXPECT_EQ(job(id).samples_to_verify(), to_verify) << "later samples are trusted";
}

TEST_F(FleetTest, AnIndividualPrincipalIsQuarantinedWithAllItsWorkers) {
  EXPECT_EQ(synchronize(greeting_of_machine('b', 'n'), kAda).leases_size(), 1);
  quarantine('a', 'm', kAda);
  EXPECT_EQ(refusal_of('b', 'n', kAda), ErrorCode::kFailedPrecondition);
  EXPECT_EQ(worker('b').held_leases(), 0u);
  EXPECT_TRUE(worker('b').quarantined());
  EXPECT_EQ(refusal_of('c', 'o', kAda), ErrorCode::kFailedPrecondition);
  EXPECT_EQ(refusal_of('d', 'p', kBen), std::nullopt);
}

// One bad machine does not put the farm aside.
TEST_F(FleetTest, ASharedPrincipalIsQuarantinedByMachine) {
  EXPECT_EQ(synchronize(greeting_of_machine('b', 'n'), kShared).leases_size(), 1);
  quarantine('a', 'm', kShared);
  EXPECT_EQ(refusal_of('b', 'n', kShared), std::nullopt);
  EXPECT_EQ(refusal_of('c', 'o', kShared), std::nullopt);
  EXPECT_EQ(refusal_of('d', 'm', kShared), ErrorCode::kFailedPrecondition);
}

TEST_F(FleetTest, AWorkerBelongsToThePrincipalThatRegisteredIt) {
  const v1::Lease lease = synchronize(greeting('a'), kAda).leases(0);
  EXPECT_EQ(worker('a').principal(), "ada");
  const WaitingCall other(coordinator(), greeting('a'), kBen);
  ASSERT_TRUE(other.answered());
  EXPECT_EQ(other.answer().error().code, ErrorCode::kPermissionDenied);
  const auto forged = coordinator().dispatcher().submit_result(delivery('a', lease), kBen);
  ASSERT_FALSE(forged);
  EXPECT_EQ(forged.error().code, ErrorCode::kPermissionDenied);
  EXPECT_EQ(worker('a').rejected_results(), 0u);
  EXPECT_GT(coordinator().dispatcher().submit_result(delivery('a', lease), kAda)->accepted_items(), 0u);
}

TEST_F(FleetTest, ADrainedWorkerFinishesItsLeasesAndGetsNoMore) {
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  const v1::SynchronizeRequest holding = greeting_with(lease);
  const WaitingCall before(coordinator(), holding);
  EXPECT_EQ(drain("host-a")->worker_id(), std::string(32, 'a'));
  EXPECT_TRUE(worker('a').drain_requested());
  EXPECT_EQ(worker('a').held_leases(), 1u);
  EXPECT_GT(deliver(delivery('a', lease)).accepted_items(), 0u);
  const WaitingCall idle(coordinator(), greeting('a'));
  EXPECT_FALSE(idle.answered());
  EXPECT_EQ(worker('a').held_leases(), 0u);

  ASSERT_TRUE(drain("aaaa", true));
  ASSERT_TRUE(idle.answered());
  EXPECT_EQ(idle.answer()->leases_size(), 1);
  EXPECT_FALSE(worker('a').drain_requested());
}

TEST_F(FleetTest, AStopIsSentAtOnceAndAgain) {
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  const v1::SynchronizeRequest holding = greeting_with(lease);
  const WaitingCall waiting(coordinator(), holding);
  EXPECT_FALSE(waiting.answered());
  ASSERT_TRUE(drain("host-a", false, true));
  ASSERT_TRUE(waiting.answered());
  EXPECT_TRUE(waiting.answer()->stop());
  EXPECT_EQ(waiting.answer()->leases_size(), 1);
  // A worker that knows nothing of it does not call in a loop.
  const WaitingCall next(coordinator(), holding);
  EXPECT_FALSE(next.answered());
  now_ += std::chrono::seconds(5);
  coordinator().dispatcher().tick();
  ASSERT_TRUE(next.answered());
  EXPECT_TRUE(next.answer()->stop());
}

TEST_F(FleetTest, ADrainSurvivesRestartsUntilItIsUndone) {
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  ASSERT_TRUE(drain("host-a"));
  open();
  const WaitingCall holding(coordinator(), greeting_with(lease));
  EXPECT_FALSE(holding.answered());
  EXPECT_TRUE(worker('a').drain_requested());
  EXPECT_EQ(worker('a').held_leases(), 1u) << "it is taken over";
  EXPECT_GT(deliver(delivery('a', lease)).accepted_items(), 0u);
  open();
  const WaitingCall idle(coordinator(), greeting('a'));
  EXPECT_FALSE(idle.answered());
  ASSERT_TRUE(drain("host-a", true));
  open();
  EXPECT_EQ(synchronize(greeting('a')).leases_size(), 1);
}

TEST_F(FleetTest, AStopIsSentAgainAfterARestart) {
  synchronize(greeting('a'));
  ASSERT_TRUE(drain("host-a", false, true));
  open();
  const WaitingCall call(coordinator(), greeting('a'));
  ASSERT_TRUE(call.answered());
  EXPECT_TRUE(call.answer()->stop());
}

TEST_F(FleetTest, ADrainIsForgottenWithItsWorker) {
  synchronize(greeting('a'));
  ASSERT_TRUE(drain("host-a"));
  open();
  ASSERT_TRUE(coordinator().fleet().save());
  now_ += std::chrono::minutes(10);
  ASSERT_TRUE(coordinator().fleet().save());
  open();
  EXPECT_EQ(synchronize(greeting('a')).leases_size(), 1);
}

TEST_F(FleetTest, AWorkerToDrainIsNamedUniquely) {
  synchronize(greeting('a'));
  v1::SynchronizeRequest namesake = greeting('b');
  namesake.set_name("host-a");
  synchronize(namesake);
  EXPECT_EQ(drain("host-a").error().code, ErrorCode::kFailedPrecondition);
  EXPECT_EQ(drain("host-z").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(drain("").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(drain("bbbb", true, true).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(drain("bbbb")->worker_id(), std::string(32, 'b'));
}

TEST_F(FleetTest, WorkersAreListedInPages) {
  for (const char worker : {'c', 'a', 'b', 'd'}) WaitingCall(coordinator(), greeting(worker));
  v1::ListWorkersRequest request;
  request.set_page_size(2);
  const auto first = coordinator().dispatcher().list_workers(request);
  EXPECT_THAT(names(*first), testing::ElementsAre("host-a", "host-b"));
  request.set_page_token(first->next_page_token());
  const auto second = coordinator().dispatcher().list_workers(request);
  EXPECT_THAT(names(*second), testing::ElementsAre("host-c", "host-d"));
  EXPECT_EQ(second->next_page_token(), "");
  request.set_page_token("no token");
  EXPECT_EQ(coordinator().dispatcher().list_workers(request).error().code, ErrorCode::kInvalidArgument);
}

TEST_F(FleetTest, WorkersAreListedByPrefix) {
  for (const char worker : {'a', 'b', 'c'}) WaitingCall(coordinator(), greeting(worker));
  v1::ListWorkersRequest request;
  request.set_prefix("host-b");
  EXPECT_THAT(names(*coordinator().dispatcher().list_workers(request)), testing::ElementsAre("host-b"));
  request.set_prefix("cccc");
  EXPECT_THAT(names(*coordinator().dispatcher().list_workers(request)), testing::ElementsAre("host-c"));
}

TEST_F(FleetTest, WorkersAreListedByState) {
  submit();
  submit();
  quarantine('a', 'm');
  synchronize(greeting('b'));
  ASSERT_TRUE(drain("host-b"));
  synchronize(greeting('c'));
  const auto in = [&](std::initializer_list<v1::WorkerState> states) {
    v1::ListWorkersRequest request;
    request.set_page_size(1000);
    for (const v1::WorkerState state : states) request.add_states(state);
    return listed_names(request);
  };
  EXPECT_THAT(in({v1::WORKER_STATE_QUARANTINED}), testing::ElementsAre("host-a"));
  EXPECT_THAT(in({v1::WORKER_STATE_DRAINING}), testing::ElementsAre("host-b"));
  EXPECT_THAT(in({v1::WORKER_STATE_WORKING, v1::WORKER_STATE_DRAINING}),
              testing::ElementsAre("host-b", "host-c"));
  EXPECT_THAT(in({v1::WORKER_STATE_IDLE}), testing::IsEmpty());
  EXPECT_THAT(in({}), testing::SizeIs(3));
  v1::ListWorkersRequest unknown;
  unknown.add_states(static_cast<v1::WorkerState>(77));
  EXPECT_EQ(coordinator().dispatcher().list_workers(unknown).error().code, ErrorCode::kInvalidArgument);
}

TEST_F(FleetTest, FilteredWorkersHavePages) {
  for (const char worker : {'a', 'b', 'c', 'd', 'e'})
    WaitingCall(coordinator(), greeting(worker), worker < 'd' ? kAda : kBen);
  v1::ListWorkersRequest request;
  request.set_principal("ada");
  request.set_page_size(2);
  const auto first = coordinator().dispatcher().list_workers(request);
  EXPECT_THAT(names(*first), testing::ElementsAre("host-a", "host-b"));
  request.set_page_token(first->next_page_token());
  const auto second = coordinator().dispatcher().list_workers(request);
  EXPECT_THAT(names(*second), testing::ElementsAre("host-c"));
  EXPECT_EQ(second->next_page_token(), "") << "the others are not Ada's";
  request = {};
  request.set_principal("");
  EXPECT_THAT(listed_names(request), testing::IsEmpty()) << "all have a principal";
}

TEST_F(FleetTest, WorkersAreListedByWhenTheyWereLastSeen) {
  WaitingCall(coordinator(), greeting('a'));
  now_ += std::chrono::seconds(8);
  WaitingCall(coordinator(), greeting('b'));
  google::protobuf::Timestamp between;
  between.set_seconds(base::wall_clock_ms() / 1000 - 4);
  v1::ListWorkersRequest recent, earlier;
  *recent.mutable_seen_from() = between;
  EXPECT_THAT(listed_names(recent), testing::ElementsAre("host-b"));
  *earlier.mutable_seen_before() = between;
  EXPECT_THAT(listed_names(earlier), testing::ElementsAre("host-a"));
}

}  // namespace
}  // namespace tessera::server
