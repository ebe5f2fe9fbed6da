// SPDX-License-Identifier: Apache-2.0
#include "server/base/fair_share.hpp"

#include <map>
#include <utility>

#include "core/base/mutex.hpp"

namespace tessera::base {

struct FairShare::Held::State {
  State(std::uint64_t most, std::function<void()> tell) : all(most), given_back(std::move(tell)) {}
  void give_back(const std::string& caller, std::uint64_t amount);

  const std::uint64_t all;
  const std::function<void()> given_back;
  core::Mutex mutex;
  std::uint64_t held TESSERA_GUARDED_BY(mutex) = 0;
  std::map<std::string, std::uint64_t> by_caller TESSERA_GUARDED_BY(mutex);  // without zeros
};

void FairShare::Held::State::give_back(const std::string& caller, std::uint64_t amount) {
  const core::MutexLock lock(mutex);
  held -= amount;
  const auto known = by_caller.find(caller);
  known->second -= amount;
  if (known->second == 0) by_caller.erase(known);
}

FairShare::FairShare(std::uint64_t all, std::function<void()> given_back)
    : state_(std::make_shared<Held::State>(all, std::move(given_back))) {}

std::optional<FairShare::Held> FairShare::take(const std::string& caller, std::uint64_t amount) {
  const core::MutexLock lock(state_->mutex);
  const auto known = state_->by_caller.find(caller);
  const std::uint64_t own = known == state_->by_caller.end() ? 0 : known->second;
  const std::uint64_t left = state_->all > state_->held ? state_->all - state_->held : 0;
  const bool fits = own <= left && amount <= left - own;
  if (!fits && state_->held > 0) return std::nullopt;
  return Held(state_, caller, amount);
}

FairShare::Held FairShare::note(const std::string& caller, std::uint64_t amount) {
  const core::MutexLock lock(state_->mutex);
  return Held(state_, caller, amount);
}

std::uint64_t FairShare::held_by(const std::string& caller) const {
  const core::MutexLock lock(state_->mutex);
  const auto known = state_->by_caller.find(caller);
  return known == state_->by_caller.end() ? 0 : known->second;
}

std::uint64_t FairShare::held() const {
  const core::MutexLock lock(state_->mutex);
  return state_->held;
}

// The caller holds the lock.
FairShare::Held::Held(std::shared_ptr<State> state, std::string caller, std::uint64_t amount)
    : state_(std::move(state)), caller_(std::move(caller)), amount_(amount) {
  if (amount_ == 0) return;
  state_->by_caller[caller_] += amount_;
  state_->held += amount_;
}

FairShare::Held::~Held() {
  if (!state_ || amount_ == 0) return;
  state_->give_back(caller_, amount_);
  if (state_->given_back) state_->given_back();
}

}  // namespace tessera::base
