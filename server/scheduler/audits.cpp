// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/audits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace tessera::scheduler {

WorkItem Audits::item_at(const Key& key) const {
  return {key.tile, entry_at(key).samples};
}

const LedgerEntry& Audits::entry_at(const Key& key) const {
  return ledger_.at(key.tile, key.begin);
}

void Audits::add(const WorkItem& item, ProducerNumber producer, const Fingerprint& fingerprint, Due due) {
  ledger_.add(item, producer, fingerprint, due);
  if (due == Due::kNo) return;
  if (due == Due::kDoubted) ++doubted_;
  waiting_[producer].insert(key_of(item));
}

void Audits::make_due(const WorkItem& item, Due due) {
  const LedgerEntry& entry = ledger_.at(item.tile, item.samples.begin);
  const Due before = entry.due();
  if (before == Due::kNo) waiting_[entry.producer].insert(key_of(item));
  if (before != Due::kDoubted && due == Due::kDoubted) ++doubted_;
  ledger_.set_due(item.tile, item.samples.begin, due);
}

bool Audits::doubt(int tile, const Producers& producers) {
  bool any = false;
  for (std::size_t i = 0; i < ledger_.of_tile(tile).size(); ++i) {
    const LedgerEntry& entry = ledger_.of_tile(tile)[i];
    if (entry.due() == Due::kDoubted || !producers.is_distrusted(producers.at(entry.producer))) continue;
    make_due({tile, entry.samples}, Due::kDoubted);
    any = true;
  }
  return any;
}

bool Audits::has_doubtful(int tile, const Producers& producers) const {
  const auto& entries = ledger_.of_tile(tile);
  return std::any_of(entries.begin(), entries.end(), [&](const LedgerEntry& entry) {
    return entry.due() != Due::kDoubted && producers.is_distrusted(producers.at(entry.producer));
  });
}

// The first entries that were chosen by lot, of those that wait and those in progress.
std::vector<Audits::Key> Audits::chosen(std::size_t most) const {
  std::vector<Key> keys;
  const auto add = [&](const Key& key) {
    if (entry_at(key).due() == Due::kChosen) keys.push_back(key);
    return keys.size() < most;
  };
  for (const auto& [producer, waiting] : waiting_) {
    for (const Key& key : waiting)
      if (!add(key)) return keys;
  }
  for (const auto& [key, attempts] : at_work_)
    if (!add(key)) return keys;
  return keys;
}

std::size_t Audits::waive(std::size_t most) {
  const std::vector<Key> waived = chosen(most);
  for (const Key& key : waived) {
    forget(key);
    ledger_.set_due(key.tile, key.begin, Due::kNo);
  }
  return waived.size();
}

void Audits::drop_tile(int tile) {
  for (const LedgerEntry& entry : ledger_.of_tile(tile)) {
    if (entry.due() == Due::kDoubted) --doubted_;
    if (entry.due() != Due::kNo) forget({tile, entry.samples.begin});
  }
  ledger_.erase_tile(tile);
}

// Removes the audits of an entry and their claims; the entry stays.
void Audits::forget(const Key& key) {
  const auto waiting = waiting_.find(entry_at(key).producer);
  if (waiting != waiting_.end()) {
    waiting->second.erase(key);
    if (waiting->second.empty()) waiting_.erase(waiting);
  }
  contradicted_waiting_.erase(key);
  at_work_.erase(key);
  shareable_.erase(key);
  claims_.erase(key);
}

void Audits::erase(AtWork::iterator entry) {
  shareable_.erase(entry->first);
  at_work_.erase(entry);
}

IdentityNumber Audits::excluded(const Producers& producers) const {
  if (!contradicted_waiting_.empty() || waiting_.empty()) return kNoIdentity;
  const IdentityNumber first = producers.identity(waiting_.begin()->first);
  const bool alike = std::all_of(waiting_.begin(), waiting_.end(), [&](const auto& waiting) {
    return producers.identity(waiting.first) == first;
  });
  return alike ? first : kNoIdentity;
}

const Producer* Audits::any_waiting_producer(const Producers& producers) const {
  return waiting_.empty() ? nullptr : &producers.at(waiting_.begin()->first);
}

bool Audits::may_audit(const Producer& worker, const Key& key, const Producers& producers) const {
  if (are_one(worker, producers.at(entry_at(key).producer))) return false;
  const auto claims = claims_.find(key);
  return claims == claims_.end() ||
         std::none_of(claims->second.begin(), claims->second.end(),
                      [&](const Claim& claim) { return are_one(worker, producers.at(claim.producer)); });
}

bool Audits::offer(const Producer& worker, const Producers& producers,
                   const std::function<bool(const WorkItem&)>& take) const {
  bool any = false;
  for (const Key& key : contradicted_waiting_) {
    if (!may_audit(worker, key, producers)) continue;
    any = true;
    if (!take(item_at(key))) return true;
  }
  for (const auto& [producer, keys] : waiting_) {
    if (are_one(worker, producers.at(producer))) continue;
    any = true;
    for (const Key& key : keys) {
      if (!take(item_at(key))) return true;
    }
  }
  return any;
}

std::optional<WorkItem> Audits::copy_for(const Producer& worker, const Producers& producers,
                                         const std::function<bool(LeaseId)>& may_share) const {
  for (const Key& key : shareable_) {
    const Attempt& attempt = at_work_.at(key).front();
    if (are_one(worker, producers.at(attempt.auditor))) continue;
    if (may_audit(worker, key, producers) && may_share(attempt.lease)) return item_at(key);
  }
  return std::nullopt;
}

