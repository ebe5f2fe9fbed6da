// SPDX-License-Identifier: Apache-2.0
#include "worker/lease_tracker.hpp"

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

class LeaseTrackerTest : public ::testing::Test {
 protected:
  v1::SynchronizeRequest report() {
    v1::SynchronizeRequest request;
    lease_tracker_.report(request);
    return request;
  }
  std::vector<std::uint64_t> held() {
    std::vector<std::uint64_t> ids;
    const v1::SynchronizeRequest request = report();
    for (const v1::Lease& l : request.held()) ids.push_back(l.id());
    return ids;
  }
  // A job whose files were fetched.
  void make_ready(const std::string& job) {
    const auto spec = lease_tracker_.next_to_fetch({});
    ASSERT_TRUE(spec && spec->job_id() == job);
    lease_tracker_.fetched(std::make_shared<Job>(Job{job, {}, {}}));
  }
  Piece take(std::uint64_t samples = 1'000'000) {
    return lease_tracker_.take({}, [&](const std::string&) { return samples; }).value();
  }
  void render(const Piece& piece) {
    lease_tracker_.rendered(piece, core::FilmTile(piece.item.rect, piece.item.range), 1ms);
  }
  void deliver() { lease_tracker_.delivered(lease_tracker_.next_delivery({}).value()); }

  LeaseTracker lease_tracker_{{.delays = {.first = 0s, .longest = 0s}}};
};

TEST_F(LeaseTrackerTest, HoldsAssignedLeases) {
  EXPECT_EQ(report().wanted_leases(), 2u);
  EXPECT_TRUE(lease_tracker_.apply(answer({lease(1, "a", 0, 4), lease(2, "a", 4, 8)}, {"a"})));
  EXPECT_EQ(held(), (std::vector<std::uint64_t>{1, 2}));
  EXPECT_FALSE(lease_tracker_.apply(answer({lease(1, "a", 0, 4), lease(2, "a", 4, 8)})));
  EXPECT_TRUE(lease_tracker_.apply(answer({lease(2, "a", 4, 8), lease(3, "a", 8, 9)})));
  EXPECT_EQ(held(), (std::vector<std::uint64_t>{2, 3}));
  EXPECT_EQ(report().known_job_ids_size(), 1);
}

TEST_F(LeaseTrackerTest, ReportsLeasesInFull) {
  lease_tracker_.apply(answer({lease(1, "a", 3, 9)}, {"a"}));
  make_ready("a");
  take(4096);
  EXPECT_EQ(report().held(0).SerializeAsString(), lease(1, "a", 3, 9).SerializeAsString());
}

TEST_F(LeaseTrackerTest, ALeaseOfAnUnknownJobIsNotTaken) {
  EXPECT_FALSE(lease_tracker_.apply(answer({lease(1, "a", 0, 4)})));
  EXPECT_TRUE(held().empty());
}

TEST_F(LeaseTrackerTest, WorkOutsideTheImageIsNotTaken) {
  v1::Lease outside = lease(1, "a", 0, 4);
  outside.mutable_items(0)->mutable_rect()->set_x1(513);
  lease_tracker_.apply(answer({outside}, {"a"}));
  EXPECT_EQ(report().held(0).items_size(), 0);
  const auto delivery = lease_tracker_.next_delivery({});
  EXPECT_TRUE(delivery->lease_finished);
  EXPECT_TRUE(delivery->tiles.empty());
}

TEST_F(LeaseTrackerTest, WorkLargerThanATileIsNotTaken) {
  v1::Lease wide = lease(1, "a", 0, 4);
  wide.mutable_items(0)->mutable_rect()->set_x1(core::kTilePx + 1);
  *wide.add_items() = lease(1, "a", 4, 8).items(0);
  lease_tracker_.apply(answer({wide}, {"a"}));
  ASSERT_EQ(report().held(0).items_size(), 1);
  EXPECT_EQ(report().held(0).items(0).sample_begin(), 4u);
}

TEST_F(LeaseTrackerTest, RendersInOrderAsSoonAsTheFilesAreHere) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 4), lease(2, "b", 0, 4)}, {"a", "b"}));
  const auto first = lease_tracker_.next_to_fetch({});
  EXPECT_EQ(first->job_id(), "a");
  make_ready("b");
  EXPECT_EQ(take().lease_id, 2u);
  lease_tracker_.fetched(std::make_shared<Job>(Job{"a", {}, {}}));
  EXPECT_EQ(take().lease_id, 1u);
}

