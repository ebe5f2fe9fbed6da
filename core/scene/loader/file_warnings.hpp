// SPDX-License-Identifier: Apache-2.0
// Warnings about one file of another program and the substitutions made. Each kind is reported once, with
// the line of its first occurrence and a count. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tessera::core {

class FileWarnings {
 public:
  // Warnings of equal `kind` are counted together. `text()` returns the message for the first: what is
  // wrong, and what is done instead. `line` is 0 if no line applies. `unit` is the plural of what is
  // counted.
  template <typename Text>
  void add(std::string_view kind, int line, const Text& text, std::uint64_t count = 1,
           std::string_view unit = "times") {
    if (Entry* known = find(kind)) {
      known->count += count;
    } else if (entries_.size() < kMaxKinds) {
      entries_.push_back({std::string(kind), line, std::string(text()), count, std::string(unit)});
    } else {
      untold_ += count;
    }
  }

  bool empty() const { return entries_.empty(); }
  // "FILE:LINE: WHAT (3 times)" for each kind, ordered by first line.
  std::vector<std::string> messages(std::string_view file) const;

 private:
  static constexpr std::size_t kMaxKinds = 24;

  struct Entry {
    std::string kind;
    int line;
    std::string text;
    std::uint64_t count;
    std::string unit;
  };

  Entry* find(std::string_view kind);

  std::vector<Entry> entries_;
  std::uint64_t untold_ = 0;
};

// The warnings of all files of a scene, in the order in which the files were read.
class SceneWarnings {
 public:
  bool knows(std::string_view file) const;
  // Valid until the next call.
  FileWarnings& of(std::string_view file);

  // Long lists are truncated.
  std::vector<std::string> messages() const;

 private:
  std::vector<std::pair<std::string, FileWarnings>> files_;
};

}  // namespace tessera::core
