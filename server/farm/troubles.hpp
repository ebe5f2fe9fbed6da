// SPDX-License-Identifier: Apache-2.0
// The reasons that workers give for not working, shown to users. The texts come from workers: they are
// bounded, made printable, and shown with the worker's name. Not thread-safe; guarded by the state lock.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tessera/v1/worker_service.pb.h"

namespace tessera::farm {

// The beginning of an untrusted text in printable characters. Reads at most `max_bytes` of it.
std::string excerpt(const std::string& text, std::size_t max_bytes);

class Troubles {
 public:
  static constexpr int kMaxOfWorker = 4;
  static constexpr std::size_t kMaxOfJob = 8;
  static constexpr std::size_t kMaxTextBytes = 300;

  // Replaces the worker's earlier reasons. Returns the new ones for the log, in the form of of_job().
  std::vector<std::string> note(const v1::SynchronizeRequest& request);
  void forget(const std::string& worker) { entries_.erase(worker); }

  // The worker's reasons as it gave them.
  std::vector<std::string> of_worker(const std::string& worker) const;
  // The jobs of these reasons; empty: every job.
  std::set<std::string> jobs_of_worker(const std::string& worker) const;
  // The reasons of all workers that concern this job or every job: "worker NAME says: ...".
  std::vector<std::string> of_job(const std::string& job) const;

 private:
  struct Entry {
    std::string job;  // empty: every job
    std::string worker_name;
    std::string text;
    std::string sentence() const;
    bool operator==(const Entry&) const = default;
  };
  std::map<std::string, std::vector<Entry>> entries_;  // by worker
};

}  // namespace tessera::farm
