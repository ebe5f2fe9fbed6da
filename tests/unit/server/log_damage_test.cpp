// SPDX-License-Identifier: Apache-2.0
#include "server/store/log_damage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/job_store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::store {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

// The log after a crash that followed a job and three checkpoints. Just before the last checkpoint the job
// was changed, which takes one page.
class LogDamage : public testing::Test {
 protected:
  LogDamage() {
    const auto file = folder_.path() / "tessera.db";
    auto store = *JobStore::open(file);
    JobRow row;
    row.id = "a";
    row.revision = row.state = 1;
    row.spp = 4;
    EXPECT_TRUE(store.insert_job(row));
    for (int tile = 0; tile < 3; ++tile) {
      if (tile == 2) {
        ++row.revision;
        EXPECT_TRUE(store.update_job(row));
      }
      EXPECT_TRUE(store.write_tiles({{"a", tile, {{0, 4}}, std::string(100'000, 'x')}}));
    }
    whole_ = read_file(log_of(file));
  }

  static constexpr std::size_t kFrame = 24 + 16384;

  LogFindings look_at(const std::string& bytes) {
    write_file(log_, bytes);
    return *look_at_log(log_);
  }
  std::size_t begin_of_last_transaction() const {
    std::size_t at = whole_.size() - kFrame;  // a commit frame; so is the frame before the first
    while (!commits(at - kFrame)) at -= kFrame;
    return at;
  }
  bool commits(std::size_t frame) const { return whole_.substr(frame + 4, 4) != std::string(4, '\0'); }
  // The transaction of one page.
  std::size_t begin_of_last_but_one() const {
    const std::size_t at = begin_of_last_transaction() - kFrame;
    EXPECT_TRUE(commits(at) && commits(at - kFrame));
    return at;
  }
  std::optional<std::string> damage_of(const std::string& bytes) { return look_at(bytes).damage; }
  static std::string flipped(std::string bytes, std::size_t at) {
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    return bytes;
  }

  const TemporaryFolder folder_;
  const std::filesystem::path log_ = folder_.path() / "log";
  std::string whole_;
};

TEST_F(LogDamage, AWholeLogHasNone) {
  EXPECT_EQ(damage_of(whole_), std::nullopt);
  EXPECT_EQ(damage_of(""), std::nullopt);
  EXPECT_EQ(look_at_log(folder_.path() / "nowhere")->damage, std::nullopt);
  EXPECT_FALSE(look_at(whole_).torn_end);
}

TEST_F(LogDamage, OneBitIsNoticedWhereverLaterTransactionsWouldBeForgotten) {
  const std::size_t of_one_page = begin_of_last_but_one();
  for (const std::size_t at :
       {std::size_t{0}, std::size_t{9}, std::size_t{17}, std::size_t{31}, 32 + std::size_t{1},
        32 + std::size_t{9}, 32 + std::size_t{20}, 32 + std::size_t{24} + 5000, 32 + kFrame + 70,
        of_one_page + 1, of_one_page + 9, of_one_page + 20, of_one_page + 24 + 5000}) {
    const auto damage = damage_of(flipped(whole_, at));
    ASSERT_TRUE(damage) << at;
    EXPECT_THAT(*damage, HasSubstr(log_.string() + " is damaged"));
  }
}

// With other salts it might be from an earlier log, if the frames before or after it did not show otherwise.
TEST_F(LogDamage, ATransactionOfOnePageIsMissedWhoseSaltsAreDamaged) {
  const std::size_t at = begin_of_last_but_one();
  for (const std::size_t more : {at + 1, at + 24 + 5000})
    EXPECT_TRUE(damage_of(flipped(flipped(whole_, at + 9), more))) << more - at;
}

// The last transaction is acknowledged only when it is complete.
TEST_F(LogDamage, WhatACrashToreAtTheEndIsNone) {
  for (const std::string& torn :
       {whole_.substr(0, whole_.size() - 5), whole_.substr(0, whole_.size() - kFrame),
        whole_.substr(0, whole_.size() - 40'000)}) {
    const LogFindings found = look_at(torn);
    EXPECT_EQ(found.damage, std::nullopt);
    EXPECT_THAT(found.torn_end, testing::Optional(EndsWith("as a crash may leave it")));
  }
}

// By the disk, or by the machine's crash: neither can be told apart, nor whether the damaged page was of this
// transaction or of one before it.
TEST_F(LogDamage, AnEndThatIsThereWithoutItsBeginMayBeLostWork) {
  std::string wiped = whole_;
  wiped.replace(begin_of_last_but_one(), kFrame, kFrame, '\0');
  for (const std::string& broken :
       {wiped, flipped(whole_, whole_.size() - 40'000), flipped(whole_, whole_.size() - 1),
        flipped(whole_, begin_of_last_transaction() + 9)}) {
    const LogFindings found = look_at(broken);
    EXPECT_EQ(found.damage, std::nullopt);
    EXPECT_THAT(found.torn_end, testing::Optional(HasSubstr("or a damaged disk")));
  }
  EXPECT_THAT(look_at(wiped).torn_end, testing::Optional(HasSubstr(std::to_string(begin_of_last_but_one()))));
}

// A restarted log is not truncated: old frames follow its end.
TEST_F(LogDamage, WhatIsLeftFromBeforeIsNoTornEnd) {
  std::string before = whole_;
  for (std::size_t at = 32; at < before.size(); at += kFrame) before[at + 8] ^= 1;
  const LogFindings found = look_at(whole_ + before.substr(32));
  EXPECT_EQ(found.damage, std::nullopt);
  EXPECT_FALSE(found.torn_end);
}

}  // namespace
}  // namespace tessera::store
