// SPDX-License-Identifier: Apache-2.0
// Protection against other web sites in the browsers of users. Pure functions.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "core/http/server.hpp"

namespace tessera::http_api {

// The header that every change must have. Other sites cannot send it without our permission (CORS), which is
// never given.
inline constexpr const char* kChangeHeader = "x-tessera";

// PERMISSION_DENIED if a change has no kChangeHeader, or comes from a page of another site.
core::Status check_origin(const http::Request& request);

// PERMISSION_DENIED if the request names a host that is neither an IP address, nor localhost, nor `own_host`:
// another site whose name was rebound to this machine (DNS rebinding).
core::Status check_host(const http::Request& request, const std::string& own_host);

// "render" of "render:7480", "[::1]" of "[::1]:7480".
std::string host_of(const std::string& host_and_port);

}  // namespace tessera::http_api
