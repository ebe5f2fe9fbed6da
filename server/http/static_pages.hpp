// SPDX-License-Identifier: Apache-2.0
// What needs no credentials: the files of the page, and whether the coordinator is alive and ready.
#pragma once

#include "core/http/server.hpp"
#include "server/rpc/readiness.hpp"

namespace tessera::http_api {

http::Response serve_page(const http::Request& request, const rpc::Readiness& readiness);

}  // namespace tessera::http_api
