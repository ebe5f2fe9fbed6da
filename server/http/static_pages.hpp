// SPDX-License-Identifier: Apache-2.0
// What needs no credentials: the files of the page, and whether the coordinator is well.
#pragma once

#include "core/http/server.hpp"

namespace tessera::http_api {

http::Response serve_page(const http::Request& request);

}  // namespace tessera::http_api
