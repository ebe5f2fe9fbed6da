// SPDX-License-Identifier: Apache-2.0
// The limit on what is watched at once.
#pragma once

#include "core/base/error.hpp"
#include "server/http/call.hpp"

namespace tessera::http_api {

// A share of what may be watched at once. TRY_LATER if the caller has too many.
core::Result<base::FairShare::Held> take_watch(const Call& call);

}  // namespace tessera::http_api
