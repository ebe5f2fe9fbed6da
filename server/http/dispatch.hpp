// SPDX-License-Identifier: Apache-2.0
// How calls are answered: on the pools that answer those of gRPC, with the same limits, and counted.
#pragma once

#include <functional>

#include "server/http/call.hpp"
#include "server/http/routes.hpp"

namespace tessera::http_api {

// The response to a call. Counts it with its status, unless it goes on (Response::later, or a body without a
// known end).
http::Response finish_call(const CallPtr& call, Answer answer);

// A response that is made on another thread.
http::Response answer_later(const CallPtr& call, Where where, std::function<Answer()> work);

// What `work` returns. Exceptions of libraries become errors, too.
Answer guarded_answer(const std::function<Answer()>& work);

}  // namespace tessera::http_api
