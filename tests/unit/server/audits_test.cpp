// SPDX-License-Identifier: Apache-2.0
// The coordinator's handling of results with wrong bits and valid checksums.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <limits>
#include <map>

#include "proto/convert.hpp"
#include "proto/tile_codec.hpp"
#include "server/film/fingerprinter.hpp"
#include "server/film/plausible.hpp"
#include "server/film/tile_provenance.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

// Flips one bit of one sum, with a matching checksum.
void flip_a_bit(v1::RenderedItem& item) {
  auto tile = proto::decode_tile(item);
  tile->sums[5] ^= 1u << 20;
  if (tile->range.odd_count() == tile->range.count()) tile->odd_sums[5] = tile->sums[5];
  item = proto::encode_tile(*tile);
}

class Audits : public ScriptedFarm {
 protected:
  Audits() {
    audit_share_ = 1;
    open();
  }

  // Renders one lease. Returns whether there was one.
  bool render(char worker, bool lies = false) {
    const WaitingCall call(coordinator(), greeting(worker));
    if (!call.answered() || !call.answer() || call.answer()->leases().empty()) return false;
    v1::SubmitResultRequest result = delivery(worker, call.answer()->leases(0));
    last_results_[worker] = result;
    if (lies) flip_a_bit(*result.mutable_items(0));
    deliver(result);
    return true;
  }
  void render_together(const std::string& workers, const std::string& id) {
    for (int rounds = 0; rounds < 100 && stored_job(id).state() == v1::JOB_STATE_RUNNING; ++rounds) {
      for (const char worker : workers) render(worker);
    }
    EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
  }
  std::map<char, v1::SubmitResultRequest> last_results_;  // of each worker

