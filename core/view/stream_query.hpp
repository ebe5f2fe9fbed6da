// SPDX-License-Identifier: Apache-2.0
// What a viewer asks of the tile stream: `since`, `level`, `region`, `layer` and `format` of the URL.
#pragma once

#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/film/region.hpp"
#include "core/http/server.hpp"
#include "core/view/shown_layer.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::view {

struct StreamQuery {
  Revision since = 0;
  int level = 0;
  std::optional<core::PixelRect> region{};  // in pixels of the whole image
  ShownLayer layer{};
};

// INVALID_ARGUMENT names the parameter.
core::Result<StreamQuery> parse_stream_query(const http::Request& request);

// "x0,y0,x1,y1", which must not be empty. INVALID_ARGUMENT names `region`.
core::Result<core::PixelRect> parse_region(const std::string& text);

// A whole number in [least, most]; INVALID_ARGUMENT names the parameter.
core::Result<long long> parse_parameter(const std::string& name, const std::string& text, long long least,
                                        long long most);

}  // namespace tessera::view
