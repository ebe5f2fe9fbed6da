// One callable from several lambdas, for std::visit.
#pragma once

namespace tessera::core {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

}  // namespace tessera::core
