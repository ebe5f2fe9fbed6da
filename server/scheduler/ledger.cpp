// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/ledger.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tessera::scheduler {
namespace {

// Merged entries are at most so long, so that an audit is at most a few seconds of work.
constexpr std::uint32_t kLongestMerged = 64;

// There are many tiles with few entries each: doubling the capacity would waste half of the memory.
constexpr std::size_t kGrowth = 4;

std::size_t position(const std::vector<LedgerEntry>& entries, std::uint32_t begin) {
  const auto found =
      std::lower_bound(entries.begin(), entries.end(), begin,
                       [](const LedgerEntry& e, std::uint32_t b) { return e.samples.begin < b; });
  return static_cast<std::size_t>(found - entries.begin());
}

}  // namespace

std::uint64_t Ledger::pixel_samples(int tile, const LedgerEntry& entry) const {
  return grid_.rect(tile).pixel_count() * entry.samples.count();
}

void Ledger::add(const WorkItem& item, ProducerNumber producer, const Fingerprint& fingerprint, Due due) {
  if (entries_ >= kMaxEntries && due == Due::kNo) return;
  std::vector<LedgerEntry>& entries = tiles_.mutable_at(item.tile);
  const std::size_t at = position(entries, item.samples.begin);
  LedgerEntry entry{item.samples, fingerprint.low, fingerprint.high, fingerprint.largest};
  entry.producer = producer & 0x3fffffffU;
  entry.due_bits = static_cast<unsigned>(due) & 3U;
  if (entries.size() == entries.capacity()) entries.reserve(entries.size() + kGrowth);
  entries.insert(entries.begin() + static_cast<std::ptrdiff_t>(at), entry);
  ++entries_;
  if (due != Due::kNo) due_ += pixel_samples(item.tile, entry);
  merge_with_next(item.tile, at);
  if (at > 0) merge_with_next(item.tile, at - 1);
}

void Ledger::merge_with_next(int tile, std::size_t left) {
  std::vector<LedgerEntry>& entries = tiles_.mutable_at(tile);
  if (left + 1 >= entries.size()) return;
  LedgerEntry& a = entries[left];
  const LedgerEntry& b = entries[left + 1];
  const bool alike = a.producer == b.producer && a.due() == Due::kNo && b.due() == Due::kNo;
  if (!alike || a.samples.end != b.samples.begin || b.samples.end - a.samples.begin > kLongestMerged) return;
  Fingerprint sum = a.fingerprint();
  sum.add(b.fingerprint());
  a.samples.end = b.samples.end;
  a.low = sum.low;
  a.high = sum.high;
  a.largest = sum.largest;
  entries.erase(entries.begin() + static_cast<std::ptrdiff_t>(left) + 1);
  --entries_;
}

const LedgerEntry& Ledger::at(int tile, std::uint32_t begin) const {
  const std::vector<LedgerEntry>& entries = of_tile(tile);
  const std::size_t at = position(entries, begin);
  assert(at < entries.size() && entries[at].samples.begin == begin);
  return entries[at];
}

LedgerEntry& Ledger::mutable_at(int tile, std::uint32_t begin) {
  return const_cast<LedgerEntry&>(std::as_const(*this).at(tile, begin));
}

void Ledger::set_due(int tile, std::uint32_t begin, Due due) {
  LedgerEntry& entry = mutable_at(tile, begin);
  if (entry.due() != Due::kNo) due_ -= pixel_samples(tile, entry);
  entry.due_bits = static_cast<unsigned>(due) & 3U;
  if (due != Due::kNo) due_ += pixel_samples(tile, entry);
}

void Ledger::erase(int tile, std::uint32_t begin) {
  set_due(tile, begin, Due::kNo);
  std::vector<LedgerEntry>& entries = tiles_.mutable_at(tile);
  entries.erase(entries.begin() + static_cast<std::ptrdiff_t>(position(entries, begin)));
  --entries_;
}

void Ledger::erase_tile(int tile) {
  if (of_tile(tile).empty()) return;
  std::vector<LedgerEntry>& entries = tiles_.mutable_at(tile);
  for (const LedgerEntry& entry : entries) {
    if (entry.due() != Due::kNo) due_ -= pixel_samples(tile, entry);
  }
  entries_ -= entries.size();
  entries = {};
}

}  // namespace tessera::scheduler
