// SPDX-License-Identifier: Apache-2.0
// Encodes and decodes the producers of a stored tile.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/scheduler/events.hpp"

namespace tessera::film {

struct Produced {
  // Fingerprinter::check() of the secret that made the fingerprints.
  std::uint64_t fingerprinter = 0;
  std::vector<scheduler::ProducedItem> items;
};

// The bytes to append to the tile's RenderedItem.
std::string encode_provenance(const Produced& provenance);
// Decodes bytes of encode_provenance() with any bytes before them. Invalid items are left out.
Produced decode_provenance(int tile, const std::string& bytes);

}  // namespace tessera::film
