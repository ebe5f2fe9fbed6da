// SPDX-License-Identifier: Apache-2.0
// The index chooses the job that choose_job() chooses of all.
#include "server/scheduler/job_index.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <vector>

#include "server/scheduler/policy.hpp"

namespace tessera::scheduler {
namespace {

using Place = JobIndex::Place;

// The same by looking at every job.
class Model {
 public:
  void set(JobNumber job, const std::optional<Place>& place) {
    if (place) {
      places_[job] = *place;
    } else {
      places_.erase(job);
    }
  }
  std::optional<JobNumber> first(double virtual_time, IdentityNumber identity,
                                 const std::set<JobNumber>& refused) const {
    std::vector<JobNumber> jobs;
    std::vector<JobSnapshot> snapshots;
    for (const auto& [job, place] : places_) {
      if (refused.contains(job) || is_excluded(place, identity)) continue;
      jobs.push_back(job);
      snapshots.push_back({place.priority, std::max(virtual_time, place.virtual_finish), place.last_served});
    }
    return jobs.empty() ? std::nullopt : std::optional(jobs[choose_job(snapshots)]);
  }
  // The jobs that may be asked about before that one is found.
  std::vector<JobNumber> order(double virtual_time, IdentityNumber identity) const {
    std::vector<JobNumber> order;
    std::set<JobNumber> before;
    while (const auto next = first(virtual_time, identity, before)) {
      order.push_back(*next);
      before.insert(*next);
    }
    return order;
  }

 private:
  static bool is_excluded(const Place& place, IdentityNumber identity) {
    return identity != kNoIdentity && place.excluded == identity;
  }
  std::map<JobNumber, Place> places_;
};

// Few different values, so that there are many ties.
Place random_place(std::mt19937& rng, std::uint64_t& servings) {
  return {.priority = static_cast<int>(rng() % 3),
          .virtual_finish = static_cast<double>(rng() % 8),
          .last_served = rng() % 3 == 0 ? 0 : ++servings,
          .excluded = static_cast<IdentityNumber>(rng() % 4)};
}

void walk_index(std::uint32_t seed) {
  std::mt19937 rng(seed);
  JobIndex index;
  Model model;
  std::uint64_t servings = 0;
  const unsigned jobs = 1 + rng() % 40;
  for (int step = 0; step < 200; ++step) {
    const JobNumber job = 1 + rng() % jobs;
    std::optional<Place> place;
    if (rng() % 4 != 0) place = random_place(rng, servings);
    index.set(job, place);
    model.set(job, place);
    ASSERT_EQ(index.place_of(job), place);

    std::set<JobNumber> refused;
    for (JobNumber each = 1; each <= jobs; ++each)
      if (rng() % 3 == 0) refused.insert(each);
    const auto virtual_time = static_cast<double>(rng() % 9);
    const auto identity = static_cast<IdentityNumber>(rng() % 4);
    std::vector<JobNumber> asked;
    const auto found = index.first(virtual_time, identity, [&](JobNumber each) {
      asked.push_back(each);
      return !refused.contains(each);
    });
    ASSERT_EQ(found, model.first(virtual_time, identity, refused)) << "seed " << seed << " step " << step;
    std::vector<JobNumber> order = model.order(virtual_time, identity);
    ASSERT_LE(asked.size(), order.size());
    order.resize(asked.size());
    ASSERT_EQ(asked, order) << "seed " << seed << " step " << step;
  }
}

TEST(JobIndex, AgreesWithAChoiceAmongAllThroughRandomChanges) {
  for (std::uint32_t seed = 0; seed < 60 && !testing::Test::HasFatalFailure(); ++seed) walk_index(seed);
}

TEST(JobIndex, AsksAboutNoJobThatExcludesTheIdentity) {
  JobIndex index;
  for (JobNumber job = 1; job <= 1000; ++job) index.set(job, Place{.last_served = job, .excluded = 1});
  index.set(1001, Place{.last_served = 1001, .excluded = 2});
  for (const double virtual_time : {-1.0, 1.0}) {
    int asked = 0;
    EXPECT_EQ(index.first(virtual_time, 1, [&](JobNumber) { return ++asked > 0; }), 1001u);
    EXPECT_EQ(asked, 1);
  }
}

TEST(JobIndex, IsEmptyWhenTheLastJobIsRemoved) {
  JobIndex index;
  EXPECT_TRUE(index.empty());
  index.set(7, Place{.priority = 3});
  EXPECT_FALSE(index.empty());
  index.set(7, std::nullopt);
  index.set(8, std::nullopt);
  EXPECT_TRUE(index.empty());
  EXPECT_EQ(index.first(0, kNoIdentity, [](JobNumber) { return true; }), std::nullopt);
}

}  // namespace
}  // namespace tessera::scheduler
