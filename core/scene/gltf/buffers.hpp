// SPDX-License-Identifier: Apache-2.0
// Buffers and buffer views of a glTF file, read and decompressed when they are first asked for. Every offset
// and length is checked. Not thread-safe; functions throw Refusals.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "core/scene/gltf/document.hpp"

namespace tessera::core::gltf {

struct BufferView {
  std::string_view bytes;
  std::size_t stride = 0;  // of elements, in bytes; 0: they follow each other
};

class Buffers {
 public:
  explicit Buffers(const Document& document) : document_(document) {}

  // The view that `index` names. Valid as long as this object.
  BufferView view(const Value& index);

 private:
  std::string_view buffer(const Value& index);
  std::string read_uri(const Value& buffer);
  BufferView plain_view(const Value& view);
  BufferView decompressed(const Value& view, const Value& extension);
  std::string_view part(const Value& place);

  const Document& document_;
  std::map<std::uint64_t, std::string> buffers_;  // those not in the file itself
  std::set<std::uint64_t> truncated_;
  std::map<std::string, std::string> decompressed_views_;  // by path: those of meshopt.hpp
  std::uint64_t decompressed_ = 0;                         // bytes of them
};

}  // namespace tessera::core::gltf
