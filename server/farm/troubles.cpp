// SPDX-License-Identifier: Apache-2.0
#include "server/farm/troubles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/base/printable.hpp"

namespace tessera::farm {

// Does not split a character, since the rest would not be valid UTF-8.
std::string excerpt(const std::string& text, std::size_t max_bytes) {
  std::size_t end = std::min(text.size(), max_bytes);
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
  return core::printable(text.substr(0, end)) + (end < text.size() ? "..." : "");
}

std::string Troubles::Entry::sentence() const {
  return fmt::format("worker {} says: {}", worker_name, text);
}

std::vector<std::string> Troubles::note(const v1::SynchronizeRequest& request) {
  std::vector<Entry> said;
  for (const v1::Trouble& trouble : request.troubles()) {
    if (said.size() == kMaxOfWorker) break;
    said.push_back(
        {trouble.job_id(), core::printable(request.name()), excerpt(trouble.text(), kMaxTextBytes)});
  }
  std::vector<std::string> fresh;
  const auto before = entries_.find(request.worker_id());
  for (const Entry& entry : said) {
    const bool known = before != entries_.end() &&
                       std::find(before->second.begin(), before->second.end(), entry) != before->second.end();
    if (!known) fresh.push_back(entry.sentence());
  }
  if (said.empty()) {
    entries_.erase(request.worker_id());
  } else {
    entries_[request.worker_id()] = std::move(said);
  }
  return fresh;
}

std::vector<std::string> Troubles::of_worker(const std::string& worker) const {
  std::vector<std::string> sentences;
  const auto entries = entries_.find(worker);
  if (entries == entries_.end()) return sentences;
  for (const Entry& entry : entries->second) sentences.push_back(entry.text);
  return sentences;
}

std::set<std::string> Troubles::jobs_of_worker(const std::string& worker) const {
  std::set<std::string> jobs;
  const auto entries = entries_.find(worker);
  if (entries == entries_.end()) return jobs;
  for (const Entry& entry : entries->second) jobs.insert(entry.job);
  return jobs;
}

std::vector<std::string> Troubles::of_job(const std::string& job) const {
  std::vector<std::string> sentences;
  for (const auto& [worker, entries] : entries_) {
    for (const Entry& entry : entries) {
      if (!entry.job.empty() && entry.job != job) continue;
      if (sentences.size() == kMaxOfJob) return sentences;
      sentences.push_back(entry.sentence());
    }
  }
  return sentences;
}

}  // namespace tessera::farm
