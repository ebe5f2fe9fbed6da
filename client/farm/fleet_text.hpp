// SPDX-License-Identifier: Apache-2.0
// The text of commands about a farm as a whole: its coordinator and its quarantine. Pure functions.
#pragma once

#include <string>

#include "client/terminal.hpp"
#include "tessera/v1/admin_service.pb.h"
#include "tessera/v1/render_service.pb.h"

namespace tessera::client {

// `now_seconds`: since 1970-01-01 UTC.
std::string quarantine_table(const v1::ListQuarantineResponse& quarantine, double now_seconds,
                             const TextStyle& style = {});

std::string server_description(const v1::GetServerInfoResponse& info, const std::string& address,
                               const TextStyle& style = {});

}  // namespace tessera::client
