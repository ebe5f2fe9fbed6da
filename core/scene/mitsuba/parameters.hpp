// SPDX-License-Identifier: Apache-2.0
// The parameters of a Mitsuba scene, which <default> defines and "$name" uses. Not thread-safe.
#pragma once

#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::core::mitsuba {

class Parameters {
 public:
  // The first definition of a name counts.
  void define(std::string_view name, std::string value);
  // Empty if it is not defined.
  std::string value_of(std::string_view name) const;
  // Those that substitute() has replaced so far, in alphabetical order.
  const std::set<std::string, std::less<>>& used() const { return used_; }
  // `text` with each "$name" replaced, and "\$" as "$". The error is the name of an undefined parameter, or
  // empty if the result is too long.
  tl::expected<std::string, std::string> substitute(std::string_view text) const;

 private:
  using Parameter = std::pair<std::string, std::string>;

  const Parameter* at_start_of(std::string_view text) const;

  std::vector<Parameter> longest_first_;  // the names with '$'
  mutable std::set<std::string, std::less<>> used_;
  mutable std::size_t substituted_ = 0;  // bytes, in all results
};

}  // namespace tessera::core::mitsuba