  v1::Worker worker(char id) {
    for (const auto& each : coordinator().dispatcher().workers()) {
      if (each.id() == std::string(32, id)) return each;
    }
    return {};
  }
  void expect_local_image(const std::string& id) {
    EXPECT_TRUE(coordinator().images().get(id)->image.pixels ==
                ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
    EXPECT_EQ(job(id).counters().samples(), kSamples);
  }
};

TEST_F(Audits, WithoutForgedResultsLeaveTheImageUnchanged) {
  const std::string id = submit();
  render('a');
  EXPECT_GT(job(id).samples_to_verify(), 0u);
  render_together("ab", id);
  expect_local_image(id);
  EXPECT_EQ(job(id).samples_to_verify(), 0u);
  EXPECT_GT(worker('a').audited_ranges(), 0u);
  EXPECT_EQ(worker('a').disproved_ranges(), 0u);
}

TEST_F(Audits, QuarantineAForgingWorkerAndRenderItsTileAgain) {
  const std::string id = submit();
  ASSERT_TRUE(render('a', true));
  render_together("bc", id);
  expect_local_image(id);
  const auto liar = worker('a');
  EXPECT_TRUE(liar.quarantined());
  EXPECT_EQ(liar.disproved_ranges(), 1u);
  EXPECT_THAT(liar.quarantine_reason(), HasSubstr("it rendered different bits of samples [0, 1) of tile 0"));
  EXPECT_THAT(liar.quarantine_reason(), HasSubstr("than host-b and host-c"));
  const WaitingCall call(coordinator(), greeting('a'));
  ASSERT_TRUE(call.answered());
  EXPECT_EQ(call.answer().error().code, ErrorCode::kFailedPrecondition);
  EXPECT_THAT(call.answer().error().message,
              HasSubstr("worker host-a is quarantined: it rendered different bits"));
}

// A worker that could recognise an audit would be honest in it.
TEST_F(Audits, LookLikeOtherWork) {
  submit();
  render('a');
  const v1::Lease lease = synchronize(greeting('b')).leases(0);
  const auto counted = deliver(delivery('b', lease));
  EXPECT_EQ(counted.accepted_items(), static_cast<std::uint32_t>(lease.items_size()));
  EXPECT_EQ(counted.dropped_items(), 0u);
}

TEST_F(Audits, GoOnAfterARestart) {
  const std::string id = submit();
  ASSERT_TRUE(render('a', true));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  audit_share_ = 0;
  open();
  EXPECT_GT(job(id).samples_to_verify(), 0u);
  render_together("bc", id);
  expect_local_image(id);
  EXPECT_EQ(coordinator().dispatcher().workers()[0].quarantined(), false);
}

TEST_F(Audits, AreNotRepeatedForWhatWasConfirmed) {
  const std::string id = submit();
  render('a');
  const std::uint64_t due = job(id).samples_to_verify();
  render('b');
  EXPECT_LT(job(id).samples_to_verify(), due);
  const std::uint64_t left = job(id).samples_to_verify();
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  EXPECT_EQ(job(id).samples_to_verify(), left);
}

class WithoutAudits : public Audits {
 protected:
  WithoutAudits() {
    audit_share_ = 0;
    open();
  }
  // Has three results rejected.
  void quarantined(char worker) {
    v1::SubmitResultRequest lie = last_results_.at(worker);
    *lie.add_items() = {};
    for (int i = 0; i < farm::Quarantine::kRejectionsUntilQuarantine; ++i)
      EXPECT_FALSE(coordinator().dispatcher().submit_result(lie));
    EXPECT_TRUE(this->worker(worker).quarantined());
    EXPECT_EQ(this->worker(worker).quarantine_reason(), "3 of its results in a row were rejected");
  }
};

TEST_F(WithoutAudits, SamplesFromBeforeAQuarantineAreVerified) {
  const std::string id = submit();
  ASSERT_TRUE(render('a', true));
  EXPECT_EQ(job(id).samples_to_verify(), 0u);
  quarantined('a');
  EXPECT_GT(job(id).samples_to_verify(), 0u);
  render_together("bc", id);
  expect_local_image(id);
}

TEST_F(WithoutAudits, ADoneJobRunsAgainWhetherItsFilmIsStoredOrNot) {
  for (const bool stored : {false, true}) {
    const char liar = stored ? 'd' : 'a';
    const std::string id = submit();
    ASSERT_TRUE(render(liar, true));
    render_together("bc", id);
    EXPECT_FALSE(coordinator().images().get(id)->image.pixels ==
                 ready_made_image(kWidthPx, kHeightPx, kSpp).pixels);
    if (stored) {
      ASSERT_TRUE(coordinator().checkpointer().checkpoint());
    }
    quarantined(liar);
    coordinator().jobs().reopen();
    EXPECT_EQ(job(id).state(), v1::JOB_STATE_RUNNING);
    EXPECT_FALSE(job(id).has_finished_at());
    render_together("bc", id);
    expect_local_image(id);
    ASSERT_TRUE(coordinator().checkpointer().checkpoint());
    expect_local_image(id);
  }
}

TEST_F(WithoutAudits, WhatIsToBeVerifiedIsKnownAfterARestart) {
  const std::string id = submit();
  ASSERT_TRUE(render('a', true));
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  quarantined('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  open();
  EXPECT_GT(job(id).samples_to_verify(), 0u);
  render_together("bc", id);
  expect_local_image(id);
}

// As after a salvage, when old fingerprints cannot be compared with new ones.
TEST_F(WithoutAudits, WhatWasToBeVerifiedIsRenderedAgainWhereTheSecretIsLost) {
  const std::string id = submit();
  ASSERT_TRUE(render('a', true));
  quarantined('a');
  ASSERT_TRUE(coordinator().checkpointer().checkpoint());
  coordinator_.reset();
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder_.path() / "state" / "tessera.db").c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "UPDATE meta SET value = value + 1 WHERE name = 'secret_0'", nullptr,
                         nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  open();
  EXPECT_EQ(job(id).samples_to_verify(), 0u);
  EXPECT_EQ(job(id).samples_done(), 0u);
  render_together("bc", id);
  expect_local_image(id);
}

core::FilmTile some_tile(core::SampleRange range) {
  return ready_made_tile({64, 64, 128, 100}, range);
}

TEST(FingerprinterTest, PartsAddUpToTheWhole) {
  const film::Fingerprinter fingerprinter({1, 2});
  scheduler::Fingerprint parts = fingerprinter.of(some_tile({3, 4}));
  parts.add(fingerprinter.of(some_tile({4, 9})));
  parts.add(fingerprinter.of(some_tile({9, 17})));
  const scheduler::Fingerprint whole = fingerprinter.of(some_tile({3, 17}));
  EXPECT_TRUE(same_sums(parts, whole));
  EXPECT_GE(parts.largest, whole.largest);
}

TEST(FingerprinterTest, EverySumCountsAndTheSecretAsWell) {
  const film::Fingerprinter fingerprinter({1, 2}), other({1, 3});
  const core::FilmTile tile = some_tile({0, 4});
  const scheduler::Fingerprint right = fingerprinter.of(tile);
  EXPECT_FALSE(same_sums(right, other.of(tile)));
  EXPECT_EQ(right, film::Fingerprinter({1, 2}).of(tile));
  for (std::size_t i = 0; i < tile.sums.size(); i += 97) {
    for (const int bit : {0, 31, 63}) {
      core::FilmTile wrong = tile;
      wrong.sums[i] ^= std::uint64_t{1} << bit;
      EXPECT_FALSE(same_sums(right, fingerprinter.of(wrong))) << i;
      wrong = tile;
      wrong.odd_sums[i] ^= std::uint64_t{1} << bit;
      EXPECT_FALSE(same_sums(right, fingerprinter.of(wrong))) << i;
    }
  }
}

TEST(FingerprinterTest, MarksSumsThatWereCutOff) {
  core::FilmTile tile = some_tile({0, 4});
  tile.sums[7] = core::kFilmSaturated;
  EXPECT_EQ(film::Fingerprinter({1, 2}).of(tile).largest, std::numeric_limits<float>::infinity());
}

TEST(TileProvenanceTest, ComesBackFromTheStore) {
  const film::Produced provenance{
      7,
      {{{3, {0, 2}}, {"name", {"worker"}, "machine"}, {1, 2, 3}, scheduler::Due::kNo},
       {{3, {2, 5}}, {"name", {"worker"}, "machine"}, {4, 5, 6}, scheduler::Due::kDoubted}}};
  auto stored = film::to_stored(provenance);
  EXPECT_EQ(stored.producers_size(), 1);
  const auto read = film::from_stored(3, stored);
  EXPECT_EQ(read.fingerprinter, 7u);
  EXPECT_EQ(read.items, provenance.items);
  stored.mutable_ranges(0)->set_producer(9);
  stored.mutable_ranges(1)->set_due(77);
  EXPECT_TRUE(film::from_stored(3, stored).items.empty());
}

struct Impossible {
  const char* name;
  core::SampleRange range;
  void (*spoil)(core::FilmTile&);
  const char* says;
};

class Plausibility : public testing::TestWithParam<Impossible> {};

TEST_P(Plausibility, IsRequired) {
  core::FilmTile tile = some_tile(GetParam().range);
  ASSERT_TRUE(film::check_plausible(tile));
  GetParam().spoil(tile);
  const core::Status refused = film::check_plausible(tile);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(refused.error().message, HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    Results, Plausibility,
    testing::Values(
        Impossible{"MoreInTheOddOnesThanInAll",
                   {0, 4},
                   [](auto& tile) { tile.odd_sums[3] = tile.sums[3] + 1; },
                   "which cannot be"},
        Impossible{
            "OddOnesWhereThereAreNone", {2, 3}, [](auto& tile) { tile.odd_sums[3] = 1; }, "0 odd-numbered"},
        Impossible{
            "EvenOnesWhereThereAreNone", {3, 4}, [](auto& tile) { tile.sums[3] += 1; }, "1 odd-numbered"},
        Impossible{"SaturatedWithoutATrace",
                   {0, 4},
                   [](auto& tile) { tile.counters.saturated_samples = 1; },
                   "saturated_samples"},
        Impossible{"NotANumberAndYetLight",
                   {0, 4},
                   [](auto& tile) {
                     tile.counters.non_finite_samples = tile.counters.samples;
                     tile.counters.first_non_finite = core::SampleId{64, 64, 0};
                   },
                   "not black"},
        Impossible{"NotANumberNowhere",
                   {0, 4},
                   [](auto& tile) { tile.counters.non_finite_samples = 1; },
                   "first_non_finite"},
        Impossible{"NotANumberElsewhere",
                   {0, 4},
                   [](auto& tile) {
                     tile.counters.non_finite_samples = 1;
                     tile.counters.first_non_finite = core::SampleId{64, 64, 4};
                   },
                   "no sample of this item"}),
    [](const auto& impossible) { return impossible.param.name; });

}  // namespace
}  // namespace tessera::server
