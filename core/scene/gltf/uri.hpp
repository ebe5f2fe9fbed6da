// SPDX-License-Identifier: Apache-2.0
// URIs of buffers and images. Stateless; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tessera::core::gltf {

inline bool is_data_uri(std::string_view uri) {
  return uri.starts_with("data:");
}
// The bytes of a data URI (Masinter 1998), in base64 or percent-encoded; nullopt if it is malformed.
std::optional<std::string> decode_data_uri(std::string_view uri);

// Whether the URI names something else than a file: "https://...".
bool has_scheme(std::string_view uri);

}  // namespace tessera::core::gltf
