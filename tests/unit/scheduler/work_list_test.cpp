// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/work_list.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace tessera::scheduler {
namespace {

using core::SampleRange;

JobShape shape_of(int tiles, std::uint32_t spp, int images = 1) {
  return {tiles * core::kTilePx, core::kTilePx, spp, images};
}

// A list in which everything is wanted except what was taken and not put back.
class Farm {
 public:
  Farm(int tiles, std::uint32_t spp) : Farm(shape_of(tiles, spp)) {}
  explicit Farm(const JobShape& shape)
      : shape_(shape), work_(shape), taken_(static_cast<std::size_t>(shape.grid().tile_count())) {}

  std::optional<WorkItem> next() const { return WorkList::Walk(work_).next(wanted()); }
  WorkItem take(std::uint32_t count) {
    const WorkItem piece = *next();
    return take({piece.tile, {piece.samples.begin, piece.samples.begin + count}});
  }
  WorkItem take(const WorkItem& item) {
    taken_of(item).add(item.samples);
    work_.forget_unwanted(wanted());
    return item;
  }
  void put_back(const WorkItem& item) {
    taken_of(item).remove(item.samples);
    work_.put_back(item);
  }
  void extend(std::uint32_t spp, const std::vector<TileTarget>& tiles = {}) {
    shape_.raise(spp, tiles);
    work_.extend(shape_);
  }
  std::vector<WorkItem> drain() {
    std::vector<WorkItem> order;
    while (const auto piece = next()) order.push_back(take(*piece));
    return order;
  }

 private:
  IntervalSet& taken_of(const WorkItem& item) { return taken_[static_cast<std::size_t>(item.tile)]; }
  WorkList::Wanted wanted() const {
    return [this](const WorkItem& item) {
      IntervalSet samples{item.samples};
      samples.remove(taken_[static_cast<std::size_t>(item.tile)]);
      return samples;
    };
  }

