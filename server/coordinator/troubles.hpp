// SPDX-License-Identifier: Apache-2.0
// What workers say keeps them from work, for people who wait. Their own words: bounded, printable, and shown
// with the name of the worker that says so. Not thread-safe; the coordinator's gate guards it.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tessera/v1/worker_service.pb.h"

namespace tessera::coordinator {

// The beginning of a text in others' words, in printable characters: no more than `max_bytes` of it are read.
std::string excerpt(const std::string& text, std::size_t max_bytes);

class Troubles {
 public:
  static constexpr int kMaxOfWorker = 4;
  static constexpr std::size_t kMaxOfJob = 8;
  static constexpr std::size_t kMaxTextBytes = 300;

  // Replaces what the worker said before. Returns what is new of it, as of_job() says it, for the log.
  std::vector<std::string> note(const v1::SynchronizeRequest& request);
  // All workers but these are forgotten.
  void forget_others(const std::set<std::string>& present);

  // In the worker's words.
  std::vector<std::string> of_worker(const std::string& worker) const;
  // Of every worker that has trouble with this job, or with every job: "worker NAME says: ...".
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

}  // namespace tessera::coordinator
