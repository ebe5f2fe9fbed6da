// SPDX-License-Identifier: Apache-2.0
// The JSON Schema of scene files, as in scenes/scene.schema.json.
#pragma once

namespace tessera::client {

const char* scene_schema();

}  // namespace tessera::client
