#include "worker/holdings.hpp"

#include <gtest/gtest.h>

#include <future>

namespace tessera::worker {
namespace {

using namespace std::chrono_literals;

constexpr core::PixelRect kTile{0, 0, 64, 64};

v1::Lease lease(std::uint64_t id, const std::string& job, std::uint32_t sample_begin,
                std::uint32_t sample_end) {
  v1::Lease message;
  message.set_id(id);
  message.set_job_id(job);
  *message.add_items() = proto::to_proto(WorkItem{kTile, {sample_begin, sample_end}});
  return message;
}

v1::SynchronizeResponse answer(const std::vector<v1::Lease>& leases,
                               const std::vector<std::string>& jobs = {}) {
  v1::SynchronizeResponse response;
  for (const v1::Lease& l : leases) *response.add_leases() = l;
  for (const std::string& id : jobs) {
    v1::JobSpec& spec = *response.add_jobs();
    spec.set_job_id(id);
    *spec.mutable_settings() = proto::to_proto(core::RenderSettings{});
  }
  return response;
}

class HoldingsTest : public ::testing::Test {
 protected:
  v1::SynchronizeRequest report() {
    v1::SynchronizeRequest request;
    holdings_.report(request);
    return request;
  }
  std::vector<std::uint64_t> held() {
    std::vector<std::uint64_t> ids;
    const v1::SynchronizeRequest request = report();
    for (const v1::Lease& l : request.held()) ids.push_back(l.id());
    return ids;
  }
  // A job whose files are here.
  void make_ready(const std::string& job) {
    const auto spec = holdings_.next_to_fetch({});
    ASSERT_TRUE(spec && spec->job_id() == job);
    holdings_.fetched(std::make_shared<Job>(Job{job, {}, {}}));
  }
  Piece take(std::uint64_t samples = 1'000'000) {
    return holdings_.take({}, [&](const std::string&) { return samples; }).value();
  }
  void render(const Piece& piece) {
    holdings_.rendered(piece, core::FilmTile(piece.item.rect, piece.item.range), 1ms);
  }
  void deliver() { holdings_.delivered(holdings_.next_delivery({}).value()); }

