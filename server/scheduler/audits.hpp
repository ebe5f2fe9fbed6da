// SPDX-License-Identifier: Apache-2.0
// The audits of one job: what of its ledger is due, who renders it again, and what comes of it. Knows nothing
// of leases beyond their ids, or of time. Not thread-safe.
//
//                    taken (begin)          its bits (deliver)
//          due ─────────────────────▶ at work ───────┬──────────────▶ confirmed: out of the ledger
//           ▲                          │             │ others
//           │  given up (abandon)      │             ├───────────────▶ contradicted: due again, for a third
//           name ├──────────────────────────┘             │ others, as those of an earlier audit │
//           └───────────────▶ refuted: its whole tile is rendered again
//   by lot, or its author is quarantined
//
// Who renders a range again is of another name than everybody who has rendered it before; at most two at a
// time. Bits that two names agree on are right, and who rendered others was wrong.
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

// What came of an audit.
struct Ruling {
  WorkItem item;
  enum class Outcome { kConfirmed, kContradicted, kRefuted } outcome = Outcome::kConfirmed;
  // Whose bits are in the film, and who rendered them again this time.
  ProducerNumber producer = 0, auditor = 0;
  // Of all who rendered it: those that two names agree on, and the others. Empty while nobody agrees.
  std::vector<ProducerNumber> right, wrong;
};

class Audits {
 public:
  explicit Audits(const core::TileGrid& grid) : ledger_(grid) {}

  // ---- What was rendered ----
  void add(const WorkItem& item, ProducerNumber producer, const Fingerprint& fingerprint, Due due);
  // Everything by authors that are distrusted is due. The tiles where there was such.
  std::vector<int> doubt(const Producers& producers);
  // Whether there is something by distrusted authors that is not due.
  bool has_doubtful(const Producers& producers) const;
  // What was chosen by lot is no longer due. How many ranges that were.
  std::size_t waive();
  // Forgets a tile, or everything.
  void drop_tile(int tile);
  void clear();

  const Ledger& ledger() const { return ledger_; }
  // In pixel samples.
  std::uint64_t due() const { return ledger_.due(); }
  // Whether something is due for another reason than by lot.
  bool any_doubted() const { return doubted_ > 0; }

  // ---- Who renders it again ----
  // Offers this worker what is due and nobody is at, until it is refused. Whether there was any.
  bool offer(const Producer& worker, const Producers& producers,
             const std::function<bool(const WorkItem&)>& take) const;
  // Something that one of another name is at, under a lease that may be shared.
  std::optional<WorkItem> copy_for(const Producer& worker, const Producers& producers,
                                   const std::function<bool(LeaseId)>& may_share) const;
  void begin(const WorkItem& item, LeaseId lease, ProducerNumber auditor);
  // The lease has ended without these samples: the range that they are of is due as before.
  void abandon(LeaseId lease, const WorkItem& piece);

  // ---- What comes of it ----
  // Samples of an item that this lease has begun. A ruling when they were the last of the item; then nobody
  // is at it any more.
  std::optional<Ruling> deliver(LeaseId lease, const WorkItem& piece, const Fingerprint& fingerprint);

  // What must be true of it, as a sentence if it is not.
  std::optional<std::string> check() const;

 private:
  // An entry, by where it begins.
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
  // Where these samples are rendered again, or the end.
  std::map<Key, std::vector<Attempt>>::iterator at_work_on(const WorkItem& piece);
  WorkItem item_at(const Key& key) const;
  const LedgerEntry& entry_at(const Key& key) const;
  bool may_audit(const Producer& worker, const Key& key, const Producers& producers) const;
  void make_due(const WorkItem& item, Due due);
  void free_up(const Key& key);
  void forget(const Key& key);
  Ruling rule(const Key& key, const Claim& claim);

  Ledger ledger_;
  // Due, and nobody is at it: by its author where only that one has rendered it, else among the contradicted.
  std::map<ProducerNumber, std::set<Key>> waiting_;
  std::set<Key> contradicted_waiting_;
  std::map<Key, std::vector<Attempt>> at_work_;
  // What auditors have rendered that was neither confirmed nor refuted.
  std::map<Key, std::vector<Claim>> claims_;
  std::size_t doubted_ = 0;
};

}  // namespace tessera::scheduler
