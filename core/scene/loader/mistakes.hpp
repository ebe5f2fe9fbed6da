// SPDX-License-Identifier: Apache-2.0
// Collects the mistakes of a scene file, so that one run reports all of them. Not thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::core {

// A location in a scene file: the line, from 1, and the field as in "materials.stone.albedo" (empty: the
// whole file).
struct Place {
  int line = 0;
  std::string field;
};

class Mistakes {
 public:
  // `file` is the scene file's name in messages.
  explicit Mistakes(std::string file) : file_(std::move(file)) {}

  void add(const Place& place, std::string_view what, ErrorCode code = ErrorCode::kInvalidArgument);

  // Adds a mistake whose message contains its location.
  void add_whole(const Error& error) { mistakes_.push_back({0, error}); }

  bool empty() const { return mistakes_.empty(); }
  std::size_t count() const { return mistakes_.size(); }

  // One line for each mistake, "FILE:LINE: FIELD: WHAT", ordered by line; long lists are truncated. The
  // code is that of the first. Requires at least one mistake.
  Error error() const;

 private:
  struct Mistake {
    int line;
    Error error;
  };

  std::string file_;
  std::vector<Mistake> mistakes_;
};

}  // namespace tessera::core
