// SPDX-License-Identifier: Apache-2.0
// Collects what is wrong with a scene file, so that one reading tells every mistake and not only the first.
// Not thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::core {

// Where in a scene file: the line, from 1, and the field as in "materials.stone.albedo" (empty: the whole
// file).
struct Place {
  int line = 0;
  std::string field;
};

class Mistakes {
 public:
  // `file` is what messages call the scene file.
  explicit Mistakes(std::string file) : file_(std::move(file)) {}

  void add(const Place& place, std::string_view what, ErrorCode code = ErrorCode::kInvalidArgument);

  // A mistake whose message says already where it is.
  void add_whole(const Error& error) { mistakes_.push_back({0, error}); }

  bool empty() const { return mistakes_.empty(); }
  std::size_t count() const { return mistakes_.size(); }

  // One line for each mistake, "FILE:LINE: FIELD: WHAT", in the order of lines; the longest lists are cut
  // short. The code is that of the first. Only where there are mistakes.
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
