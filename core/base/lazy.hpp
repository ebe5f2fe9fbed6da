// SPDX-License-Identifier: Apache-2.0
// A value that the first thread to request it computes once; other threads wait.
#pragma once

#include <memory>
#include <mutex>

namespace tessera::core {

template <typename T>
class Lazy {
 public:
  // `make` returns a T. It is not called if the value exists already.
  template <typename Make>
  const T& get(const Make& make) const {
    std::call_once(state_->once, [&] { state_->value = make(); });
    return state_->value;
  }

 private:
  struct State {
    std::once_flag once;
    T value;
  };
  std::unique_ptr<State> state_ = std::make_unique<State>();
};

}  // namespace tessera::core
