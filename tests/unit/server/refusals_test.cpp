// Results that are refused, and whom that puts aside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "proto/tile_codec.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::coordinator {
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
  const auto refused = coordinator().submit_result(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(job(id).samples_done(), 0u);
  EXPECT_EQ(job(id).counters().samples(), 0u);
  EXPECT_EQ(coordinator().picture(id)->image.pixels, core::Image(kWidthPx, kHeightPx).pixels);
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
        Lie{"OutsideThePicture",
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

TEST_F(Refusals, AWorkerWhoseResultsAreRefusedAgainAndAgainIsPutAside) {
  const std::string id = submit();
  const v1::Lease lease = synchronize(greeting('a')).leases(0);
  v1::SubmitResultRequest lie = delivery('a', lease);
  lie.mutable_items(0)->set_sums_xxh3(lie.items(0).sums_xxh3() ^ 1);
  for (int i = 1; i <= 2; ++i) {
    EXPECT_EQ(coordinator().submit_result(lie).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(coordinator().workers()[0].refused_results(), static_cast<std::uint64_t>(i));
  }
  v1::SubmitResultRequest invented = delivery('a', lease);
  invented.set_lease_id(lease.id() + 1);
  EXPECT_EQ(coordinator().submit_result(invented).error().code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(coordinator().workers()[0].put_aside());
  EXPECT_EQ(coordinator().workers()[0].held_leases(), 0u);

  EXPECT_EQ(coordinator().submit_result(delivery('a', lease)).error().code, ErrorCode::kFailedPrecondition);
  for (const char worker : {'a', 'b'}) {
    v1::SynchronizeRequest request = greeting(worker);
    request.set_name("host-a");
    const WaitingCall call(coordinator(), request);
    ASSERT_TRUE(call.answered());
    EXPECT_THAT(call.answer().error().message, HasSubstr("worker host-a is put aside"));
  }
  work('c');
  EXPECT_EQ(coordinator().picture(id)->image.pixels, ready_made_picture(kWidthPx, kHeightPx, kSpp).pixels);
}

TEST_F(Refusals, WhoWorksUnderTheNameOfOneThatIsPutAsideGoesOn) {
  submit();
  for (const std::string name : {"farm", ""}) {
    const auto named = [&](char worker) {
      v1::SynchronizeRequest request = greeting(worker);
      request.set_name(name);
      return request;
    };
    const char bad = name.empty() ? 'b' : 'a', later = name.empty() ? 'e' : 'd';
    const v1::Lease lease = synchronize(named(bad)).leases(0);
    v1::SynchronizeRequest other = named('c');
    *other.add_held() = synchronize(other).leases(0);
    v1::SubmitResultRequest lie = delivery(bad, lease);
    lie.mutable_items(0)->set_sums_xxh3(lie.items(0).sums_xxh3() ^ 1);
    for (int i = 0; i < Conduct::kRefusalsUntilAside; ++i) EXPECT_FALSE(coordinator().submit_result(lie));
    const WaitingCall refused(coordinator(), named(bad));
    EXPECT_TRUE(refused.answered() && !refused.answer());
    const WaitingCall goes_on(coordinator(), other);
    EXPECT_TRUE(!goes_on.answered() || goes_on.answer());
    const WaitingCall newcomer(coordinator(), named(later));
    EXPECT_EQ(newcomer.answered() && !newcomer.answer(), !name.empty());
  }
}

TEST(ConductTest, ForgetsWhoIsGoneUnlessItWasPutAside) {
  Conduct conduct;
  for (int i = 0; i < Conduct::kRefusalsUntilAside; ++i) conduct.refused("liar", "");
  conduct.refused("gone", "");
  conduct.refused("here", "");
  conduct.forget_others({"here"});
  EXPECT_EQ(conduct.refusals("gone"), 0u);
  EXPECT_EQ(conduct.refusals("here"), 1u);
  EXPECT_TRUE(conduct.is_aside("liar"));
  EXPECT_FALSE(conduct.is_name_aside(""));
}

TEST_F(Refusals, RefusalsWithGoodResultsInBetweenPutNobodyAside) {
  submit();
  for (int i = 0; i < 4; ++i) {
    const v1::Lease lease = synchronize(greeting('a')).leases(0);
    v1::SubmitResultRequest bad = delivery('a', lease);
    bad.mutable_items(0)->set_planes_zstd("sums");
    EXPECT_FALSE(coordinator().submit_result(bad));
    deliver(delivery('a', lease));
  }
  EXPECT_FALSE(coordinator().workers()[0].put_aside());
  EXPECT_EQ(coordinator().workers()[0].refused_results(), 4u);
}

TEST_F(Refusals, AResultOfTooManyItemsIsRefusedUnread) {
  submit();
  v1::SubmitResultRequest request = delivery('a', synchronize(greeting('a')).leases(0));
  while (request.items_size() <= 256) *request.add_items() = request.items(0);
  const auto refused = coordinator().submit_result(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace tessera::coordinator
