// SPDX-License-Identifier: Apache-2.0
// The audits of one job: which entries of its ledger are due, who renders them again, and with which outcome.
// Knows lease ids, but nothing else of leases, and no time. Not thread-safe.
//
//   chosen by lot, or its producer
//        is quarantined
//              │
//              ▼      begin()                 deliver()
//             due ─────────────▶ in progress ─────┬── same sums ───────────▶ confirmed: leaves the ledger
//              ▲                     │            │
//              │      abandon()      │            ├── other sums ──────────▶ contradicted
//              ├─────────────────────┘            │
//              │                                  └── other sums, equal ───▶ refuted: the whole tile
//              └── contradicted: a third               to those of an            is rendered again
//                  worker is asked                     earlier audit
//
// An auditor must have another name than every earlier producer of the range. At most two audit it at a time.
// The sums on which two names agree are right, and those who rendered others were wrong.
#pragma once

#include <compare>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/scheduler/interval_set.hpp"
#include "server/scheduler/ledger.hpp"
#include "server/scheduler/producer.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// The outcome of an audit.
struct Ruling {
  WorkItem item;
  enum class Outcome { kConfirmed, kContradicted, kRefuted } outcome = Outcome::kConfirmed;
  // The producer of the samples in the film, and the auditor.
  ProducerNumber producer = 0, auditor = 0;
  // All who rendered the range: those on whose sums two names agree, and the others. Empty while no two
  // agree.
  std::vector<ProducerNumber> right, wrong;
};

class Audits {
 public:
  explicit Audits(const JobGrid& grid) : ledger_(grid) {}

  // ---- Samples to audit ----
  void add(const WorkItem& item, ProducerNumber producer, const Fingerprint& fingerprint, Due due);
  // Makes all entries of distrusted producers in this tile due. Returns whether there were any that were not.
  bool doubt(int tile, const Producers& producers);
  // Whether entries of distrusted producers in this tile are not due yet.
  bool has_doubtful(int tile, const Producers& producers) const;
  // Cancels audits of entries that were chosen by lot, at most so many. Returns their number.
  std::size_t waive(std::size_t most);
  // Removes the entries of a tile.
  void drop_tile(int tile);

  const Ledger& ledger() const { return ledger_; }
  // The pixel samples that are due.
  std::uint64_t due() const { return ledger_.due(); }
  // Whether an entry is due for another reason than the lot.
  bool any_doubted() const { return doubted_ > 0; }

  // ---- Assignment ----
  // Whether entries are due and not in progress.
  bool any_waiting() const { return !waiting_.empty() || !contradicted_waiting_.empty(); }
  // Whether some are in progress with only one auditor.
  bool any_shareable() const { return !shareable_.empty(); }
  // The identity that cannot audit any of the entries that wait; kNoIdentity if others cannot be told apart
  // so simply.
  IdentityNumber excluded(const Producers& producers) const;
  // One of the producers of entries that wait, and are not contradicted; null if there is none.
  const Producer* any_waiting_producer(const Producers& producers) const;
  // Offers the due entries that are not in progress to this worker, until `take` returns false. Returns
  // whether there were any.
  bool offer(const Producer& worker, const Producers& producers,
             const std::function<bool(const WorkItem&)>& take) const;
  // An entry that an auditor of another name has in progress, under a lease that may be shared.
  std::optional<WorkItem> copy_for(const Producer& worker, const Producers& producers,
                                   const std::function<bool(LeaseId)>& may_share) const;
  void begin(const WorkItem& item, LeaseId lease, ProducerNumber auditor);
  // The lease ended without these samples: their range is due again.
  void abandon(LeaseId lease, const WorkItem& piece);

  // ---- Outcome ----
  // Takes samples of an item that this lease has begun. Returns a ruling after the last samples of the item,
  // which then leaves the state "in progress".
  std::optional<Ruling> deliver(LeaseId lease, const WorkItem& piece, const Fingerprint& fingerprint);
  // The entry in progress of which the piece is a part; the piece itself if there is none.
  WorkItem entry_of(const WorkItem& piece) const;

  // Checks the invariants. Returns the first violation as a sentence.
  std::optional<std::string> check() const;

 private:
  // Identifies an entry by its first sample.
  struct Key {
    int tile = 0;
    std::uint32_t begin = 0;
    auto operator<=>(const Key&) const = default;
  };
  struct Attempt {
    LeaseId lease;
    ProducerNumber auditor = 0;
    IntervalSet rendered;
    Fingerprint sum;
  };
  struct Claim {
    ProducerNumber producer = 0;
    Fingerprint fingerprint;
  };

  static Key key_of(const WorkItem& item) { return {item.tile, item.samples.begin}; }
  // The audits in progress of these samples, or the end.
  using AtWork = std::map<Key, std::vector<Attempt>>;
  AtWork::const_iterator at_work_on(const WorkItem& piece) const;
  AtWork::iterator at_work_on(const WorkItem& piece);
  WorkItem item_at(const Key& key) const;
  const LedgerEntry& entry_at(const Key& key) const;
  bool may_audit(const Producer& worker, const Key& key, const Producers& producers) const;
  void make_due(const WorkItem& item, Due due);
  void free_up(const Key& key);
  void forget(const Key& key);
  void erase(AtWork::iterator entry);
  std::vector<Key> chosen(std::size_t most) const;
  Ruling rule(const Key& key, const Claim& claim);

  Ledger ledger_;
  // Entries that are due and not in progress: by producer where only one worker has rendered them, otherwise
  // among the contradicted ones.
  std::map<ProducerNumber, std::set<Key>> waiting_;
  std::set<Key> contradicted_waiting_;
  AtWork at_work_;
  // Those of them with one auditor.
  std::set<Key> shareable_;
  // The sums of auditors that are neither confirmed nor refuted.
  std::map<Key, std::vector<Claim>> claims_;
  std::size_t doubted_ = 0;
};

}  // namespace tessera::scheduler
