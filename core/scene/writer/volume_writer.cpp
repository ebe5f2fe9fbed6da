// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/volume_writer.hpp"

#include <bit>
#include <cstdint>

namespace tessera::core {
namespace {

void append_word(std::string& bytes, std::uint32_t bits) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 0xff);
}

}  // namespace

std::string write_volume(const VoxelGrid& grid) {
  constexpr std::uint32_t kFloatEncoding = 1;
  std::string bytes = "VOL\3";
  append_word(bytes, kFloatEncoding);
  for (const std::uint32_t size : grid.size) append_word(bytes, size);
  append_word(bytes, grid.channels);
  for (const float bound : {0.0f, 0.0f, 0.0f, 1.0f, 1.0f, 1.0f})
    append_word(bytes, std::bit_cast<std::uint32_t>(bound));
  for (const float value : grid.values) append_word(bytes, std::bit_cast<std::uint32_t>(value));
  return bytes;
}

}  // namespace tessera::core
