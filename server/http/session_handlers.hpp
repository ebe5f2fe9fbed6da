// SPDX-License-Identifier: Apache-2.0
// The routes of sessions, which callers without credentials may use.
#pragma once

#include "server/http/call.hpp"

namespace tessera::http_api {

inline constexpr const char* kSessionPath = "/api/v1/session";

// POST opens a session for the token in the body, DELETE ends it, GET says who the caller is.
http::Response handle_session(Context& context, const http::Request& request);

// The response to a call that is not admitted. It is delayed if the machine is rejected often.
http::Response reject_call(Context& context, auth::Rejection rejection);

}  // namespace tessera::http_api
