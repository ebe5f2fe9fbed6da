// SPDX-License-Identifier: Apache-2.0
// Buffer views compressed by EXT_meshopt_compression (Kapoulkine 2021). Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/scene/gltf/value.hpp"

namespace tessera::core::gltf {

// A compressed view as its extension describes it.
struct MeshoptStream {
  std::string_view bytes;
  std::size_t stride = 0, count = 0;  // of the decompressed elements
  std::string mode, filter;
};

// Throws a Refusal if the codec does not allow these parameters, or so few bytes for them.
MeshoptStream read_meshopt_stream(const Value& extension, std::string_view bytes);

// count * stride bytes. Throws a Refusal if the stream is damaged.
std::string decode_meshopt(const Value& extension, const MeshoptStream& stream);

}  // namespace tessera::core::gltf
