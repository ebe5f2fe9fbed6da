// SPDX-License-Identifier: Apache-2.0
// Rejected results, and the quarantine of workers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "proto/tile_codec.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

struct Lie {
  const char* name;
  std::function<void(v1::RenderedItem&)> tell;
};

class Refusals : public ScriptedFarm {};

class Lies : public Refusals, public testing::WithParamInterface<Lie> {};

TEST_P(Lies, AreRefusedAndNothingIsCounted) {
  const std::string id = submit();
  v1::SubmitResultRequest request = delivery('a', synchronize(greeting('a')).leases(0));
  GetParam().tell(*request.mutable_items(request.items_size() - 1));
  const auto refused = coordinator().dispatcher().submit_result(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(job(id).samples_done(), 0u);
  EXPECT_EQ(job(id).counters().samples(), 0u);
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, core::Image(kWidthPx, kHeightPx).pixels);
}

void rerender(v1::RenderedItem& item, core::PixelRect rect, core::SampleRange range) {
  item = proto::encode_tile(ready_made_tile(rect, range));
}

INSTANTIATE_TEST_SUITE_P(
    Refusals, Lies,
    testing::Values(
        Lie{"NoTileOfTheGrid",
            [](auto& item) {
              rerender(item, {1, 0, 65, 64}, {0, 1});
            }},
        Lie{"PartOfATile",
            [](auto& item) {
              rerender(item, {0, 0, 64, 63}, {0, 1});
            }},
        Lie{"OutsideTheImage",
            [](auto& item) {
              rerender(item, {640, 0, 704, 64}, {0, 1});
            }},
        Lie{"SamplesNobodyAskedFor",
            [](auto& item) {
              rerender(item, {0, 0, 64, 64}, {kSpp, kSpp + 1});
            }},
        Lie{"EmptyRange",
            [](auto& item) { item.mutable_item()->set_sample_end(item.item().sample_begin()); }},
        Lie{"TooManySums", [](auto& item) { item.set_planes_zstd(item.planes_zstd() + item.planes_zstd()); }},
        Lie{"NoZstd", [](auto& item) { item.set_planes_zstd("sums"); }},
        Lie{"WrongChecksum", [](auto& item) { item.set_sums_xxh3(item.sums_xxh3() ^ 1); }},
        Lie{"WrongSampleCount", [](auto& item) { item.mutable_counters()->set_samples(1); }},
        Lie{"AForeignNonFiniteSample",
            [](auto& item) { item.mutable_counters()->mutable_first_non_finite()->set_x(100'000); }}),
    [](const auto& lie) { return lie.param.name; });

TEST_F(Refusals, AWorkerWithRepeatedRejectedResultsIsQuarantined) {
  const std::string id = submit();
  const auto greeting_from = [](char worker, char machine) {
    v1::SynchronizeRequest request = greeting(worker);
    request.set_worker_key(std::string(32, machine) + std::string(16, worker));
    return request;
  };
  const v1::Lease lease = synchronize(greeting_from('a', 'm')).leases(0);
  v1::SubmitResultRequest lie = delivery('a', lease);
  lie.mutable_items(0)->set_sums_xxh3(lie.items(0).sums_xxh3() ^ 1);
  for (int i = 1; i <= 2; ++i) {
    EXPECT_EQ(coordinator().dispatcher().submit_result(lie).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(coordinator().dispatcher().workers()[0].rejected_results(), static_cast<std::uint64_t>(i));
  }
  EXPECT_EQ(coordinator().dispatcher().submit_result(lie).error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(coordinator().dispatcher().workers()[0].quarantined());
  EXPECT_EQ(coordinator().dispatcher().workers()[0].held_leases(), 0u);

  EXPECT_EQ(coordinator().dispatcher().submit_result(delivery('a', lease)).error().code,
            ErrorCode::kFailedPrecondition);
  // New workers of its machine are rejected, whatever their names; other workers of its name are not.
  for (const char worker : {'a', 'b'}) {
    const WaitingCall call(coordinator(), greeting_from(worker, 'm'));
    ASSERT_TRUE(call.answered());
    EXPECT_THAT(call.answer().error().message,
                HasSubstr(std::string("worker host-") + worker + " is quarantined"));
  }
  v1::SynchronizeRequest namesake = greeting_from('d', 'n');
  namesake.set_name("host-a");
  EXPECT_EQ(synchronize(namesake).leases_size(), 1);
  work('c');
  EXPECT_EQ(coordinator().images().get(id)->image.pixels, ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
}

// A result that anybody could send does not count against the named worker.
TEST_F(Refusals, ResultsWithoutALeaseTokenAffectNoOther) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  const v1::Lease other = synchronize(greeting('b')).leases(0);
  const v1::SubmitResultRequest honest = delivery('a', lease);
  std::vector<v1::SubmitResultRequest> forgeries(5, honest);
  forgeries[0].clear_lease_token();
  forgeries[1].set_lease_token(other.token());
  forgeries[2].set_lease_id(other.id());
  forgeries[3].set_worker_id(std::string(32, 'f'));  // never registered
  forgeries[4].set_lease_id(0);
  for (v1::SubmitResultRequest& forgery : forgeries) {
    for (int i = 0; i < farm::Quarantine::kRejectionsUntilQuarantine; ++i) {
      const auto rejected = coordinator().dispatcher().submit_result(forgery);
      ASSERT_FALSE(rejected);
      EXPECT_EQ(rejected.error().code, ErrorCode::kInvalidArgument);
      EXPECT_THAT(rejected.error().message, HasSubstr("lease_token"));
      forgery.mutable_items(0)->set_planes_zstd("sums");
    }
  }
  EXPECT_EQ(job(id).samples_done(), 0u);
  for (const auto& worker : coordinator().dispatcher().workers()) {
    EXPECT_FALSE(worker.quarantined());
    EXPECT_EQ(worker.rejected_results(), 0u);
  }
  EXPECT_GT(deliver(honest).accepted_items(), 0u);
}

TEST_F(Refusals, ResultsOfWorkersFromBeforeARestartCount) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  v1::SubmitResultRequest forged = delivery('a', lease);
  forged.set_worker_id(std::string(32, 'b'));
  EXPECT_FALSE(coordinator().dispatcher().submit_result(forged));
  EXPECT_GT(deliver(delivery('a', lease)).accepted_items(), 0u);
}

TEST_F(Refusals, RejectionsBetweenAcceptedResultsDoNotQuarantine) {
  submit();
  for (int i = 0; i < 4; ++i) {
    const v1::Lease lease = synchronize(greeting('a')).leases(0);
    v1::SubmitResultRequest bad = delivery('a', lease);
    bad.mutable_items(0)->set_planes_zstd("sums");
    EXPECT_FALSE(coordinator().dispatcher().submit_result(bad));
    deliver(delivery('a', lease));
  }
  EXPECT_FALSE(coordinator().dispatcher().workers()[0].quarantined());
  EXPECT_EQ(coordinator().dispatcher().workers()[0].rejected_results(), 4u);
}

TEST_F(Refusals, AResultOfTooManyItemsIsRefusedUnread) {
  submit();
  v1::SubmitResultRequest request = delivery('a', synchronize(greeting('a')).leases(0));
  while (request.items_size() <= 256) *request.add_items() = request.items(0);
  const auto refused = coordinator().dispatcher().submit_result(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace tessera::server
