// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/scene_maker.hpp"

#include <span>

#include "sources_hash.hpp"

namespace tessera::core::stored {

std::string_view scene_maker() {
  return TESSERA_VERSION " " TESSERA_SOURCES_HASH;
}

Checksum file_version() {
  return checksum_of(std::as_bytes(std::span(scene_maker())));
}

}  // namespace tessera::core::stored
