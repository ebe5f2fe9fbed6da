// SPDX-License-Identifier: Apache-2.0
// The container of .glb files (Khronos Group 2021, glTF 2.0 specification, section 4). Stateless;
// thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core::gltf {

struct BinaryParts {
  std::string_view json;
  std::optional<std::string_view> binary;  // the BIN chunk
};

// Whether these are the bytes of a .glb file.
bool is_binary(std::string_view bytes);

// The parts of a .glb file, which refer to `bytes`. INVALID_ARGUMENT says what is wrong with it.
Result<BinaryParts> split_binary(std::string_view bytes);

// A .glb file of these parts.
std::string join_binary(std::string_view json, std::optional<std::string_view> binary);

}  // namespace tessera::core::gltf
