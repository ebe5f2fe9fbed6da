// SPDX-License-Identifier: Apache-2.0
// Writes procedural textures. Stateless; thread-safe.
#pragma once

#include <string>

#include "core/scene/writer/table_text.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// The texture, which must be procedural, as an object of a scene file. Its inputs must have names.
std::string pattern_text(const Texture& texture, const SceneNames& names);

}  // namespace tessera::core