TEST_F(LeaseTrackerTest, SaysWhatItFetchesAndRenders) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  const auto fetching = [&] { return report().fetching_job_ids_size(); };
  ASSERT_EQ(fetching(), 1) << "about to";
  EXPECT_EQ(report().fetching_job_ids(0), "a");
  const auto spec = lease_tracker_.next_to_fetch({});
  ASSERT_TRUE(spec);
  lease_tracker_.apply(answer({}));
  EXPECT_EQ(fetching(), 1) << "though others have its lease";
  lease_tracker_.fetched(std::make_shared<Job>(Job{"a", {}, {}}));
  EXPECT_EQ(fetching(), 0);

  lease_tracker_.apply(answer({lease(2, "a", 0, 8)}));
  const Piece piece = take();
  EXPECT_FALSE(report().has_rendering()) << "its scene is not built yet";
  lease_tracker_.begins(piece);
  lease_tracker_.apply(answer({}));
  ASSERT_TRUE(report().has_rendering()) << "though others have it";
  EXPECT_EQ(report().rendering().lease_id(), 2u);
  EXPECT_EQ(report().rendering().job_id(), "a");
  render(piece);
  EXPECT_FALSE(report().has_rendering());
}

TEST_F(LeaseTrackerTest, SaysWhichSamplesItIsAt) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 4), lease(2, "a", 4, 8)}, {"a"}));
  make_ready("a");
  const Piece first = take(2 * 4096);
  lease_tracker_.begins(first);
  EXPECT_EQ(proto::from_proto(report().rendering().item()).value(), (WorkItem{kTile, {0, 2}}));
  render(first);
  lease_tracker_.begins(take());
  EXPECT_EQ(proto::from_proto(report().rendering().item()).value(), (WorkItem{kTile, {2, 4}}))
      << "what is rendered waits to be delivered";
}

TEST_F(LeaseTrackerTest, NotifiesIdleWaiters) {
  auto fetched = std::async(std::launch::async, [&] { return lease_tracker_.next_to_fetch({}); });
  auto taken = std::async(std::launch::async, [&] { return take(); });
  auto delivery = std::async(std::launch::async, [&] { return lease_tracker_.next_delivery({}); });
  lease_tracker_.apply(answer({lease(1, "a", 0, 4)}, {"a"}));
  EXPECT_EQ(fetched.get()->job_id(), "a");
  lease_tracker_.fetched(std::make_shared<Job>(Job{"a", {}, {}}));
  render(taken.get());
  EXPECT_TRUE(delivery.get()->lease_finished);
}

TEST_F(LeaseTrackerTest, AStopNotifiesAllWaitersWithoutWork) {
  std::stop_source stop;
  auto fetched =
      std::async(std::launch::async, [&] { return lease_tracker_.next_to_fetch(stop.get_token()); });
  auto taken = std::async(std::launch::async, [&] { return lease_tracker_.take(stop.get_token(), nullptr); });
  auto delivery =
      std::async(std::launch::async, [&] { return lease_tracker_.next_delivery(stop.get_token()); });
  stop.request_stop();
  EXPECT_FALSE(fetched.get().has_value());
  EXPECT_FALSE(taken.get().has_value());
  EXPECT_FALSE(delivery.get().has_value());
}

TEST_F(LeaseTrackerTest, WhatIsRenderedOfAnUnwantedLeaseIsStillDelivered) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  make_ready("a");
  const Piece piece = take(2 * 4096);
  EXPECT_TRUE(lease_tracker_.apply(answer({})));
  EXPECT_FALSE(lease_tracker_.apply(answer({})));
  EXPECT_TRUE(held().empty());
  render(piece);
  const auto delivery = lease_tracker_.next_delivery({});
  ASSERT_EQ(delivery->tiles.size(), 1u);
  EXPECT_EQ(delivery->tiles[0].range, (core::SampleRange{0, 2}));
  EXPECT_TRUE(delivery->lease_finished);
}

TEST_F(LeaseTrackerTest, WhatOthersDeliveredIsNotRendered) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  make_ready("a");
  EXPECT_TRUE(lease_tracker_.apply(answer({lease(1, "a", 5, 8)})));
  EXPECT_EQ(take().item.range, (core::SampleRange{5, 8}));
}

// The answer to a report from before the lease ended still names it.
TEST_F(LeaseTrackerTest, AFinishedLeaseIsNotTakenUpAgain) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 1)}, {"a"}));
  make_ready("a");
  report();
  render(take());
  deliver();
  EXPECT_FALSE(lease_tracker_.apply(answer({lease(1, "a", 0, 1)})));
  EXPECT_TRUE(held().empty());
}