  Holdings holdings_{{.first_delay = 0s, .longest_delay = 0s}};
};

TEST_F(HoldingsTest, HoldsWhatItIsToldTo) {
  EXPECT_EQ(report().wanted_leases(), 2u);
  EXPECT_TRUE(holdings_.apply(answer({lease(1, "a", 0, 4), lease(2, "a", 4, 8)}, {"a"})));
  EXPECT_EQ(held(), (std::vector<std::uint64_t>{1, 2}));
  EXPECT_FALSE(holdings_.apply(answer({lease(1, "a", 0, 4), lease(2, "a", 4, 8)})));
  EXPECT_TRUE(holdings_.apply(answer({lease(2, "a", 4, 8), lease(3, "a", 8, 9)})));
  EXPECT_EQ(held(), (std::vector<std::uint64_t>{2, 3}));
  EXPECT_EQ(report().known_job_ids_size(), 1);
}

TEST_F(HoldingsTest, ReportsLeasesInFull) {
  holdings_.apply(answer({lease(1, "a", 3, 9)}, {"a"}));
  make_ready("a");
  take(4096);
  EXPECT_EQ(report().held(0).SerializeAsString(), lease(1, "a", 3, 9).SerializeAsString());
}

TEST_F(HoldingsTest, ALeaseOfAnUnknownJobIsNotTaken) {
  EXPECT_FALSE(holdings_.apply(answer({lease(1, "a", 0, 4)})));
  EXPECT_TRUE(held().empty());
}

TEST_F(HoldingsTest, WorkOutsideThePictureIsNotTaken) {
  v1::Lease outside = lease(1, "a", 0, 4);
  outside.mutable_items(0)->mutable_rect()->set_x1(513);
  holdings_.apply(answer({outside}, {"a"}));
  EXPECT_EQ(report().held(0).items_size(), 0);
  const auto delivery = holdings_.next_delivery({});
  EXPECT_TRUE(delivery->lease_finished);
  EXPECT_TRUE(delivery->tiles.empty());
}

TEST_F(HoldingsTest, WorkLargerThanATileIsNotTaken) {
  v1::Lease wide = lease(1, "a", 0, 4);
  wide.mutable_items(0)->mutable_rect()->set_x1(core::kTilePx + 1);
  *wide.add_items() = lease(1, "a", 4, 8).items(0);
  holdings_.apply(answer({wide}, {"a"}));
  ASSERT_EQ(report().held(0).items_size(), 1);
  EXPECT_EQ(report().held(0).items(0).sample_begin(), 4u);
}

TEST_F(HoldingsTest, RendersInOrderAsSoonAsTheFilesAreHere) {
  holdings_.apply(answer({lease(1, "a", 0, 4), lease(2, "b", 0, 4)}, {"a", "b"}));
  const auto first = holdings_.next_to_fetch({});
  EXPECT_EQ(first->job_id(), "a");
  make_ready("b");
  EXPECT_EQ(take().lease_id, 2u);
  holdings_.fetched(std::make_shared<Job>(Job{"a", {}, {}}));
  EXPECT_EQ(take().lease_id, 1u);
}

TEST_F(HoldingsTest, SaysWhatItFetchesAndRenders) {
  holdings_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  const auto fetching = [&] { return report().fetching_job_ids_size(); };
  ASSERT_EQ(fetching(), 1) << "about to";
  EXPECT_EQ(report().fetching_job_ids(0), "a");
  const auto spec = holdings_.next_to_fetch({});
  ASSERT_TRUE(spec);
  holdings_.apply(answer({}));
  EXPECT_EQ(fetching(), 1) << "though others have its lease";
  holdings_.fetched(std::make_shared<Job>(Job{"a", {}, {}}));
  EXPECT_EQ(fetching(), 0);

  holdings_.apply(answer({lease(2, "a", 0, 8)}));
  const Piece piece = take();
  EXPECT_FALSE(report().has_rendering()) << "its scene is not built yet";
  holdings_.begins(piece);
  holdings_.apply(answer({}));
  ASSERT_TRUE(report().has_rendering()) << "though others have it";
  EXPECT_EQ(report().rendering().lease_id(), 2u);
  EXPECT_EQ(report().rendering().job_id(), "a");
  render(piece);
  EXPECT_FALSE(report().has_rendering());
}

TEST_F(HoldingsTest, SaysWhichSamplesItIsAt) {
  holdings_.apply(answer({lease(1, "a", 0, 4), lease(2, "a", 4, 8)}, {"a"}));
  make_ready("a");
  const Piece first = take(2 * 4096);
  holdings_.begins(first);
  EXPECT_EQ(proto::from_proto(report().rendering().item()).value(), (WorkItem{kTile, {0, 2}}));
  render(first);
  holdings_.begins(take());
  EXPECT_EQ(proto::from_proto(report().rendering().item()).value(), (WorkItem{kTile, {2, 4}}))
      << "what is rendered waits to be delivered";
}

TEST_F(HoldingsTest, WakesWhoWaitsForWork) {
  auto fetched = std::async(std::launch::async, [&] { return holdings_.next_to_fetch({}); });
  auto taken = std::async(std::launch::async, [&] { return take(); });
  auto delivery = std::async(std::launch::async, [&] { return holdings_.next_delivery({}); });
  holdings_.apply(answer({lease(1, "a", 0, 4)}, {"a"}));
  EXPECT_EQ(fetched.get()->job_id(), "a");
  holdings_.fetched(std::make_shared<Job>(Job{"a", {}, {}}));
  render(taken.get());
  EXPECT_TRUE(delivery.get()->lease_finished);
}

TEST_F(HoldingsTest, AStopWakesEveryoneEmptyHanded) {
  std::stop_source stop;
  auto fetched = std::async(std::launch::async, [&] { return holdings_.next_to_fetch(stop.get_token()); });
  auto taken = std::async(std::launch::async, [&] { return holdings_.take(stop.get_token(), nullptr); });
  auto delivery = std::async(std::launch::async, [&] { return holdings_.next_delivery(stop.get_token()); });
  stop.request_stop();
  EXPECT_FALSE(fetched.get().has_value());
  EXPECT_FALSE(taken.get().has_value());
  EXPECT_FALSE(delivery.get().has_value());
}

TEST_F(HoldingsTest, WhatIsRenderedOfAnUnwantedLeaseIsStillDelivered) {
  holdings_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  make_ready("a");
  const Piece piece = take(2 * 4096);
  EXPECT_TRUE(holdings_.apply(answer({})));
  EXPECT_FALSE(holdings_.apply(answer({})));
  EXPECT_TRUE(held().empty());
  render(piece);
  const auto delivery = holdings_.next_delivery({});
  ASSERT_EQ(delivery->tiles.size(), 1u);
  EXPECT_EQ(delivery->tiles[0].range, (core::SampleRange{0, 2}));
  EXPECT_TRUE(delivery->lease_finished);
}

TEST_F(HoldingsTest, WhatOthersDeliveredIsNotRendered) {
  holdings_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  make_ready("a");
  EXPECT_TRUE(holdings_.apply(answer({lease(1, "a", 5, 8)})));
  EXPECT_EQ(take().item.range, (core::SampleRange{5, 8}));
}

// The answer to a report made before the lease was finished still names it.
TEST_F(HoldingsTest, AFinishedLeaseIsNotTakenUpAgain) {
  holdings_.apply(answer({lease(1, "a", 0, 1)}, {"a"}));
  make_ready("a");
  report();
  render(take());
  deliver();
  EXPECT_FALSE(holdings_.apply(answer({lease(1, "a", 0, 1)})));
  EXPECT_TRUE(held().empty());
}

TEST_F(HoldingsTest, DrainingDeliversWhatIsRenderedAndReturnsTheRest) {
  holdings_.apply(answer({lease(1, "a", 0, 8), lease(2, "a", 8, 16)}, {"a"}));
  make_ready("a");
  const Piece piece = take(3 * 4096);
  holdings_.drain();
  EXPECT_FALSE(holdings_.take({}, nullptr).has_value());
  EXPECT_TRUE(report().draining());
  EXPECT_EQ(report().wanted_leases(), 0u);
  holdings_.apply(answer({lease(1, "a", 0, 8), lease(2, "a", 8, 16), lease(3, "a", 16, 24)}));
  render(piece);

  std::vector<std::uint64_t> finished;
  std::size_t tiles = 0;
  while (const auto delivery = holdings_.next_delivery({})) {
    tiles += delivery->tiles.size();
    if (delivery->lease_finished) finished.push_back(delivery->lease_id);
    holdings_.delivered(*delivery);
  }
  EXPECT_EQ(finished, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(tiles, 1u);
  EXPECT_TRUE(held().empty());
}

TEST_F(HoldingsTest, LeasesThatCannotBeRenderedAreGivenBackAndTheJobTriedAgain) {
  holdings_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  make_ready("a");
  holdings_.cannot_render(take(), "no such scene");
  const auto delivery = holdings_.next_delivery({});
  EXPECT_TRUE(delivery->lease_finished);
  EXPECT_TRUE(delivery->tiles.empty());
  EXPECT_EQ(delivery->cannot_build, "no such scene");
  holdings_.delivered(*delivery);
  EXPECT_TRUE(held().empty());

  holdings_.apply(answer({lease(2, "a", 0, 8)}));
  make_ready("a");
  EXPECT_EQ(take().lease_id, 2u);
}

TEST_F(HoldingsTest, FilesThatCannotBeFetchedGiveTheLeaseBack) {
  holdings_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  holdings_.next_to_fetch({});
  holdings_.cannot_fetch("a", "cannot fetch m.obj: No space left on device");
  const auto delivery = holdings_.next_delivery({});
  EXPECT_TRUE(delivery->lease_finished);
  EXPECT_EQ(delivery->cannot_build, "") << "the scene may be fine";
}

TEST_F(HoldingsTest, WhatKeepsAJobFromBeingRenderedIsReportedUntilItIsRendered) {
  const auto troubles = [this] {
    v1::SynchronizeRequest request;
    holdings_.report(request);
    return request.troubles_size() == 0 ? ""
                                        : request.troubles(0).job_id() + ": " + request.troubles(0).text();
  };
  holdings_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  EXPECT_EQ(troubles(), "");
  holdings_.next_to_fetch({});
  holdings_.cannot_fetch("a", "cannot fetch m.obj: No space left on device");
  EXPECT_EQ(troubles(), "a: cannot fetch m.obj: No space left on device");
  holdings_.delivered(*holdings_.next_delivery({}));
  EXPECT_EQ(troubles(), "a: cannot fetch m.obj: No space left on device");
  holdings_.apply(answer({lease(2, "a", 0, 8)}));
  make_ready("a");
  const Piece piece = take();
  holdings_.rendered(piece, core::FilmTile(piece.item.rect, piece.item.range), 1ms);
  EXPECT_EQ(troubles(), "");
}

// A hostile coordinator cannot make a worker hold, or look at, more than any needs.
TEST_F(HoldingsTest, NoMoreLeasesAreHeldThanAnyCoordinatorGives) {
  std::vector<v1::Lease> many;
  for (int i = 1; i <= 10'000; ++i) many.push_back(lease(static_cast<std::uint64_t>(i), "a", 0, 1));
  holdings_.apply(answer(many, {"a"}));
  EXPECT_EQ(held().size(), 64u);
}

// Nothing was rendered of it, and its end is on its way.
TEST_F(HoldingsTest, ALeaseThatIsTakenAwayWhileItIsGivenBackStaysUntilThatHasArrived) {
  holdings_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  holdings_.next_to_fetch({});
  holdings_.cannot_fetch("a", "cannot fetch m.obj: No space left on device");
  const auto delivery = holdings_.next_delivery({});
  holdings_.apply(answer({}));
  holdings_.delivered(*delivery);
  EXPECT_TRUE(held().empty());
  holdings_.apply(answer({lease(2, "a", 0, 8)}));
  make_ready("a");
  EXPECT_EQ(take().lease_id, 2u);
}

TEST(Holdings, KeepsALeaseItCannotRenderForAWhileAndTakesOtherWork) {
  Holdings holdings({.first_delay = 1h, .longest_delay = 1h});
  holdings.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  holdings.next_to_fetch({});
  holdings.cannot_fetch("a", "cannot fetch m.obj: No space left on device");
  v1::SynchronizeRequest request;
  holdings.report(request);
  EXPECT_EQ(request.held_size(), 1);
  EXPECT_EQ(request.held(0).items_size(), 1);
  EXPECT_EQ(request.wanted_leases(), 3u);

  // Nothing is due before the other lease is rendered.
  holdings.apply(answer({lease(1, "a", 0, 8), lease(2, "b", 0, 1)}, {"b"}));
  holdings.next_to_fetch({});
  holdings.fetched(std::make_shared<Job>(Job{"b", {}, {}}));
  const auto piece = holdings.take({}, [](const std::string&) { return 4096u; });
  holdings.rendered(*piece, core::FilmTile(piece->item.rect, piece->item.range), 1ms);
  EXPECT_EQ(holdings.next_delivery({})->lease_id, 2u);

  holdings.drain();
  EXPECT_EQ(holdings.next_delivery({})->lease_id, 1u);
}

v1::SubmitResultResponse answer_with(const v1::Lease& given, const std::string& new_job = "") {
  v1::SubmitResultResponse response;
  *response.add_new_leases() = given;
  if (!new_job.empty()) *response.mutable_jobs() = answer({}, {new_job}).jobs();
  return response;
}

TEST_F(HoldingsTest, AFinishedLeaseNamesTheOthers) {
  holdings_.apply(answer({lease(1, "a", 0, 1), lease(2, "a", 2, 3), lease(3, "a", 3, 4)}, {"a"}));
  make_ready("a");
  render(take());
  const auto delivery = holdings_.next_delivery({});
  ASSERT_TRUE(delivery->lease_finished);
  EXPECT_EQ(delivery->held_besides, (std::vector<std::uint64_t>{2, 3}));
}

TEST_F(HoldingsTest, WhoTakesNothingMoreNamesNone) {
  holdings_.apply(answer({lease(1, "a", 0, 1), lease(2, "a", 1, 2)}, {"a"}));
  make_ready("a");
  render(take());
  holdings_.drain();
  const auto delivery = holdings_.next_delivery({});
  EXPECT_TRUE(delivery->held_besides.empty());
  holdings_.delivered(*delivery, answer_with(lease(3, "a", 2, 3)));
  EXPECT_EQ(held(), std::vector<std::uint64_t>{2}) << "which goes back";
}

TEST_F(HoldingsTest, TakesALeaseThatComesWithAnAnswer) {
  holdings_.apply(answer({lease(1, "a", 0, 1)}, {"a"}));
  make_ready("a");
  render(take());
  holdings_.delivered(*holdings_.next_delivery({}), answer_with(lease(2, "b", 0, 1), "b"));
  make_ready("b");
  EXPECT_EQ(take().lease_id, 2u);
  EXPECT_EQ(held(), std::vector<std::uint64_t>{2});
}

// The answer to a Synchronize can be older than that to a delivery which arrived before it.
TEST_F(HoldingsTest, KeepsWhatCameWithAnAnswerUntilItHasReportedIt) {
  holdings_.apply(answer({lease(1, "a", 0, 1), lease(2, "a", 1, 2)}, {"a"}));
  make_ready("a");
  render(take());
  report();
  holdings_.delivered(*holdings_.next_delivery({}), answer_with(lease(3, "a", 2, 3)));
  holdings_.apply(answer({lease(2, "a", 1, 2)}));
  EXPECT_EQ(held(), (std::vector<std::uint64_t>{2, 3}));
  holdings_.apply(answer({lease(2, "a", 1, 2)}));
  EXPECT_EQ(held(), std::vector<std::uint64_t>{2});
}

TEST_F(HoldingsTest, TakesNoLeaseTwiceThatBothAnswersBring) {
  holdings_.apply(answer({lease(1, "a", 0, 1), lease(2, "a", 1, 2)}, {"a"}));
  make_ready("a");
  render(take());
  const auto delivery = holdings_.next_delivery({});
  holdings_.apply(answer({lease(2, "a", 1, 2), lease(3, "a", 2, 3)}));
  holdings_.delivered(*delivery, answer_with(lease(3, "a", 2, 3)));
  EXPECT_EQ(held(), (std::vector<std::uint64_t>{2, 3}));
}

TEST_F(HoldingsTest, ForgetsJobsItHasNotHeardOfForLong) {
  for (int i = 0; i < 40; ++i) {
    const std::string job = "job" + std::to_string(i);
    holdings_.apply(answer({lease(1, job, 0, 1)}, {job}));
    holdings_.apply(answer({}));
  }
  EXPECT_LE(report().known_job_ids_size(), 16);
}

}  // namespace
}  // namespace tessera::worker
