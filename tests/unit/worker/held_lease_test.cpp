// SPDX-License-Identifier: Apache-2.0
#include "worker/held_lease.hpp"

#include <gtest/gtest.h>

namespace tessera::worker {
namespace {

using namespace std::chrono_literals;

constexpr core::PixelRect kTileA{0, 0, 64, 64}, kTileB{64, 0, 128, 64};
constexpr std::uint64_t kOneSample = 64 * 64;

HeldLease some_lease() {
  return {7, "job", {{kTileA, {0, 8}}, {kTileB, {0, 2}}}};
}

// Takes a piece and renders it, with the number of the first sample in every sum.
WorkItem render_next(HeldLease& lease, std::uint64_t target_samples, Duration took = 1ms) {
  const WorkItem piece = lease.take(target_samples);
  lease.rendered(core::FilmTile(piece.rect, piece.range), took);
  return piece;
}

std::vector<WorkItem> items_of(const Delivery& delivery) {
  std::vector<WorkItem> items;
  for (const core::FilmTile& tile : delivery.tiles) items.push_back({tile.rect, tile.range});
  return items;
}

TEST(HeldLease, CutsItemsIntoPiecesOfTheSizeAskedFor) {
  HeldLease lease = some_lease();
  EXPECT_EQ(render_next(lease, 3 * kOneSample), (WorkItem{kTileA, {0, 3}}));
  EXPECT_EQ(render_next(lease, 1), (WorkItem{kTileA, {3, 4}}));
  EXPECT_EQ(render_next(lease, 100 * kOneSample), (WorkItem{kTileA, {4, 8}}));
  EXPECT_EQ(render_next(lease, 100 * kOneSample), (WorkItem{kTileB, {0, 2}}));
  EXPECT_FALSE(lease.has_todo());
}

TEST(HeldLease, SendsCompleteItemsAndThenThatItIsFinished) {
  HeldLease lease = some_lease();
  EXPECT_FALSE(lease.has_delivery());
  render_next(lease, 5 * kOneSample);
  EXPECT_FALSE(lease.has_delivery());
  render_next(lease, 5 * kOneSample);
  const Delivery first = lease.take_batch();
  EXPECT_EQ(items_of(first), (std::vector<WorkItem>{{kTileA, {0, 8}}}));
  EXPECT_EQ(first.render_time, 2ms);
  EXPECT_FALSE(first.lease_finished);
  EXPECT_FALSE(lease.has_delivery());
  lease.delivered();

  render_next(lease, 5 * kOneSample);
  const Delivery second = lease.take_batch();
  EXPECT_EQ(items_of(second), (std::vector<WorkItem>{{kTileB, {0, 2}}}));
  EXPECT_TRUE(second.lease_finished);
  EXPECT_FALSE(lease.empty());
  lease.delivered();
  EXPECT_TRUE(lease.empty());
}

TEST(HeldLease, ReportsTheSameWhateverBecameOfItsPieces) {
  HeldLease lease = some_lease();
  const std::vector<WorkItem> all{{kTileA, {0, 8}}, {kTileB, {0, 2}}};
  EXPECT_EQ(lease.items(), all);
  const WorkItem piece = lease.take(3 * kOneSample);
  EXPECT_EQ(lease.items(), all);
  lease.rendered(core::FilmTile(piece.rect, piece.range), 3s);
  EXPECT_EQ(lease.items(), all);
  const Delivery delivery = lease.take_batch();
  EXPECT_EQ(lease.items(), all);
  lease.delivered();
  EXPECT_EQ(lease.items(), (std::vector<WorkItem>{{kTileA, {3, 8}}, {kTileB, {0, 2}}}));
}

TEST(HeldLease, SendsPartsOfAnItemThatTakesLong) {
  HeldLease lease = some_lease();
  render_next(lease, kOneSample, 1500ms);
  EXPECT_FALSE(lease.has_delivery());
  render_next(lease, kOneSample, 1500ms);
  const Delivery delivery = lease.take_batch();
  EXPECT_EQ(items_of(delivery), (std::vector<WorkItem>{{kTileA, {0, 2}}}));
  EXPECT_EQ(delivery.render_time, 3s);
}

TEST(HeldLease, StoppingSendsTheFirstPartOfTheItemInHand) {
  HeldLease lease = some_lease();
  render_next(lease, 2 * kOneSample);
  const WorkItem piece = lease.take(kOneSample);
  lease.stop_rendering();
  EXPECT_FALSE(lease.has_delivery());
  lease.rendered(core::FilmTile(piece.rect, piece.range), 1ms);
  const Delivery delivery = lease.take_batch();
  EXPECT_EQ(items_of(delivery), (std::vector<WorkItem>{{kTileA, {0, 3}}}));
  EXPECT_TRUE(delivery.lease_finished);
}

TEST(HeldLease, PutsPiecesTogetherSampleBySample) {
  HeldLease lease(1, "job", {{{0, 0, 1, 1}, {0, 3}}});
  for (std::uint64_t s = 0; s < 3; ++s) {
    const WorkItem piece = lease.take(1);
    core::FilmTile tile(piece.rect, piece.range);
    tile.sums = {s, 10 + s, 100 + s};
    tile.odd_sums = {s % 2 * s, s % 2 * (10 + s), s % 2 * (100 + s)};
    tile.counters.samples = 1;
    lease.rendered(std::move(tile), 1ms);
  }
  const Delivery delivery = lease.take_batch();
  ASSERT_EQ(delivery.tiles.size(), 1u);
  EXPECT_EQ(delivery.tiles[0].sums, (std::vector<std::uint64_t>{3, 33, 303}));
  EXPECT_EQ(delivery.tiles[0].odd_sums, (std::vector<std::uint64_t>{1, 11, 101}));
  EXPECT_EQ(delivery.tiles[0].counters.samples, 3u);
}

TEST(HeldLease, KeepsOnlyWhatIsStillMissing) {
  HeldLease lease = some_lease();
  render_next(lease, 2 * kOneSample);
  EXPECT_FALSE(lease.keep_only({{kTileA, {0, 8}}, {kTileB, {0, 2}}}));
  EXPECT_TRUE(lease.keep_only({{kTileA, {5, 8}}}));
  EXPECT_EQ(render_next(lease, 100 * kOneSample), (WorkItem{kTileA, {5, 8}}));
  EXPECT_FALSE(lease.has_todo());
  EXPECT_EQ(items_of(lease.take_batch()), (std::vector<WorkItem>{{kTileA, {0, 2}}, {kTileA, {5, 8}}}));
}

TEST(HeldLease, APieceThatCouldNotBeRenderedIsDoneAgain) {
  HeldLease lease = some_lease();
  lease.take(kOneSample);
  lease.not_rendered();
  EXPECT_EQ(lease.items(), (std::vector<WorkItem>{{kTileA, {0, 8}}, {kTileB, {0, 2}}}));
  lease.take(kOneSample);
  lease.stop_rendering();
  lease.not_rendered();
  EXPECT_TRUE(lease.empty());
}

TEST(HeldLease, OfAnAbandonedPieceWhatWasRenderedBeforeItIsSent) {
  HeldLease lease = some_lease();
  render_next(lease, 2 * kOneSample);
  lease.take(kOneSample);
  EXPECT_FALSE(lease.has_delivery());
  lease.abandon();
  ASSERT_TRUE(lease.has_delivery());
  const Delivery delivery = lease.take_batch();
  EXPECT_EQ(items_of(delivery), (std::vector<WorkItem>{{kTileA, {0, 2}}}));
  EXPECT_TRUE(delivery.lease_finished);
  lease.delivered();
  EXPECT_TRUE(lease.empty());
}

TEST(HeldLease, AMessageStaysSmall) {
  std::vector<WorkItem> items;
  for (int x = 0; x < 100; ++x) items.push_back({{64 * x, 0, 64 * x + 64, 64}, {0, 1}});
  HeldLease lease(1, "job", items);
  while (lease.has_todo()) render_next(lease, kOneSample);
  std::size_t tiles = 0;
  int messages = 0;
  for (bool finished = false; !finished; ++messages) {
    const Delivery delivery = lease.take_batch();
    EXPECT_LE(delivery.tiles.size() * 64 * 64 * 48, std::size_t{2} << 20);
    tiles += delivery.tiles.size();
    finished = delivery.lease_finished;
    lease.delivered();
  }
  EXPECT_EQ(tiles, 100u);
  EXPECT_EQ(messages, 10);
}

}  // namespace
}  // namespace tessera::worker