TEST_F(LeaseTrackerTest, DrainingDeliversWhatIsRenderedAndReturnsTheRest) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 8), lease(2, "a", 8, 16)}, {"a"}));
  make_ready("a");
  const Piece piece = take(3 * 4096);
  lease_tracker_.drain();
  EXPECT_FALSE(lease_tracker_.take({}, nullptr).has_value());
  EXPECT_TRUE(report().draining());
  EXPECT_EQ(report().wanted_leases(), 0u);
  lease_tracker_.apply(answer({lease(1, "a", 0, 8), lease(2, "a", 8, 16), lease(3, "a", 16, 24)}));
  render(piece);

  std::vector<std::uint64_t> finished;
  std::size_t tiles = 0;
  while (const auto delivery = lease_tracker_.next_delivery({})) {
    tiles += delivery->tiles.size();
    if (delivery->lease_finished) finished.push_back(delivery->lease_id);
    lease_tracker_.delivered(*delivery);
  }
  EXPECT_EQ(finished, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(tiles, 1u);
  EXPECT_TRUE(held().empty());
}

TEST_F(LeaseTrackerTest, LeasesThatCannotBeRenderedAreGivenBackAndTheJobTriedAgain) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  make_ready("a");
  lease_tracker_.cannot_render(take(), "no such scene");
  const auto delivery = lease_tracker_.next_delivery({});
  EXPECT_TRUE(delivery->lease_finished);
  EXPECT_TRUE(delivery->tiles.empty());
  EXPECT_EQ(delivery->decline_reason, "no such scene");
  lease_tracker_.delivered(*delivery);
  EXPECT_TRUE(held().empty());

  lease_tracker_.apply(answer({lease(2, "a", 0, 8)}));
  make_ready("a");
  EXPECT_EQ(take().lease_id, 2u);
}

TEST_F(LeaseTrackerTest, FilesThatCannotBeFetchedGiveTheLeaseBack) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  lease_tracker_.next_to_fetch({});
  lease_tracker_.cannot_fetch("a", "cannot fetch m.obj: No space left on device");
  const auto delivery = lease_tracker_.next_delivery({});
  EXPECT_TRUE(delivery->lease_finished);
  EXPECT_EQ(delivery->decline_reason, "") << "the scene may be fine";
}

TEST_F(LeaseTrackerTest, WhatKeepsAJobFromBeingRenderedIsReportedUntilItIsRendered) {
  const auto troubles = [this] {
    v1::SynchronizeRequest request;
    lease_tracker_.report(request);
    return request.troubles_size() == 0 ? ""
                                        : request.troubles(0).job_id() + ": " + request.troubles(0).text();
  };
  lease_tracker_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  EXPECT_EQ(troubles(), "");
  lease_tracker_.next_to_fetch({});
  lease_tracker_.cannot_fetch("a", "cannot fetch m.obj: No space left on device");
  EXPECT_EQ(troubles(), "a: cannot fetch m.obj: No space left on device");
  lease_tracker_.delivered(*lease_tracker_.next_delivery({}));
  EXPECT_EQ(troubles(), "a: cannot fetch m.obj: No space left on device");
  lease_tracker_.apply(answer({lease(2, "a", 0, 8)}));
  make_ready("a");
  const Piece piece = take();
  lease_tracker_.rendered(piece, core::FilmTile(piece.item.rect, piece.item.range), 1ms);
  EXPECT_EQ(troubles(), "");
}

// A hostile coordinator cannot make a worker hold or examine more than any needs.
TEST_F(LeaseTrackerTest, NoMoreLeasesAreHeldThanAnyCoordinatorGives) {
  std::vector<v1::Lease> many;
  for (int i = 1; i <= 10'000; ++i) many.push_back(lease(static_cast<std::uint64_t>(i), "a", 0, 1));
  lease_tracker_.apply(answer(many, {"a"}));
  EXPECT_EQ(held().size(), 64u);
}

// No sample of it was rendered, and its end is being delivered.
TEST_F(LeaseTrackerTest, ALeaseThatIsTakenAwayWhileItIsGivenBackStaysUntilThatHasArrived) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  lease_tracker_.next_to_fetch({});
  lease_tracker_.cannot_fetch("a", "cannot fetch m.obj: No space left on device");
  const auto delivery = lease_tracker_.next_delivery({});
  lease_tracker_.apply(answer({}));
  lease_tracker_.delivered(*delivery);
  EXPECT_TRUE(held().empty());
  lease_tracker_.apply(answer({lease(2, "a", 0, 8)}));
  make_ready("a");
  EXPECT_EQ(take().lease_id, 2u);
}

