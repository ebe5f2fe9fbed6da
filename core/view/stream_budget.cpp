// SPDX-License-Identifier: Apache-2.0
#include "core/view/stream_budget.hpp"

namespace tessera::view {

bool StreamBudget::Share::may_send(Clock::time_point now) {
  const double seconds = std::chrono::duration<double>(now - refilled_at_).count();
  refilled_at_ = now;
  // What is not used in a second is lost, but for the first bytes.
  credit_ = std::min(credit_ + rate() * seconds, std::max(credit_, rate()));
  return credit_ > 0;
}

StreamBudget::Clock::time_point StreamBudget::Share::next_time() const {
  if (credit_ > 0) return refilled_at_;
  constexpr double kBatchSeconds = 0.25;
  const std::chrono::duration<double> wait(kBatchSeconds - credit_ / rate());
  return refilled_at_ + std::chrono::duration_cast<Clock::duration>(wait);
}

}  // namespace tessera::view
