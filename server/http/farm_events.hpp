// SPDX-License-Identifier: Apache-2.0
// The changes of a farm as server-sent events.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include "core/base/mutex.hpp"

#include "core/base/error.hpp"
#include "core/http/server.hpp"
#include "server/watch/farm_feed.hpp"

namespace tessera::http_api {

struct Call;

// The text of an update, made once for all who are sent the same one. Thread-safe.
class EventTexts {
 public:
  std::shared_ptr<const std::string> of(const std::shared_ptr<const watch::FarmUpdate>& update);

 private:
  core::Mutex mutex_;
  // The last ones.
  std::deque<std::pair<std::shared_ptr<const watch::FarmUpdate>, std::shared_ptr<const std::string>>> last_
      TESSERA_GUARDED_BY(mutex_);
};

// The events of one update: "reset", "jobs", "workers", "removed", as far as there is something to say. The
// last one has the resume token as its id.
std::string to_events(const watch::FarmUpdate& update);

// The resume token in the letters of base64url, and back. Text that is no token becomes the start.
std::string encode_token(const std::string& token);
std::string decode_token(const std::string& text);

// A body that sends the events until the client leaves. TRY_LATER if too many are watched.
core::Result<http::Response> watch_farm(const std::shared_ptr<Call>& call);

}  // namespace tessera::http_api
