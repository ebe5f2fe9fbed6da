// SPDX-License-Identifier: Apache-2.0
// The image of a local render as a file to download.
#pragma once

#include "client/page/local_job.hpp"
#include "core/http/server.hpp"
#include "core/scene/render_record.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::client {

// What the headers of OpenEXR files say.
struct ImageHeader {
  core::RenderRecord record;          // as if the image were complete
  core::TextAttributes attributes{};  // besides
};

// What the parameters `format`, `exposure`, `tone_curve`, `layer` and `region` of the request ask for.
// Without `layer`, it is what `-o` writes.
core::Result<http::Response> local_image(const LocalJob& job, view::TileSource& source,
                                         const ImageHeader& header, const http::Request& request);

}  // namespace tessera::client
