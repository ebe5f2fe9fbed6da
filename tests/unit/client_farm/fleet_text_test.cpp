// SPDX-License-Identifier: Apache-2.0
#include "client/farm/fleet_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/farm/job_text.hpp"

namespace tessera::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(FleetText, ListsTheQuarantineWithItsReasons) {
  v1::ListQuarantineResponse quarantine;
  v1::QuarantineEntry& entry = *quarantine.add_entries();
  entry.set_id("1234567890abcdef");
  entry.set_worker_name("render\n07");
  entry.set_reason("it lied");
  entry.mutable_since()->set_seconds(1000);
  const std::string table = quarantine_table(quarantine, 1095);
  EXPECT_THAT(table, AllOf(HasSubstr("1234567890ab  "), HasSubstr("1:35 ago"), HasSubstr("): it lied\n")));
  EXPECT_THAT(table, Not(HasSubstr("render\n"))) << "a name cannot begin a line";
  entry.set_principal("ada");
  EXPECT_THAT(quarantine_table(quarantine, 1095), HasSubstr("ada"));
}

TEST(FleetText, DescribesTheCoordinatorAndItsCaller) {
  v1::GetServerInfoResponse info;
  info.set_version("0.2.0");
  info.add_determinism_fingerprints("f00d");
  info.set_principal("ada");
  info.set_role("admin");
  info.add_features("admin-service");
  info.mutable_limits()->set_spp(77);
  EXPECT_THAT(server_description(info, "farm:7420"),
              AllOf(HasSubstr("farm:7420"), HasSubstr("0.2.0"), HasSubstr("f00d"), HasSubstr("ada"),
                    HasSubstr("admin"), HasSubstr("admin-service"), HasSubstr("77")));
}

TEST(FleetText, WorkersThatAreAskedToDrainAreShownAsSuch) {
  v1::ListWorkersResponse workers;
  v1::Worker& worker = *workers.add_workers();
  worker.set_principal("ada");
  worker.set_draining(true);
  worker.set_drain_requested(true);
  worker.set_held_leases(1);
  EXPECT_THAT(workers_table(workers, 0), AllOf(HasSubstr("draining"), HasSubstr("ada")));
  worker.set_held_leases(0);
  EXPECT_THAT(workers_table(workers, 0), HasSubstr("drained"));
}

}  // namespace
}  // namespace tessera::client