TEST(LeaseTracker, KeepsALeaseItCannotRenderForAWhileAndTakesOtherWork) {
  LeaseTracker lease_tracker({.delays = {.first = 1h, .longest = 1h}});
  lease_tracker.apply(answer({lease(1, "a", 0, 8)}, {"a"}));
  lease_tracker.next_to_fetch({});
  lease_tracker.cannot_fetch("a", "cannot fetch m.obj: No space left on device");
  v1::SynchronizeRequest request;
  lease_tracker.report(request);
  EXPECT_EQ(request.held_size(), 1);
  EXPECT_EQ(request.held(0).items_size(), 1);
  EXPECT_EQ(request.wanted_leases(), 3u);

  // Nothing can be delivered before the other lease is rendered.
  lease_tracker.apply(answer({lease(1, "a", 0, 8), lease(2, "b", 0, 1)}, {"b"}));
  lease_tracker.next_to_fetch({});
  lease_tracker.fetched(std::make_shared<Job>(Job{"b", {}, {}}));
  const auto piece = lease_tracker.take({}, [](const std::string&) { return 4096u; });
  lease_tracker.rendered(*piece, core::FilmTile(piece->item.rect, piece->item.range), 1ms);
  EXPECT_EQ(lease_tracker.next_delivery({})->lease_id, 2u);

  lease_tracker.drain();
  EXPECT_EQ(lease_tracker.next_delivery({})->lease_id, 1u);
}

v1::SubmitResultResponse answer_with(const v1::Lease& given, const std::string& new_job = "") {
  v1::SubmitResultResponse response;
  *response.add_new_leases() = given;
  if (!new_job.empty()) *response.mutable_jobs() = answer({}, {new_job}).jobs();
  return response;
}

TEST_F(LeaseTrackerTest, AFinishedLeaseNamesTheOthers) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 1), lease(2, "a", 2, 3), lease(3, "a", 3, 4)}, {"a"}));
  make_ready("a");
  render(take());
  const auto delivery = lease_tracker_.next_delivery({});
  ASSERT_TRUE(delivery->lease_finished);
  EXPECT_EQ(delivery->held_besides, (std::vector<std::uint64_t>{2, 3}));
}

TEST_F(LeaseTrackerTest, ADrainingWorkerListsNoLeases) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 1), lease(2, "a", 1, 2)}, {"a"}));
  make_ready("a");
  render(take());
  lease_tracker_.drain();
  const auto delivery = lease_tracker_.next_delivery({});
  EXPECT_TRUE(delivery->held_besides.empty());
  lease_tracker_.delivered(*delivery, answer_with(lease(3, "a", 2, 3)));
  EXPECT_EQ(held(), std::vector<std::uint64_t>{2}) << "which goes back";
}

TEST_F(LeaseTrackerTest, TakesALeaseThatComesWithAnAnswer) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 1)}, {"a"}));
  make_ready("a");
  render(take());
  lease_tracker_.delivered(*lease_tracker_.next_delivery({}), answer_with(lease(2, "b", 0, 1), "b"));
  make_ready("b");
  EXPECT_EQ(take().lease_id, 2u);
  EXPECT_EQ(held(), std::vector<std::uint64_t>{2});
}

// The answer to a Synchronize can be older than the answer to a delivery that arrived before it.
TEST_F(LeaseTrackerTest, KeepsWhatCameWithAnAnswerUntilItHasReportedIt) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 1), lease(2, "a", 1, 2)}, {"a"}));
  make_ready("a");
  render(take());
  report();
  lease_tracker_.delivered(*lease_tracker_.next_delivery({}), answer_with(lease(3, "a", 2, 3)));
  lease_tracker_.apply(answer({lease(2, "a", 1, 2)}));
  EXPECT_EQ(held(), (std::vector<std::uint64_t>{2, 3}));
  lease_tracker_.apply(answer({lease(2, "a", 1, 2)}));
  EXPECT_EQ(held(), std::vector<std::uint64_t>{2});
}

TEST_F(LeaseTrackerTest, TakesNoLeaseTwiceThatBothAnswersBring) {
  lease_tracker_.apply(answer({lease(1, "a", 0, 1), lease(2, "a", 1, 2)}, {"a"}));
  make_ready("a");
  render(take());
  const auto delivery = lease_tracker_.next_delivery({});
  lease_tracker_.apply(answer({lease(2, "a", 1, 2), lease(3, "a", 2, 3)}));
  lease_tracker_.delivered(*delivery, answer_with(lease(3, "a", 2, 3)));
  EXPECT_EQ(held(), (std::vector<std::uint64_t>{2, 3}));
}

TEST_F(LeaseTrackerTest, ForgetsJobsAfterATimeout) {
  for (int i = 0; i < 40; ++i) {
    const std::string job = "job" + std::to_string(i);
    lease_tracker_.apply(answer({lease(1, job, 0, 1)}, {job}));
    lease_tracker_.apply(answer({}));
  }
  EXPECT_LE(report().known_job_ids_size(), 16);
}

}  // namespace
}  // namespace tessera::worker