  JobShape shape_;
  WorkList work_;
  std::vector<IntervalSet> taken_;
};

TEST(PassOf, CutsSamplesAtPowersOfTwo) {
  EXPECT_EQ(pass_of(0), (SampleRange{0, 1}));
  EXPECT_EQ(pass_of(1), (SampleRange{1, 2}));
  EXPECT_EQ(pass_of(2), (SampleRange{2, 4}));
  EXPECT_EQ(pass_of(3), (SampleRange{2, 4}));
  EXPECT_EQ(pass_of(4), (SampleRange{4, 8}));
  EXPECT_EQ(pass_of((1u << 24) - 1), (SampleRange{1u << 23, 1u << 24}));
}

TEST(WorkList, GoesOverAllTilesInPassesOfOneOneTwoFour) {
  Farm farm(2, 6);
  EXPECT_EQ(farm.drain(), (std::vector<WorkItem>{{0, {0, 1}},
                                                 {1, {0, 1}},
                                                 {0, {1, 2}},
                                                 {1, {1, 2}},
                                                 {0, {2, 4}},
                                                 {1, {2, 4}},
                                                 {0, {4, 6}},
                                                 {1, {4, 6}}}));
}

TEST(WorkList, ResumesAPieceWhereItWasCut) {
  Farm farm(1, 8);
  for (const std::uint32_t count : {1, 1, 2, 3}) farm.take(count);
  EXPECT_EQ(farm.drain(), (std::vector<WorkItem>{{0, {7, 8}}}));
}

TEST(WorkList, GivesWhatCameBackFirstAndEarlierPassesBeforeLaterOnes) {
  Farm farm(3, 8);
  for (int i = 0; i < 9; ++i) farm.take(1);  // the cursor is at sample 3 of tile 1
  farm.put_back({0, {1, 4}});
  farm.put_back({2, {0, 1}});
  const std::vector<WorkItem> order = farm.drain();
  EXPECT_EQ(std::vector<WorkItem>(order.begin(), order.begin() + 4),
            (std::vector<WorkItem>{{2, {0, 1}}, {0, {1, 2}}, {0, {2, 4}}, {1, {3, 4}}}));
}

TEST(WorkList, OffersNothingTwiceThatCameBackWithoutHavingBeenTaken) {
  Farm farm(3, 8);
  const std::vector<WorkItem> order = farm.drain();
  Farm again(3, 8);
  for (int i = 0; i < 4; ++i) again.take(1);  // the cursor is at sample 1 of tile 1
  for (int tile = 0; tile < 3; ++tile) again.put_back({tile, {0, 8}});
  EXPECT_EQ(again.drain(), order);
  again.extend(9);
  again.put_back({0, {4, 9}});
  again.extend(16);
  EXPECT_EQ(again.drain(), (std::vector<WorkItem>{{0, {4, 8}}, {0, {8, 16}}, {1, {8, 16}}, {2, {8, 16}}}));
}

TEST(WorkList, OffersTheRestOfAShortPassAfterItIsExtended) {
  Farm farm(2, 6);
  farm.drain();
  farm.extend(12);
  EXPECT_EQ(farm.drain(), (std::vector<WorkItem>{{0, {6, 8}}, {1, {6, 8}}, {0, {8, 12}}, {1, {8, 12}}}));
}

TEST(WorkList, IsUnchangedByIteration) {
  Farm farm(2, 8);
  for (int i = 0; i < 6; ++i) farm.take(1);
  farm.put_back({1, {0, 1}});
  const auto first = farm.next();
  ASSERT_EQ(first, (WorkItem{1, {0, 1}}));
  EXPECT_EQ(farm.next(), first);
}

TEST(WorkList, GoesThroughAllPassesOfAnImageBeforeTheNext) {
  Farm farm(shape_of(2, 2, 2));
  EXPECT_EQ(farm.drain(), (std::vector<WorkItem>{{0, {0, 1}},
                                                 {1, {0, 1}},
                                                 {0, {1, 2}},
                                                 {1, {1, 2}},
                                                 {2, {0, 1}},
                                                 {3, {0, 1}},
                                                 {2, {1, 2}},
                                                 {3, {1, 2}}}));
}

TEST(WorkList, OffersWhatCameBackAtItsPlaceAmongTheImages) {
  Farm farm(shape_of(1, 2, 3));
  for (int i = 0; i < 4; ++i) farm.take(1);  // the cursor is at the last image
  farm.put_back({1, {0, 1}});
  farm.put_back({0, {1, 2}});
  EXPECT_EQ(farm.drain(), (std::vector<WorkItem>{{0, {1, 2}}, {1, {0, 1}}, {2, {0, 1}}, {2, {1, 2}}}));
}

TEST(WorkList, OffersTheSamplesOfAnExtensionAfterThoseOfAllImages) {
  Farm farm(shape_of(1, 1, 2));
  farm.take(1);
  farm.extend(2);
  farm.extend(3);
  EXPECT_EQ(farm.drain(),
            (std::vector<WorkItem>{{1, {0, 1}}, {0, {1, 2}}, {0, {2, 3}}, {1, {1, 2}}, {1, {2, 3}}}));
}

TEST(WorkList, GivesATileAsManySamplesAsItsTarget) {
  JobShape shape = shape_of(3, 2);
  shape.targets = TileTargets({{0, 1}, {2, 4}});
  Farm farm(shape);
  EXPECT_EQ(farm.drain(), (std::vector<WorkItem>{
                              {0, {0, 1}}, {1, {0, 1}}, {2, {0, 1}}, {1, {1, 2}}, {2, {1, 2}}, {2, {2, 4}}}));
  farm.extend(0, {{1, 3}});
  EXPECT_EQ(farm.drain(), (std::vector<WorkItem>{{1, {2, 3}}}));
  farm.extend(4);
  EXPECT_EQ(farm.drain(), (std::vector<WorkItem>{{0, {1, 2}}, {0, {2, 4}}, {1, {3, 4}}}));
}

// The model: a bitmap of the free samples for each tile.
class Bitmap {
 public:
  explicit Bitmap(const JobShape& shape) : free_(static_cast<std::size_t>(shape.grid().tile_count())) {
    extend(shape);
  }

  void set(const WorkItem& item, bool free) {
    auto& tile = free_[static_cast<std::size_t>(item.tile)];
    std::fill(tile.begin() + item.samples.begin, tile.begin() + item.samples.end, free);
  }
  void extend(const JobShape& shape) {
    for (int tile = 0; tile < shape.grid().tile_count(); ++tile)
      free_[static_cast<std::size_t>(tile)].resize(shape.target(tile), true);
  }
  IntervalSet free_of(const WorkItem& item) const {
    IntervalSet set;
    const auto& tile = free_[static_cast<std::size_t>(item.tile)];
    for (std::uint32_t s = item.samples.begin; s < item.samples.end; ++s) {
      if (tile[s]) set.add({s, s + 1});
    }
    return set;
  }
  std::uint64_t count() const {
    std::uint64_t count = 0;
    for (const auto& tile : free_)
      count += static_cast<std::uint64_t>(std::count(tile.begin(), tile.end(), true));
    return count;
  }

