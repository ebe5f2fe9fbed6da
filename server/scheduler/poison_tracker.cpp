// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/poison_tracker.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include "server/scheduler/interval_set.hpp"

namespace tessera::scheduler {
namespace {

using Part = PoisonTracker::Part;

void split_at(std::vector<Part>& parts, std::uint32_t sample) {
  const auto within = [&](const Part& part) {
    return part.samples.begin < sample && sample < part.samples.end;
  };
  const auto found = std::find_if(parts.begin(), parts.end(), within);
  if (found == parts.end()) return;
  Part rest = *found;
  found->samples.end = rest.samples.begin = sample;
  parts.insert(std::next(found), std::move(rest));
}

bool lies_in(const Part& part, core::SampleRange samples) {
  return part.samples.begin >= samples.begin && part.samples.end <= samples.end;
}

bool same_machine(const Loss& a, const Loss& b) {
  return a.name == b.name && a.principal == b.principal;
}

bool names(const std::vector<Loss>& losses, const Loss& loss) {
  return std::any_of(losses.begin(), losses.end(),
                     [&](const Loss& each) { return same_machine(each, loss); });
}

}  // namespace

void PoisonTracker::strike(const WorkItem& item, const Loss& loss, bool alone) {
  std::vector<Part>& parts = by_tile_[item.tile];
  tiles_of_[loss.worker].insert(item.tile);
  split_at(parts, item.samples.begin);
  split_at(parts, item.samples.end);
  if (loss.kind == LossKind::kStuck) spread(parts, item, loss);
  IntervalSet unsuspected{item.samples};
  for (Part& part : parts) {
    if (!lies_in(part, item.samples)) continue;
    unsuspected.remove(part.samples);
    const bool counts = alone || loss.kind == LossKind::kStuck;
    if (counts && !names(part.losses, loss)) part.losses.push_back(loss);
    for (Loss& each : part.losses) each.direct |= counts && same_machine(each, loss);
  }
  for (const core::SampleRange& range : unsuspected.ranges()) parts.push_back({range, {loss}});
  std::sort(parts.begin(), parts.end(),
            [](const Part& a, const Part& b) { return a.samples.begin < b.samples.begin; });
}

void PoisonTracker::spread(std::vector<Part>& parts, const WorkItem& item, const Loss& loss) {
  Loss indirect = loss;
  indirect.direct = false;
  std::set<WorkerId> earlier;
  for (const Part& part : parts) {
    for (const Loss& each : part.losses) {
      if (lies_in(part, item.samples) && each.kind == LossKind::kStuck) earlier.insert(each.worker);
    }
  }
  for (Part& part : parts) {
    const bool shared = std::any_of(part.losses.begin(), part.losses.end(), [&](const Loss& each) {
      return each.kind == LossKind::kStuck && earlier.contains(each.worker);
    });
    if (shared && !names(part.losses, loss)) part.losses.push_back(indirect);
  }
}

core::SampleRange PoisonTracker::to_be_told(const WorkItem& item) const {
  const Part first = first_part(item);
  const auto tile = by_tile_.find(item.tile);
  const bool all_direct =
      std::all_of(first.losses.begin(), first.losses.end(), [](const Loss& loss) { return loss.direct; });
  if (all_direct || tile == by_tile_.end()) return first.samples;
  const auto workers = [](const Part& part) {
    std::set<WorkerId> ids;
    for (const Loss& loss : part.losses) ids.insert(loss.worker);
    return ids;
  };
  std::optional<core::SampleRange> shared;
  for (const Part& part : tile->second) {
    const bool contains = part.samples.begin <= item.samples.begin && item.samples.begin < part.samples.end;
    if (contains) shared = part.samples;
  }
  if (!shared) return first.samples;
  const std::set<WorkerId> lost = workers(first);
  const auto extend = [&](const Part& part) {
    if (workers(part) != lost) return;
    if (part.samples.begin == shared->end) shared->end = part.samples.end;
    if (part.samples.end == shared->begin) shared->begin = part.samples.begin;
  };
  std::for_each(tile->second.begin(), tile->second.end(), extend);
  std::for_each(tile->second.rbegin(), tile->second.rend(), extend);
  return *shared;
}

void PoisonTracker::clear(const WorkItem& item) {
  const auto tile = by_tile_.find(item.tile);
  if (tile == by_tile_.end()) return;
  split_at(tile->second, item.samples.begin);
  split_at(tile->second, item.samples.end);
  std::erase_if(tile->second, [&](const Part& part) { return lies_in(part, item.samples); });
  if (tile->second.empty()) by_tile_.erase(tile);
  if (by_tile_.empty()) tiles_of_.clear();
}

void PoisonTracker::withdraw_strikes(const WorkerId& worker, LossKind kind) {
  const auto found = tiles_of_.find(worker);
  if (found == tiles_of_.end()) return;
  std::erase_if(found->second, [&](int tile) { return !withdraw_from_tile(tile, worker, kind); });
  if (found->second.empty()) tiles_of_.erase(found);
}

// Whether losses of the worker are left there.
bool PoisonTracker::withdraw_from_tile(int tile, const WorkerId& worker, LossKind kind) {
  const auto found = by_tile_.find(tile);
  if (found == by_tile_.end()) return false;
  const auto is_its = [&](const Loss& loss) { return loss.worker == worker; };
  bool any_left = false;
  for (Part& part : found->second) {
    std::erase_if(part.losses, [&](const Loss& loss) { return is_its(loss) && loss.kind == kind; });
    any_left |= std::any_of(part.losses.begin(), part.losses.end(), is_its);
  }
  std::erase_if(found->second, [](const Part& part) { return part.losses.empty(); });
  if (found->second.empty()) by_tile_.erase(found);
  return any_left;
}

PoisonTracker::Part PoisonTracker::first_part(const WorkItem& item) const {
  const auto tile = by_tile_.find(item.tile);
  if (tile == by_tile_.end()) return {item.samples, {}};
  const auto found = std::find_if(tile->second.begin(), tile->second.end(),
                                  [&](const Part& part) { return part.samples.end > item.samples.begin; });
  if (found == tile->second.end()) return {item.samples, {}};
  const auto until = [&](std::uint32_t end) {
    return core::SampleRange{item.samples.begin, std::min(end, item.samples.end)};
  };
  if (found->samples.begin > item.samples.begin) return {until(found->samples.begin), {}};
  return {until(found->samples.end), found->losses};
}

}  // namespace tessera::scheduler
