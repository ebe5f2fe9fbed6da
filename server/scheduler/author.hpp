// Who has rendered something, so that it can be said long after; and who of them is trusted. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// A process that rendered, the name it goes by, and WorkerInfo::machine. A name is chosen by whoever starts
// the worker, and proves nothing. Empty: unknown.
struct Author {
  std::string name;
  WorkerId worker;
  std::string machine{};
  auto operator<=>(const Author&) const = default;
};

// For sentences.
inline const std::string& called(const Author& author) {
  return author.name.empty() ? author.worker.value : author.name;
}

// Whether one cannot vouch for the other: they are of one name, or one and the same.
inline bool are_one(const Author& a, const Author& b) {
  return a.worker == b.worker || (!a.name.empty() && a.name == b.name);
}

// Stands for an author where there are many of them to remember.
using AuthorNumber = std::uint32_t;

class Authors {
 public:
  AuthorNumber number(const Author& author) {
    const auto [known, is_new] = numbers_.try_emplace(author, static_cast<AuthorNumber>(authors_.size()));
    if (is_new) authors_.push_back(author);
    return known->second;
  }
  const Author& at(AuthorNumber number) const { return authors_[number]; }
  // A worker says its name, which may have delivered something before it did.
  void introduce(const Author& author) {
    const auto nameless = numbers_.find({{}, author.worker});
    if (author.name.empty() || nameless == numbers_.end() || numbers_.contains(author)) return;
    const AuthorNumber number = nameless->second;
    numbers_.erase(nameless);
    numbers_.emplace(author, number);
    authors_[number] = author;
  }

  // Every other worker of its machine as well; not those of its name, which anybody can take.
  void distrust(const Author& author) {
    distrusted_workers_.insert(author.worker);
    if (!author.machine.empty()) distrusted_machines_.insert(author.machine);
  }
  bool is_distrusted(const Author& author) const {
    return distrusted_workers_.contains(author.worker) || distrusted_machines_.contains(author.machine);
  }

 private:
  std::map<Author, AuthorNumber> numbers_;
  std::vector<Author> authors_;
  std::set<WorkerId> distrusted_workers_;
  std::set<std::string> distrusted_machines_;
};

}  // namespace tessera::scheduler
