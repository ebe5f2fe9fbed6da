// SPDX-License-Identifier: Apache-2.0
// The log of changes: in order, compacted, and readable from any cursor.
#include "server/events/event_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace tessera::events {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::size_t kAll = 1000;

std::vector<std::string> ids(const EventLog::Page& page) {
  std::vector<std::string> result;
  for (const Subject& subject : page.subjects) result.push_back(subject.id);
  return result;
}

TEST(EventLog, HasTheLastChangeOfEachSubjectInOrder) {
  EventLog log(1);
  log.append(SubjectKind::kJob, "a");
  log.append(SubjectKind::kWorker, "a");
  const Revision b = log.append(SubjectKind::kJob, "b");
  const Revision a = log.append(SubjectKind::kJob, "a");
  EXPECT_GT(a, b);
  const EventLog::Page page = log.read({}, kAll);
  EXPECT_THAT(page.subjects, ElementsAre(Subject{SubjectKind::kWorker, "a"}, Subject{SubjectKind::kJob, "b"},
                                         Subject{SubjectKind::kJob, "a"}));
  EXPECT_TRUE(page.is_last);
  EXPECT_EQ(page.next.revision, a);
}

TEST(EventLog, IsReadInPages) {
  EventLog log(1);
  for (const char* const id : {"a", "b", "c", "d", "e"}) log.append(SubjectKind::kJob, id);
  const EventLog::Page first = log.read({}, 2);
  EXPECT_THAT(ids(first), ElementsAre("a", "b"));
  EXPECT_TRUE(first.reset) << "a new reader knows nothing";
  EXPECT_FALSE(first.is_last);
  log.append(SubjectKind::kJob, "c");  // moves behind the others
  const EventLog::Page second = log.read(first.next, 2);
  EXPECT_THAT(ids(second), ElementsAre("d", "e"));
  EXPECT_FALSE(second.reset);
  const EventLog::Page third = log.read(second.next, 2);
  EXPECT_THAT(ids(third), ElementsAre("c"));
  EXPECT_TRUE(third.is_last);
  EXPECT_THAT(ids(log.read(third.next, 2)), IsEmpty());
}

TEST(EventLog, OfALaterRunResetsEarlierCursors) {
  EventLog before(1), after(2);
  before.append(SubjectKind::kJob, "a");
  const Cursor cursor = before.read({}, kAll).next;
  EXPECT_TRUE(after.read(cursor, kAll).reset) << "also while it is empty";
  const Revision again = after.append(SubjectKind::kJob, "a");
  EXPECT_GT(again, cursor.revision);
  const EventLog::Page page = after.read(cursor, kAll);
  EXPECT_TRUE(page.reset);
  EXPECT_THAT(ids(page), ElementsAre("a"));
  EXPECT_FALSE(after.read(page.next, kAll).reset);
}

TEST(EventLog, ForgetsTheOldestOfThoseThatHaveEnded) {
  EventLog log(1, 2);
  log.append(SubjectKind::kJob, "runs");
  const Cursor early = log.read({}, kAll).next;
  for (const char* const id : {"a", "b"}) log.append_end(SubjectKind::kJob, id);
  EXPECT_FALSE(log.read(early, kAll).reset);
  log.append(SubjectKind::kJob, "a");  // it was extended, and has not ended any more
  log.append_end(SubjectKind::kJob, "c");
  EXPECT_THAT(ids(log.read({}, kAll)), ElementsAre("runs", "b", "a", "c"));
  const Cursor late = log.read({}, kAll).next;
  log.append_end(SubjectKind::kJob, "d");
  EXPECT_THAT(ids(log.read({}, kAll)), ElementsAre("runs", "a", "c", "d"));
  EXPECT_TRUE(log.read(early, kAll).reset) << "it has not seen the end of b";
  EXPECT_FALSE(log.read(late, kAll).reset);
}

// A reader that is at the start again reads to the end, though all of what it reads is older than what was
// forgotten.
TEST(EventLog, IsReadInPagesAfterAReset) {
  EventLog log(1, 0);
  for (const char* const id : {"a", "b", "c"}) log.append(SubjectKind::kJob, id);
  log.append_end(SubjectKind::kJob, "gone");
  std::vector<std::string> read;
  Cursor cursor;
  for (int pages = 0; pages < 10; ++pages) {
    const EventLog::Page page = log.read(cursor, 1);
    EXPECT_EQ(page.reset, pages == 0);
    for (const std::string& id : ids(page)) read.push_back(id);
    cursor = page.next;
    if (page.is_last) break;
  }
  EXPECT_THAT(read, ElementsAre("a", "b", "c"));
  EXPECT_FALSE(log.read(cursor, 1).reset);
  log.append_end(SubjectKind::kJob, "also gone");
  EXPECT_TRUE(log.read(cursor, 1).reset) << "it may know what is gone";
}

TEST(EventLog, WaitsForAChangeOrAWake) {
  EventLog log(1);
  const Cursor cursor{log.append(SubjectKind::kJob, "a"), 0};
  std::atomic<int> returned{0};
  std::thread reader([&] {
    log.wait(cursor, 0);
    ++returned;
    log.wait(log.read(cursor, kAll).next, 0);
    ++returned;
  });
  log.append(SubjectKind::kJob, "b");
  while (returned == 0) std::this_thread::yield();
  log.wake();
  reader.join();
  EXPECT_EQ(returned, 2);
  log.wait(log.read({}, kAll).next, 0);  // a wake that came before is not lost
}

// Whatever is appended while it is read, a reader sees every subject.
TEST(EventLog, HidesNothingFromAConcurrentReader) {
  EventLog log(1);
  std::thread writer([&] {
    for (int i = 0; i < 20000; ++i) log.append(SubjectKind::kJob, std::to_string(i % 97));
    log.append(SubjectKind::kJob, "last");
  });
  std::set<std::string> seen;
  Cursor cursor;
  while (!seen.contains("last")) {
    const EventLog::Page page = log.read(cursor, 5);
    EXPECT_LE(page.subjects.size(), 5u);
    cursor = page.next;
    for (const Subject& subject : page.subjects) seen.insert(subject.id);
  }
  writer.join();
  EXPECT_EQ(seen.size(), 98u);
  EXPECT_TRUE(log.read(cursor, kAll).subjects.empty());
}

}  // namespace
}  // namespace tessera::events
