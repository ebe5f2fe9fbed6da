// SPDX-License-Identifier: Apache-2.0
// Reads scene files of our own format: JSON with comments, which scenes/scene.schema.json describes.
// Thread-safe.
#pragma once

#include "core/scene/import/front_ends.hpp"

namespace tessera::core {

ReadScene read_json_scene;

}  // namespace tessera::core