 private:
  std::vector<std::vector<bool>> free_;
};

std::uint32_t below(std::uint32_t end, std::mt19937& rng) {
  return static_cast<std::uint32_t>(rng() % end);
}

JobShape any_shape(std::mt19937& rng) {
  const int images = 1 + static_cast<int>(below(3, rng)), tiles = 1 + static_cast<int>(below(3, rng));
  JobShape shape = shape_of(tiles, 1 + below(40, rng), images);
  TileTargets::ByTile targets;
  for (std::uint32_t i = below(3, rng); i > 0; --i)
    targets.push_back(
        {static_cast<int>(below(static_cast<std::uint32_t>(tiles * images), rng)), 1 + below(60, rng)});
  shape.targets = TileTargets(std::move(targets));
  return shape;
}

// Randomly takes, puts back, takes elsewhere and extends. Exactly the samples that are free in the model must
// be offered in the end.
void walk(std::uint32_t seed) {
  std::mt19937 rng(seed);
  JobShape shape = any_shape(rng);
  const int tile_count = shape.grid().tile_count();
  const auto any_tile = [&] { return static_cast<int>(below(static_cast<std::uint32_t>(tile_count), rng)); };
  WorkList work(shape);
  Bitmap model(shape);
  std::vector<WorkItem> out;
  const auto wanted = [&](const WorkItem& item) { return model.free_of(item); };
  for (int step = 0; step < 150; ++step) {
    switch (rng() % 6) {
      default: {
        WorkList::Walk way(work);
        const auto piece = way.next(wanted);
        ASSERT_EQ(piece.has_value(), model.count() > 0) << "seed " << seed << " step " << step;
        if (!piece) break;
        ASSERT_EQ(model.free_of(*piece), (IntervalSet{piece->samples}));
        ASSERT_LE(piece->samples.end, pass_of(piece->samples.begin).end);
        const std::uint32_t count = 1 + rng() % piece->samples.count();
        out.push_back({piece->tile, {piece->samples.begin, piece->samples.begin + count}});
        model.set(out.back(), false);
        way.pass(*piece, count);
        const auto behind = way.next(wanted);
        work.forget_unwanted(wanted);
        ASSERT_EQ(behind, WorkList::Walk(work).next(wanted)) << "seed " << seed << " step " << step;
        break;
      }
      case 3: {  // puts back a part of what is taken; the rest is done
        if (out.empty()) break;
        const std::size_t which = rng() % out.size();
        WorkItem back = out[which];
        back.samples.begin += rng() % back.samples.count();
        out.erase(out.begin() + static_cast<std::ptrdiff_t>(which));
        work.put_back(back);
        model.set(back, true);
        break;
      }
      case 4: {  // a result for samples that were not leased
        const int tile = any_tile();
        const std::uint32_t target = shape.target(tile);
        const auto begin = static_cast<std::uint32_t>(rng() % target);
        const auto end = begin + static_cast<std::uint32_t>(rng() % (target - begin + 1));
        model.set({tile, {begin, end}}, false);
        break;
      }
      case 5:
        if (rng() % 8 != 0) break;
        shape.raise(below(2, rng) == 0 ? 0 : shape.spp + below(20, rng), {{any_tile(), 1 + below(80, rng)}});
        work.extend(shape);
        model.extend(shape);
        break;
    }
    for (int tile = 0; tile < tile_count; ++tile) {
      IntervalSet unreachable = model.free_of({tile, {0, shape.target(tile)}});
      unreachable.remove(work.candidates(tile));
      ASSERT_TRUE(unreachable.empty()) << "seed " << seed << " step " << step << " tile " << tile;
    }
  }
}

TEST(WorkList, AgreesWithABitmapThroughRandomWalks) {
  for (std::uint32_t seed = 0; seed < 500 && !testing::Test::HasFatalFailure(); ++seed) walk(seed);
}

}  // namespace
}  // namespace tessera::scheduler
