// SPDX-License-Identifier: Apache-2.0
// NanoVDB grids and files in memory, for tests.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

namespace tessera::core::test {

template <typename T>
void put_bytes(std::string& bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

// A grid of floats with one node of each level, from the index (0, 0, 0) on. Indices are placed at
// index / 2 + (1, 2, 3).
struct NanoVdbGridBytes {
  static constexpr std::size_t kRoot = 736, kUpper = kRoot + 96, kLower = kUpper + 270400,
                               kLeaf = kLower + 33856, kBytes = kLeaf + 2144;
  static constexpr std::size_t kLowerMask = kLower + 544, kLowerValues = kLower + 1088,
                               kLeafValues = kLeaf + 96;

  // Voxels of the leaf have the values x + 10 y + 100 z.
  NanoVdbGridBytes() : bytes(kBytes, '\0') {
    std::memcpy(bytes.data(), "NanoVDB0", 8);
    put_bytes(bytes, 16, std::uint32_t{32} << 21);  // the version
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put_bytes(bytes, 296 + 88 + 32 * axis, 0.5);
      put_bytes(bytes, 296 + 232 + 8 * axis, static_cast<double>(axis) + 1);
    }
    put_bytes(bytes, 632, std::uint32_t{2});  // a fog volume
    put_bytes(bytes, 636, std::uint32_t{1});  // of floats
    put_bytes(bytes, 672 + 24, std::uint64_t{kRoot - 672});
    set_last({7, 7, 7});
    put_bytes(bytes, kRoot + 24, std::uint32_t{1});
    put_bytes(bytes, kRoot + 64 + 8, std::int64_t{kUpper - kRoot});
    bytes[kUpper + 4128] = 1;
    put_bytes(bytes, kUpper + 8256, std::int64_t{kLower - kUpper});
    bytes[kLowerMask] = 1;
    put_bytes(bytes, kLowerValues, std::int64_t{kLeaf - kLower});
    for (std::size_t i = 0; i < 512; ++i)
      put_bytes(bytes, kLeafValues + 4 * i, static_cast<float>(i / 64 + 10 * (i / 8 % 8) + 100 * (i % 8)));
  }

  void set_last(std::array<std::int32_t, 3> index) {
    for (std::size_t axis = 0; axis < 3; ++axis) put_bytes(bytes, kRoot + 12 + 4 * axis, index[axis]);
  }

  std::string bytes;
};

// A file with one grid, whose stored bytes have been compressed as `codec` says: 0 for none, 1 for zlib after
// their number in 8 bytes.
inline std::string nanovdb_file(const std::string& name, const std::string& stored, std::size_t size,
                                std::uint16_t codec = 0) {
  std::string file(16 + 176, '\0');
  std::memcpy(file.data(), "NanoVDB0", 8);
  put_bytes(file, 12, std::uint16_t{1});
  put_bytes(file, 14, codec);
  put_bytes(file, 16, std::uint64_t{size});
  put_bytes(file, 16 + 8, std::uint64_t{stored.size()});
  put_bytes(file, 16 + 136, static_cast<std::uint32_t>(name.size() + 1));
  put_bytes(file, 16 + 168, codec);
  return file + name + '\0' + stored;
}

}  // namespace tessera::core::test
