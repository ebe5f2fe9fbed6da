// SPDX-License-Identifier: Apache-2.0
#include "core/view/stream_budget.hpp"

namespace tessera::view {

StreamBudget::Clock::time_point StreamBudget::joint_time(Clock::time_point time) const {
  const Clock::duration step = std::chrono::duration_cast<Clock::duration>(poll_interval()) / 8;
  const auto steps = (time.time_since_epoch() + step - Clock::duration(1)) / step;
  return Clock::time_point(steps * step);
}

bool StreamBudget::Share::may_send(Clock::time_point now, bool is_first) {
  const double seconds = std::chrono::duration<double>(now - refilled_at_).count();
  refilled_at_ = now;
  credit_ = std::min(credit_ + rate() * seconds, rate());  // what is not used in a second is lost
  return has_credit(is_first);
}

StreamBudget::Clock::time_point StreamBudget::Share::next_time(bool is_first) const {
  if (has_credit(is_first)) return refilled_at_;
  const std::chrono::duration<double> wait = budget_.poll_interval();
  return refilled_at_ +
         std::chrono::duration_cast<Clock::duration>(wait + std::chrono::duration<double>(-credit_ / rate()));
}

}  // namespace tessera::view
