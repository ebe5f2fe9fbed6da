// SPDX-License-Identifier: Apache-2.0
#include "server/base/fair_queue.hpp"

#include <algorithm>
#include <list>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/mutex.hpp"

namespace tessera::base {

struct FairQueue::State {
  explicit State(std::uint64_t max_waiting) : places(max_waiting) {}

  // Grants all requests that can be granted.
  void serve();

  struct Waiting {
    const void* who;
    std::string caller;
    std::uint64_t amount;
    Granted granted;
    FairShare::Held place;
  };
  std::optional<FairShare> share;  // set by the constructor
  FairShare places;
  core::Mutex mutex;
  std::list<Waiting> waiting TESSERA_GUARDED_BY(mutex);  // in order of arrival
};

void FairQueue::State::serve() {
  std::vector<std::pair<Granted, FairShare::Held>> grants;
  {
    const core::MutexLock lock(mutex);
    for (auto next = waiting.begin(); next != waiting.end();) {
      auto held = share->take(next->caller, next->amount);
      if (!held && share->held_by(next->caller) == 0) break;
      if (held) grants.emplace_back(std::move(next->granted), *std::move(held));
      next = held ? waiting.erase(next) : std::next(next);
    }
  }
  for (auto& [granted, held] : grants) granted(std::move(held));
}

// A grant may be given back after the queue is destroyed, when nobody waits any more.
FairQueue::FairQueue(std::uint64_t all, std::uint64_t max_waiting)
    : state_(std::make_shared<State>(max_waiting)) {
  state_->share.emplace(all, [queue = std::weak_ptr<State>(state_)] {
    if (const auto state = queue.lock()) state->serve();
  });
}

bool FairQueue::wait(const void* who, const std::string& caller, std::uint64_t amount, Granted granted) {
  auto place = state_->places.take(caller);
  if (!place) return false;
  {
    const core::MutexLock lock(state_->mutex);
    state_->waiting.push_back({who, caller, amount, std::move(granted), *std::move(place)});
  }
  const std::shared_ptr<State> state = state_;
  state->serve();
  return true;
}

bool FairQueue::leave(const void* who) {
  std::list<State::Waiting> left;  // destroyed outside the lock
  {
    const core::MutexLock lock(state_->mutex);
    auto& waiting = state_->waiting;
    const auto found =
        std::find_if(waiting.begin(), waiting.end(), [&](const auto& each) { return each.who == who; });
    if (found == waiting.end()) return false;
    left.splice(left.end(), waiting, found);
  }
  state_->serve();  // others may have waited behind it
  return true;
}

std::uint64_t FairQueue::held() const {
  return state_->share->held();
}

}  // namespace tessera::base
