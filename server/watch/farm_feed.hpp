// SPDX-License-Identifier: Apache-2.0
// What has changed in a farm since some cursor, as messages. Each is made once for all who ask with the same
// cursor, as those who keep up do. Thread-safe.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <utility>

#include "core/base/mutex.hpp"
#include "server/dispatch/dispatcher.hpp"
#include "server/events/event_log.hpp"
#include "server/jobs/job_service.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::watch {

// A cursor as the protocol has it. Bytes that are no token become the start.
std::string to_token(const events::Cursor& cursor);
events::Cursor from_token(const std::string& token);

struct FarmUpdate {
  v1::WatchFarmResponse message;
  events::Cursor next;

  bool is_empty() const {
    return !message.reset() && message.jobs().empty() && message.workers().empty() &&
           message.deleted_job_ids().empty() && message.removed_worker_ids().empty();
  }
};

class FarmFeed {
 public:
  FarmFeed(const events::EventLog& log, jobs::JobService& jobs, dispatch::Dispatcher& dispatcher)
      : log_(log), jobs_(jobs), dispatcher_(dispatcher) {}

  // The changes after the cursor, or the first of them.
  std::shared_ptr<const FarmUpdate> after(const events::Cursor& cursor);

 private:
  void add_job(const std::string& id, v1::WatchFarmResponse& message);
  void add_worker(const std::string& id, v1::WatchFarmResponse& message);

  const events::EventLog& log_;
  jobs::JobService& jobs_;
  dispatch::Dispatcher& dispatcher_;
  core::Mutex mutex_;
  // The last updates with their cursors.
  std::deque<std::pair<events::Cursor, std::shared_ptr<const FarmUpdate>>> last_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::watch
