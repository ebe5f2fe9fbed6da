// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file: its encoding, elements and properties. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::core {

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::size_t size_of(PlyType type);
inline bool is_floating_point(PlyType type) {
  return type == PlyType::kFloat || type == PlyType::kDouble;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat;  // of the values
  bool is_list = false;            // a count, then as many values
  PlyType count_type = PlyType::kUint8;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  // The bytes of a row in a binary file; of a row with empty lists if it has any.
  std::size_t row_bytes() const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::vector<std::string> images;  // of "comment TextureFile" lines, as written
  std::size_t size = 0;             // of the header; the first element's rows follow
};

// Errors complete a sentence that begins with the file's name.
Result<PlyHeader> read_ply_header(std::string_view bytes);

}  // namespace tessera::core
