// SPDX-License-Identifier: Apache-2.0
// A value that is made when it is first asked for, once, by whichever thread asks first; the others wait.
#pragma once

#include <memory>
#include <mutex>

namespace tessera::core {

template <typename T>
class Lazy {
 public:
  // `make` answers a T. Of a value that was made before, it is not called.
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
