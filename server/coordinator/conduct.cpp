#include "server/coordinator/conduct.hpp"

namespace tessera::coordinator {

bool Conduct::refused(const std::string& worker, const std::string& name) {
  Entry& entry = entries_[worker];
  ++entry.refused;
  if (++entry.in_a_row < kRefusalsUntilAside || entry.aside) return false;
  entry.aside = true;
  if (!name.empty()) names_aside_.insert(name);
  return true;
}

void Conduct::forget_others(const std::set<std::string>& present) {
  std::erase_if(entries_,
                [&](const auto& entry) { return !entry.second.aside && !present.contains(entry.first); });
}

void Conduct::in_order(const std::string& worker) {
  const auto entry = entries_.find(worker);
  if (entry != entries_.end()) entry->second.in_a_row = 0;
}

std::uint64_t Conduct::refusals(const std::string& worker) const {
  const auto entry = entries_.find(worker);
  return entry == entries_.end() ? 0 : entry->second.refused;
}

bool Conduct::is_aside(const std::string& worker) const {
  const auto entry = entries_.find(worker);
  return entry != entries_.end() && entry->second.aside;
}

}  // namespace tessera::coordinator
