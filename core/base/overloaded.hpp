// SPDX-License-Identifier: Apache-2.0
// One callable from several lambdas, for std::visit.
#pragma once

namespace tessera::core {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
// Clang before 17 does not deduce the arguments of aggregates by itself.
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace tessera::core
