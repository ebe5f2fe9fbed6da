// SPDX-License-Identifier: Apache-2.0
// The workers of a farm, page by page.
#pragma once

#include "client/farm/farm.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::client {

// All workers that the request is for, in the order of their ids. Blocks as Farm::call() does, for each page.
core::Result<v1::ListWorkersResponse> list_workers(Farm& farm, v1::ListWorkersRequest request);

}  // namespace tessera::client
