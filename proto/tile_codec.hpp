// SPDX-License-Identifier: Apache-2.0
// Encodes and decodes film tiles for the network: sums in planes with their XXH3-64, as worker_service.proto
// specifies. Pure functions.
#pragma once

#include <cstdint>

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::proto {

// `tile` must lie in one tile of the grid of the image.
v1::RenderedItem encode_tile(const core::FilmTile& tile, std::uint32_t image = 0);

// Never allocates more than the sums and planes of one grid tile, whatever the message claims.
// INVALID_ARGUMENT: the rectangle or range is invalid, the frame is damaged or has another size, the checksum
// is wrong, or the counters do not belong to these samples. The item says of which image the tile is.
// `layers`: those of its job.
core::Result<core::FilmTile> decode_tile(const v1::RenderedItem& item, core::LayerSet layers = {});

// The memory that the words of a message would take, as it claims.
std::uint64_t claimed_bytes(const v1::RenderedItem& item);

}  // namespace tessera::proto
