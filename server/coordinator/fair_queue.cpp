#include "server/coordinator/fair_queue.hpp"

#include <algorithm>
#include <list>
#include <mutex>
#include <utility>
#include <vector>

namespace tessera::coordinator {

struct FairQueue::Held::State : std::enable_shared_from_this<State> {
  State(std::uint64_t all, std::uint64_t max_waiting) : share(all), places(max_waiting) {}

  // Grants what can be granted.
  void serve();

  struct Waiting {
    const void* who;
    std::string caller;
    std::uint64_t amount;
    Granted granted;
    FairShare::Held place;
  };
  FairShare share, places;
  std::mutex mutex;
  std::list<Waiting> waiting;  // guarded by mutex; in order of arrival
};

void FairQueue::Held::State::serve() {
  std::vector<std::pair<Granted, Held>> grants;
  {
    const std::lock_guard lock(mutex);
    for (auto next = waiting.begin(); next != waiting.end();) {
      auto held = share.take(next->caller, next->amount);
      if (!held && share.held_by(next->caller) == 0) break;
      if (held) grants.emplace_back(std::move(next->granted), Held(shared_from_this(), *std::move(held)));
      next = held ? waiting.erase(next) : std::next(next);
    }
  }
  for (auto& [granted, held] : grants) granted(std::move(held));
}

FairQueue::FairQueue(std::uint64_t all, std::uint64_t max_waiting)
    : state_(std::make_shared<Held::State>(all, max_waiting)) {}

bool FairQueue::wait(const void* who, const std::string& caller, std::uint64_t amount, Granted granted) {
  auto place = state_->places.take(caller);
  if (!place) return false;
  {
    const std::lock_guard lock(state_->mutex);
    state_->waiting.push_back({who, caller, amount, std::move(granted), *std::move(place)});
  }
  const std::shared_ptr<Held::State> state = state_;
  state->serve();
  return true;
}

bool FairQueue::leave(const void* who) {
  std::list<Held::State::Waiting> left;  // destroyed outside the lock
  {
    const std::lock_guard lock(state_->mutex);
    auto& waiting = state_->waiting;
    const auto found =
        std::find_if(waiting.begin(), waiting.end(), [&](const auto& each) { return each.who == who; });
    if (found == waiting.end()) return false;
    left.splice(left.end(), waiting, found);
  }
  state_->serve();  // it may have held up others
  return true;
}

std::uint64_t FairQueue::held() const {
  return state_->share.held();
}

FairQueue::Held::Held(std::shared_ptr<State> state, FairShare::Held held)
    : state_(std::move(state)), held_(std::move(held)) {}

FairQueue::Held::~Held() {
  if (!state_) return;
  held_.reset();
  state_->serve();
}

}  // namespace tessera::coordinator
