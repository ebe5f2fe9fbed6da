// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/mistakes.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kMaxListed = 20;

}  // namespace

void Mistakes::add(const Place& place, std::string_view what, ErrorCode code) {
  const std::string where = place.field.empty() ? "" : place.field + ": ";
  mistakes_.push_back(
      {place.line, Error{code, fmt::format("{}:{}: {}{}", file_, place.line, where, printable(what))}});
}

Error Mistakes::error() const {
  std::vector<Mistake> ordered = mistakes_;
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const Mistake& a, const Mistake& b) { return a.line < b.line; });
  Error all = ordered.front().error;
  for (std::size_t i = 1; i < std::min(ordered.size(), kMaxListed); ++i)
    all.message += "\n" + ordered[i].error.message;
  if (ordered.size() > kMaxListed)
    all.message += fmt::format("\n{}: and {} more mistakes", file_, ordered.size() - kMaxListed);
  return all;
}

}  // namespace tessera::core
