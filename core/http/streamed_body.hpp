// SPDX-License-Identifier: Apache-2.0
// The body of a response as MHD takes it.
#pragma once

#include <microhttpd.h>

#include <memory>

#include "core/http/connection.hpp"

namespace tessera::http {

// The response without its headers. The caller destroys it; null if there is no memory.
MHD_Response* make_mhd_response(Response response, std::shared_ptr<Connection> connection);

}  // namespace tessera::http
