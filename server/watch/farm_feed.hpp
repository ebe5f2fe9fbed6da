// SPDX-License-Identifier: Apache-2.0
// What has changed in a farm since some cursor, as messages. Each is made once for all who ask with the same
// cursor, as those who keep up do. Thread-safe.
#pragma once

#include <deque>
#include <future>
#include <memory>
#include <string>

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

  using Update = core::Result<std::shared_ptr<const FarmUpdate>>;

  // The changes after the cursor, or the first of them. They may have been read a moment ago, for somebody
  // else: has_changes_after() their end tells whether there are more. Fails if a job cannot be read from the
  // store.
  Update after(const events::Cursor& cursor);
  bool has_changes_after(const events::Cursor& cursor) const { return log_.has_changes_after(cursor); }

 private:
  // An update that is made, or is being made by one of those who wait for it.
  struct Shared {
    events::Cursor from;
    std::shared_future<Update> update;
  };

  Update make(const events::Cursor& cursor);
  // Empty if the caller must make it.
  std::shared_future<Update> find_or_enter(const events::Cursor& cursor, std::promise<Update>& promise);
  void remove(const events::Cursor& cursor);
  core::Status add_job(const std::string& id, v1::WatchFarmResponse& message);
  void add_worker(const std::string& id, v1::WatchFarmResponse& message);

  const events::EventLog& log_;
  jobs::JobService& jobs_;
  dispatch::Dispatcher& dispatcher_;
  core::Mutex mutex_;
  std::deque<Shared> last_ TESSERA_GUARDED_BY(mutex_);  // the latest first
};

}  // namespace tessera::watch
