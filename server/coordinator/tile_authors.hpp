// Who rendered a stored tile, as bytes and back.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/scheduler/events.hpp"

namespace tessera::coordinator {

struct Authored {
  // Fingerprinter::check() of whoever made the fingerprints.
  std::uint64_t fingerprinter = 0;
  std::vector<scheduler::AuthoredItem> items;
};

// To be appended to the tile's RenderedItem.
std::string encode_authors(const Authored& authored);
// Of bytes that encode_authors() made and whatever stands before them. What cannot be is left out.
Authored decode_authors(int tile, const std::string& bytes);

}  // namespace tessera::coordinator
