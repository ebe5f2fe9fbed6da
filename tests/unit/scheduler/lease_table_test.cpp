// SPDX-License-Identifier: Apache-2.0
// The table of leases agrees with a list of all leases.
#include "server/scheduler/lease_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

namespace tessera::scheduler {
namespace {

using core::SampleRange;

constexpr int kTiles = 3;
constexpr std::uint32_t kSamples = 24;

// Which leases have each sample.
using Holders = std::map<std::pair<int, std::uint32_t>, std::vector<LeaseId>>;

Holders holders_of(const LeaseTable& table) {
  Holders holders;
  for (const auto& [id, lease] : table.all()) {
    for (const WorkItem& item : lease.items) {
      for (std::uint32_t s = item.samples.begin; s < item.samples.end; ++s)
        holders[{item.tile, s}].push_back(id);
    }
  }
  return holders;
}

WorkItem random_item(std::mt19937& rng) {
  const auto begin = static_cast<std::uint32_t>(rng() % kSamples);
  return {static_cast<int>(rng() % kTiles), {begin, begin + 1 + static_cast<std::uint32_t>(rng() % 6)}};
}

void expect_agreement(const LeaseTable& table, const WorkItem& asked) {
  const Holders holders = holders_of(table);
  IntervalSet once, twice;
  std::vector<LeaseId> holding;
  for (std::uint32_t s = 0; s < kSamples + 6; ++s) {
    const auto found = holders.find({asked.tile, s});
    if (found == holders.end()) continue;
    once.add({s, s + 1});
    if (found->second.size() > 1) twice.add({s, s + 1});
    if (asked.samples.begin <= s && s < asked.samples.end)
      holding.insert(holding.end(), found->second.begin(), found->second.end());
  }
  std::sort(holding.begin(), holding.end());
  holding.erase(std::unique(holding.begin(), holding.end()), holding.end());
  EXPECT_EQ(table.leased(asked.tile), once);
  EXPECT_EQ(table.leased_twice(asked.tile), twice);
  EXPECT_EQ(table.holding(asked), holding);
}

// Items of which no sample is in two leases already, or twice in this one.
std::vector<WorkItem> random_items(std::mt19937& rng, const LeaseTable& table) {
  std::vector<WorkItem> items;
  for (unsigned i = rng() % 5; i > 0; --i) {
    const WorkItem item = random_item(rng);
    const bool overlaps = std::any_of(items.begin(), items.end(), [&](const WorkItem& other) {
      return other.tile == item.tile && IntervalSet{other.samples}.intersects(item.samples);
    });
    if (!overlaps && !table.leased_twice(item.tile).intersects(item.samples)) items.push_back(item);
  }
  return items;
}

void walk_leases(std::uint32_t seed) {
  std::mt19937 rng(seed);
  LeaseTable table;
  std::uint64_t last = 0;
  for (int step = 0; step < 200; ++step) {
    const auto any = [&] {
      return std::next(table.all().begin(), static_cast<std::ptrdiff_t>(rng() % table.all().size()))->first;
    };
    switch (rng() % 4) {
      case 0:
        if (!table.all().empty()) table.end(any(), LeaseState::kReturned);
        break;
      case 1:
        for (const Lease& ended : table.trim(random_item(rng))) EXPECT_EQ(ended.state, LeaseState::kDone);
        break;
      case 2:
        if (!table.all().empty()) table.trim(any(), random_item(rng));
        break;
      default:
        if (auto items = random_items(rng, table); !items.empty())
          table.insert({{++last}, {"worker"}, std::move(items)});
        break;
    }
    expect_agreement(table, random_item(rng));
    ASSERT_FALSE(testing::Test::HasFailure()) << "seed " << seed << " step " << step;
  }
}

TEST(LeaseTable, AgreesWithAListOfLeasesThroughRandomChanges) {
  for (std::uint32_t seed = 0; seed < 200 && !testing::Test::HasFailure(); ++seed) walk_leases(seed);
}

}  // namespace
}  // namespace tessera::scheduler
