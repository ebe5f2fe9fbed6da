// SPDX-License-Identifier: Apache-2.0
// What workers are told, and who of those that wait is told first. Part of the scheduler.
#pragma once

#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/jobs.hpp"

namespace tessera::scheduler {

class Replies {
 public:
  Replies(FarmState& farm, Jobs& jobs) : farm_(farm), jobs_(jobs) {}

  void wake_waiting(Actions& actions);
  Reply reply_to(Worker& worker);
  Reply reply_with_answer(Worker& worker, const SubmitResult& result);
  void tell_to_stop(Worker& worker, Reply& reply);

 private:
  FarmState& farm_;
  Jobs& jobs_;
};

}  // namespace tessera::scheduler
