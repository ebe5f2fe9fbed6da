// SPDX-License-Identifier: Apache-2.0
// A film tile as it travels: its sums in planes with their XXH3-64, as worker_service.proto says. Pure
// functions.
#pragma once

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::proto {

// `tile` lies in one grid tile.
v1::RenderedItem encode_tile(const core::FilmTile& tile);

// Never allocates more than one grid tile's sums, whatever is claimed. INVALID_ARGUMENT: rectangle or range
// cannot be, the frame is damaged or of another size, the checksum is wrong, the counters do not belong to
// these samples.
core::Result<core::FilmTile> decode_tile(const v1::RenderedItem& item);

}  // namespace tessera::proto
