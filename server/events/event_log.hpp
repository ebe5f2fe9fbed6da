// SPDX-License-Identifier: Apache-2.0
// The log of changes of jobs and workers. Whoever follows a farm (checkpoints, watchers, metrics) has a
// cursor: the revision up to which it has read.
//
// The log is compacted: of each subject it keeps the last change only, so that it is no longer than the farm
// is large, and a slow reader has no more to read than what differs. A reader looks up what the subject is
// now; the log says only which ones to look at. Changes of tiles have revisions of the same counter, and are
// kept by their film (film::JobFilm). Thread-safe; appending takes a microsecond.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/base/mutex.hpp"
#include "server/events/revision.hpp"

namespace tessera::events {

enum class SubjectKind { kJob, kWorker };

struct Subject {
  SubjectKind kind = SubjectKind::kJob;
  std::string id;
  bool operator==(const Subject&) const = default;
};

// How far somebody has read. The default is the start.
struct Cursor {
  Revision revision = 0;
  // The last change that was forgotten when the reader began at the start.
  Revision forgotten = 0;
  bool operator==(const Cursor&) const = default;
};

class EventLog {
 public:
  // How many subjects that have ended are kept for readers who come late.
  static constexpr std::size_t kKeptEnded = 4096;

  explicit EventLog(std::uint32_t epoch, std::size_t kept_ended = kKeptEnded)
      : counter_(epoch), kept_ended_(kept_ended), forgotten_(RevisionCounter::first_of(epoch)) {}

  // The subject has changed. Returns the revision of the change.
  Revision append(SubjectKind kind, const std::string& id) { return append({kind, id}, false); }
  // The same, and it will hardly change again: the job is finished, or the subject is gone.
  Revision append_end(SubjectKind kind, const std::string& id) { return append({kind, id}, true); }

  struct Page {
    // Those that changed, oldest change first.
    std::vector<Subject> subjects;
    // Where the next page begins.
    Cursor next;
    // Whether there was nothing more at this moment.
    bool is_last = true;
    // Some changes after the cursor are forgotten, or the coordinator was restarted: this page and the next
    // ones have all subjects that there are, and what is not among them is gone.
    bool reset = false;
  };
  // At most `most` subjects that changed after `cursor`.
  Page read(const Cursor& cursor, std::size_t most) const;

  bool has_changes_after(const Cursor& cursor) const;

  // How often wake() was called.
  std::uint64_t wakes() const;
  // Blocks until there is a change after `cursor`, or wake() has been called more often than `wakes` times.
  void wait(const Cursor& cursor, std::uint64_t wakes);
  void wake();

  // Numbers changes of tiles, too.
  RevisionCounter& counter() { return counter_; }

 private:
  struct Hash {
    std::size_t operator()(const Subject& subject) const {
      return std::hash<std::string>()(subject.id) ^ static_cast<std::size_t>(subject.kind);
    }
  };
  struct Entry {
    Revision revision = 0;
    bool has_ended = false;
  };

  Revision append(Subject subject, bool has_ended);
  bool is_behind(const Cursor& cursor) const TESSERA_REQUIRES(mutex_) {
    return !order_.empty() && order_.rbegin()->first > cursor.revision;
  }
  void forget_ended() TESSERA_REQUIRES(mutex_);
  // Whether a subject ended with this revision and has not changed since.
  bool has_ended_at(Revision revision) const TESSERA_REQUIRES(mutex_);

  RevisionCounter counter_;
  const std::size_t kept_ended_;
  mutable core::Mutex mutex_;
  std::condition_variable appended_;
  std::unordered_map<Subject, Entry, Hash> entries_ TESSERA_GUARDED_BY(mutex_);
  std::map<Revision, Subject> order_ TESSERA_GUARDED_BY(mutex_);
  // The revisions with which subjects ended, oldest first; some may have changed since.
  std::deque<Revision> ended_ TESSERA_GUARDED_BY(mutex_);
  std::size_t ended_count_ TESSERA_GUARDED_BY(mutex_) = 0;
  // The last change of a subject that was removed; at first less than all changes.
  Revision forgotten_ TESSERA_GUARDED_BY(mutex_);
  int waiting_ TESSERA_GUARDED_BY(mutex_) = 0;
  std::uint64_t wakes_ TESSERA_GUARDED_BY(mutex_) = 0;
};

}  // namespace tessera::events
