// SPDX-License-Identifier: Apache-2.0
// Misspelt keys of a glTF file. Stateless.
#pragma once

#include "core/scene/gltf/document.hpp"

namespace tessera::core::gltf {

// Warns of the keys of the document's JSON that glTF 2.0 and the extensions that are read do not have.
void tell_unknown_keys(const Document& document, const JsonValue& json);

}  // namespace tessera::core::gltf
