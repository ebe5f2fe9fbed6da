// SPDX-License-Identifier: Apache-2.0
// What users ask of jobs. Part of the scheduler.
#pragma once

#include "server/scheduler/auditing.hpp"
#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/jobs.hpp"
#include "server/scheduler/reviews.hpp"

namespace tessera::scheduler {

class JobCommands {
 public:
  JobCommands(FarmState& farm, Jobs& jobs, Reviews& reviews, Auditing& auditing)
      : farm_(farm), jobs_(jobs), reviews_(reviews), auditing_(auditing) {}

  // Each handles one event. Null: no worker awaits a reply.
  Worker* on(const SubmitJob& event, Actions& actions);
  Worker* on(const RestoreJob& event, Actions& actions);
  Worker* on(const ReopenJob& event, Actions& actions);
  Worker* on(const PauseJob& event, Actions& actions);
  Worker* on(const ResumeJob& event, Actions& actions);
  Worker* on(const CancelJob& event, Actions& actions);
  Worker* on(const DeleteJob& event, Actions& actions);
  Worker* on(const ReleaseJob& event, Actions& actions);
  Worker* on(const ExtendJob& event, Actions& actions);
  Worker* on(const UpdateJob& event, Actions& actions);
  Worker* on(const FailJob& event, Actions& actions);

 private:
  FarmState& farm_;
  Jobs& jobs_;
  Reviews& reviews_;
  Auditing& auditing_;
};

}  // namespace tessera::scheduler
