// SPDX-License-Identifier: Apache-2.0
// A map whose stale entries are removed little by little: whoever inserts an entry has the next ones looked
// at in turn. So the map is not much larger than its entries that are in use, and nobody needs to search it
// when something ends. Not thread-safe.
#pragma once

#include <cstddef>
#include <map>
#include <utility>

namespace tessera::scheduler {

template <typename Key, typename Value>
class SweptMap {
 public:
  const Value* find(const Key& key) const {
    const auto found = entries_.find(key);
    return found == entries_.end() ? nullptr : &found->second;
  }
  Value* find(const Key& key) {
    const auto found = entries_.find(key);
    return found == entries_.end() ? nullptr : &found->second;
  }

  // The entry of this key. If it is new, some others are removed unless in_use(key, value).
  template <typename InUse>
  Value& at_or_insert(const Key& key, const InUse& in_use) {
    const auto found = entries_.lower_bound(key);
    if (found != entries_.end() && found->first == key) return found->second;
    sweep(in_use);
    return entries_.try_emplace(key).first->second;
  }

  void erase(const Key& key) { entries_.erase(key); }
  std::size_t size() const { return entries_.size(); }
  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }

 private:
  // More than one for each insertion, so that the sweep catches up.
  static constexpr int kSweptPerInsertion = 2;

  template <typename InUse>
  void sweep(const InUse& in_use) {
    for (int i = 0; i < kSweptPerInsertion && !entries_.empty(); ++i) {
      auto next = entries_.upper_bound(swept_);
      if (next == entries_.end()) next = entries_.begin();
      swept_ = next->first;
      if (!in_use(next->first, next->second)) entries_.erase(next);
    }
  }

  std::map<Key, Value> entries_;
  // The entry that was looked at last.
  Key swept_{};
};

}  // namespace tessera::scheduler
