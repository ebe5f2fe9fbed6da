// SPDX-License-Identifier: Apache-2.0
#include "server/farm/quarantine.hpp"

#include <fmt/format.h>

namespace tessera::farm {

bool Quarantine::refused(const std::string& worker, const std::string& machine) {
  Entry& entry = entries_[worker];
  ++entry.refused;
  if (++entry.in_a_row < kRejectionsUntilQuarantine) return false;
  return quarantined(worker, machine,
                     fmt::format("{} of its results in a row were rejected", kRejectionsUntilQuarantine));
}

bool Quarantine::quarantined(const std::string& worker, const std::string& machine,
                             const std::string& because) {
  Entry& entry = entries_[worker];
  if (entry.aside) return false;
  entry.aside = true;
  entry.because = because;
  if (!machine.empty()) machines_aside_.emplace(machine, because);
  return true;
}

std::string Quarantine::because(const std::string& worker, const std::string& machine) const {
  const auto entry = entries_.find(worker);
  if (entry != entries_.end() && entry->second.aside) return entry->second.because;
  const auto first = machines_aside_.find(machine);
  return first == machines_aside_.end() ? "" : first->second;
}

void Quarantine::forget_others(const std::set<std::string>& present) {
  std::erase_if(entries_,
                [&](const auto& entry) { return !entry.second.aside && !present.contains(entry.first); });
}

void Quarantine::in_order(const std::string& worker) {
  const auto entry = entries_.find(worker);
  if (entry != entries_.end()) entry->second.in_a_row = 0;
}

std::uint64_t Quarantine::refusals(const std::string& worker) const {
  const auto entry = entries_.find(worker);
  return entry == entries_.end() ? 0 : entry->second.refused;
}

bool Quarantine::is_quarantined(const std::string& worker) const {
  const auto entry = entries_.find(worker);
  return entry != entries_.end() && entry->second.aside;
}

}  // namespace tessera::farm
