// SPDX-License-Identifier: Apache-2.0
// A call of the HTTP API while it is in progress, and what all of them share.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/http/server.hpp"
#include "server/http/activity.hpp"
#include "server/http/delayed_answers.hpp"
#include "server/http/farm_events.hpp"
#include "server/http/sessions.hpp"
#include "server/http/tile_views.hpp"
#include "server/rpc/call_stats.hpp"
#include "server/rpc/services.hpp"

namespace tessera::http_api {

// What all calls share. Thread-safe.
struct Context {
  Context(const rpc::Services& s, const std::vector<std::string>& routes,
          const std::filesystem::path& sessions_file)
      : services(s), calls(routes), sessions(sessions_file), tiles(s.coordinator.tile_feed()) {}

  const rpc::Services services;
  rpc::CallStats calls;  // by route
  Sessions sessions;
  DelayedAnswers delayed;
  EventTexts event_texts;
  TileViews tiles;
  ActivityLog activity;
};

// A call that was admitted. Whoever holds it keeps its share of the calls in progress, and it counts as in
// progress.
struct Call {
  Call(std::shared_ptr<Context> c, const http::Request& r, auth::Admission a, const std::string& route)
      : kept(std::move(c)),
        context(*kept),
        request(r),
        admission(std::move(a)),
        timer(kept->calls.of(route)) {}

  const std::shared_ptr<Context> kept;  // a call may end after the API
  Context& context;
  http::Request request;
  std::map<std::string, std::string> names;  // those in the path: "id"
  const auth::Admission admission;
  rpc::CallTimer timer;

  const auth::Principal& caller() const { return admission.caller; }
  const std::string& id() const { return names.at("id"); }
  const rpc::Services& services() const { return context.services; }
  server::Coordinator& coordinator() const { return context.services.coordinator; }
};
using CallPtr = std::shared_ptr<Call>;

using Answer = core::Result<http::Response>;

// What the caller shows: its token, that of its session, or its certificate.
auth::CallerShown shown_by(Context& context, const http::Request& request);

// The cookie of a session.
inline constexpr const char* kSessionCookie = "tessera_session";

// A body in memory that keeps its share of the answers that nobody has read yet (StreamLimits::answers).
// TRY_LATER if the caller has too many of them.
Answer hold_answer(const CallPtr& call, http::Response response);

}  // namespace tessera::http_api
