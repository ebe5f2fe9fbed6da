#include "server/scheduler/suspects.hpp"

#include <algorithm>

#include "server/scheduler/interval_set.hpp"

namespace tessera::scheduler {
namespace {

using Part = Suspects::Part;

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

bool names(const std::vector<Death>& deaths, const std::string& machine) {
  return std::any_of(deaths.begin(), deaths.end(), [&](const Death& d) { return d.name == machine; });
}

}  // namespace

void Suspects::blame(const WorkItem& item, const Death& death, bool alone) {
  std::vector<Part>& parts = by_tile_[item.tile];
  split_at(parts, item.samples.begin);
  split_at(parts, item.samples.end);
  IntervalSet unsuspected{item.samples};
  for (Part& part : parts) {
    if (!lies_in(part, item.samples)) continue;
    unsuspected.remove(part.samples);
    if (alone && !names(part.deaths, death.name)) part.deaths.push_back(death);
  }
  for (const core::SampleRange& range : unsuspected.ranges()) parts.push_back({range, {death}});
  std::sort(parts.begin(), parts.end(),
            [](const Part& a, const Part& b) { return a.samples.begin < b.samples.begin; });
}

void Suspects::clear(const WorkItem& item) {
  const auto tile = by_tile_.find(item.tile);
  if (tile == by_tile_.end()) return;
  split_at(tile->second, item.samples.begin);
  split_at(tile->second, item.samples.end);
  std::erase_if(tile->second, [&](const Part& part) { return lies_in(part, item.samples); });
  if (tile->second.empty()) by_tile_.erase(tile);
}

void Suspects::absolve(const WorkerId& worker) {
  for (auto& [tile, parts] : by_tile_) {
    for (Part& part : parts) std::erase_if(part.deaths, [&](const Death& d) { return d.worker == worker; });
    std::erase_if(parts, [](const Part& part) { return part.deaths.empty(); });
  }
  std::erase_if(by_tile_, [](const auto& tile) { return tile.second.empty(); });
}

Suspects::Part Suspects::first_part(const WorkItem& item) const {
  const auto tile = by_tile_.find(item.tile);
  if (tile == by_tile_.end()) return {item.samples, {}};
  const auto found = std::find_if(tile->second.begin(), tile->second.end(),
                                  [&](const Part& part) { return part.samples.end > item.samples.begin; });
  if (found == tile->second.end()) return {item.samples, {}};
  const auto until = [&](std::uint32_t end) {
    return core::SampleRange{item.samples.begin, std::min(end, item.samples.end)};
  };
  if (found->samples.begin > item.samples.begin) return {until(found->samples.begin), {}};
  return {until(found->samples.end), found->deaths};
}

}  // namespace tessera::scheduler