void Audits::begin(const WorkItem& item, LeaseId lease, ProducerNumber auditor) {
  const Key key = key_of(item);
  std::vector<Attempt>& attempts = at_work_[key];
  attempts.push_back({lease, auditor, {}, {}});
  if (attempts.size() > 1) {
    shareable_.erase(key);
    return;
  }
  shareable_.insert(key);
  contradicted_waiting_.erase(key);
  const auto waiting = waiting_.find(entry_at(key).producer);
  if (waiting == waiting_.end()) return;
  waiting->second.erase(key);
  if (waiting->second.empty()) waiting_.erase(waiting);
}

void Audits::free_up(const Key& key) {
  if (claims_.contains(key)) {
    contradicted_waiting_.insert(key);
  } else {
    waiting_[entry_at(key).producer].insert(key);
  }
}

Audits::AtWork::const_iterator Audits::at_work_on(const WorkItem& piece) const {
  // The last entry that begins at or before these samples; entries do not overlap.
  const auto after = at_work_.upper_bound(key_of(piece));
  if (after == at_work_.begin()) return at_work_.end();
  const auto found = std::prev(after);
  const bool has = found->first.tile == piece.tile && entry_at(found->first).samples.end >= piece.samples.end;
  return has ? found : at_work_.end();
}

Audits::AtWork::iterator Audits::at_work_on(const WorkItem& piece) {
  const auto found = std::as_const(*this).at_work_on(piece);
  return at_work_.erase(found, found);
}

WorkItem Audits::entry_of(const WorkItem& piece) const {
  const auto found = at_work_on(piece);
  return found == at_work_.end() ? piece : item_at(found->first);
}

void Audits::abandon(LeaseId lease, const WorkItem& piece) {
  const auto found = at_work_on(piece);
  if (found == at_work_.end()) return;
  std::erase_if(found->second, [&](const Attempt& attempt) { return attempt.lease == lease; });
  if (found->second.empty()) {
    free_up(found->first);
    erase(found);
  } else if (found->second.size() == 1) {
    shareable_.insert(found->first);
  }
}

std::optional<Ruling> Audits::deliver(LeaseId lease, const WorkItem& piece, const Fingerprint& fingerprint) {
  const auto entry = at_work_on(piece);
  const Key key = entry->first;
  const auto attempt = std::find_if(entry->second.begin(), entry->second.end(),
                                    [&](const Attempt& each) { return each.lease == lease; });
  attempt->rendered.add(piece.samples);
  attempt->sum.add(fingerprint);
  if (!attempt->rendered.contains(entry_at(key).samples)) return std::nullopt;
  const Claim claim{attempt->auditor, attempt->sum};
  erase(entry);
  return rule(key, claim);
}

Ruling Audits::rule(const Key& key, const Claim& claim) {
  const WorkItem item = item_at(key);
  const LedgerEntry entry = entry_at(key);
  Ruling ruling{item, Ruling::Outcome::kContradicted, entry.producer, claim.producer, {}, {}};
  std::vector<Claim> earlier{{entry.producer, entry.fingerprint()}};
  if (const auto claims = claims_.find(key); claims != claims_.end())
    earlier.insert(earlier.end(), claims->second.begin(), claims->second.end());
  for (const Claim& each : earlier) {
    const bool agrees = same_sums(each.fingerprint, claim.fingerprint);
    (agrees ? ruling.right : ruling.wrong).push_back(each.producer);
  }
  if (ruling.right.empty()) {
    ruling.wrong.clear();
    claims_[key].push_back(claim);
    make_due(item, Due::kDoubted);
    free_up(key);
    return ruling;
  }
  ruling.right.push_back(claim.producer);
  const bool film_is_right = same_sums(entry.fingerprint(), claim.fingerprint);
  ruling.outcome = film_is_right ? Ruling::Outcome::kConfirmed : Ruling::Outcome::kRefuted;
  if (!film_is_right) return ruling;  // the tile is dropped with all its entries
  if (entry.due() == Due::kDoubted) --doubted_;
  forget(key);
  ledger_.erase(key.tile, key.begin);
  return ruling;
}

std::optional<std::string> Audits::check() const {
  std::size_t due = 0, doubted = 0, found = contradicted_waiting_.size() + at_work_.size();
  for (const auto& [producer, keys] : waiting_) found += keys.size();
  for (int tile = 0; tile < ledger_.tile_count(); ++tile) {
    for (const LedgerEntry& entry : ledger_.of_tile(tile)) {
      due += entry.due() != Due::kNo ? 1 : 0;
      doubted += entry.due() == Due::kDoubted ? 1 : 0;
    }
  }
  if (due != found) return fmt::format("{} ranges are due, {} wait or are rendered again", due, found);
  if (doubted != doubted_) return fmt::format("{} ranges are doubted, counted {}", doubted, doubted_);
  for (const auto& [key, attempts] : at_work_) {
    if (attempts.empty() || attempts.size() > 2) return fmt::format("{} are at one audit", attempts.size());
    if (shareable_.contains(key) != (attempts.size() == 1))
      return fmt::format("{} are at one audit, which is listed otherwise", attempts.size());
  }
  return std::nullopt;
}

}  // namespace tessera::scheduler
