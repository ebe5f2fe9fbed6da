// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/scene_maker.hpp"

#include "sources_hash.hpp"

namespace tessera::core::stored {

std::string_view scene_maker() {
  return TESSERA_VERSION " " TESSERA_SOURCES_HASH;
}

}  // namespace tessera::core::stored
