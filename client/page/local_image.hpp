// SPDX-License-Identifier: Apache-2.0
// The image of a local render as a file to download.
#pragma once

#include "client/page/local_job.hpp"
#include "core/http/server.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::client {

// What the parameters `format`, `exposure`, `tone_curve` and `region` of the request ask for.
core::Result<http::Response> local_image(const LocalJob& job, view::TileSource& source,
                                         const http::Request& request);

}  // namespace tessera::client
