// SPDX-License-Identifier: Apache-2.0
// Who rendered a stored tile, as bytes and back.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/scheduler/events.hpp"

namespace tessera::coordinator {

struct Produced {
  // Fingerprinter::check() of whoever made the fingerprints.
  std::uint64_t fingerprinter = 0;
  std::vector<scheduler::ProducedItem> items;
};

// To be appended to the tile's RenderedItem.
std::string encode_provenance(const Produced& provenance);
// Of bytes that encode_provenance() made and whatever stands before them. What cannot be is left out.
Produced decode_provenance(int tile, const std::string& bytes);

}  // namespace tessera::coordinator
