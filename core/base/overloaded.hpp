// SPDX-License-Identifier: Apache-2.0
// Combines several lambdas into one callable, for std::visit.
#pragma once

namespace tessera::core {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
// Clang before 17 does not deduce the arguments of aggregates.
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace tessera::core
