// SPDX-License-Identifier: Apache-2.0
// Warnings about one file of another program and the substitutions made. A render tells each kind once, with
// the line of its first occurrence and a count; a report tells each place. Not thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tessera::core {

// How much is told of a scene. What is beyond is counted.
struct WarningLimits {
  std::size_t per_file = 24;  // messages
  std::size_t per_scene = 100;
  bool every_place = false;  // a message for each place, else one for each kind
};

// Of `tessera import --report`.
inline constexpr WarningLimits kReportLimits{20'000, 100'000, true};

class FileWarnings {
 public:
  FileWarnings() = default;
  explicit FileWarnings(const WarningLimits& limits) : limits_(limits) {}

  // Warnings of equal `kind` are counted together, unless every place is told. `text()` returns the message:
  // what is wrong, and what is done instead. `line` is 0 if no line applies. `unit` is the plural of what is
  // counted.
  template <typename Text>
  void add(std::string_view kind, int line, const Text& text, std::uint64_t count = 1,
           std::string_view unit = "times") {
    if (Entry* known = limits_.every_place ? nullptr : find(kind)) {
      known->count += count;
    } else if (entries_.size() < limits_.per_file) {
      entries_.push_back({std::string(kind), line, std::string(text()), count, std::string(unit)});
    } else {
      untold_ += count;
    }
  }

  bool empty() const { return entries_.empty(); }
  // "FILE:LINE: WHAT (3 times)", ordered by line. A last one counts those beyond the limit.
  std::vector<std::string> messages(std::string_view file) const;

 private:
  struct Entry {
    std::string kind;
    int line;
    std::string text;
    std::uint64_t count;
    std::string unit;
  };

  Entry* find(std::string_view kind);
  std::vector<Entry> ordered() const;

  WarningLimits limits_;
  std::vector<Entry> entries_;
  std::uint64_t untold_ = 0;
};

// The warnings of all files of a scene, in the order in which the files were read.
class SceneWarnings {
 public:
  SceneWarnings() = default;
  explicit SceneWarnings(const WarningLimits& limits) : limits_(limits) {}

  bool knows(std::string_view file) const;
  // Valid until the next call.
  FileWarnings& of(std::string_view file);

  // Long lists are truncated; the last message counts the rest.
  std::vector<std::string> messages() const;

 private:
  WarningLimits limits_;
  std::vector<std::pair<std::string, FileWarnings>> files_;
};

}  // namespace tessera::core
