// SPDX-License-Identifier: Apache-2.0
// Converts the producers of a tile to and from those of the store. Pure functions.
#pragma once

#include <cstdint>
#include <vector>

#include "server/scheduler/events.hpp"
#include "server/store/stored.pb.h"

namespace tessera::film {

struct Produced {
  // Fingerprinter::check() of the secret that made the fingerprints.
  std::uint64_t fingerprinter = 0;
  std::vector<scheduler::ProducedItem> items;
};

stored::v1::Provenance to_stored(const Produced& provenance);
// Invalid items are left out.
Produced from_stored(int tile, const stored::v1::Provenance& stored);

}  // namespace tessera::film
