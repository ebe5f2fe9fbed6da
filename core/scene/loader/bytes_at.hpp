// SPDX-License-Identifier: Apache-2.0
// Values in the bytes of a file.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string_view>

namespace tessera::core {

static_assert(std::endian::native == std::endian::little, "the byte order of the files that are read so");

// The little-endian value at an offset; nullopt beyond the end.
template <typename T>
std::optional<T> bytes_at(std::string_view bytes, std::size_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < sizeof(T)) return std::nullopt;
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

}  // namespace tessera::core
