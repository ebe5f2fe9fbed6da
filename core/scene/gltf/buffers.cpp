// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/buffers.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/scene/gltf/meshopt.hpp"
#include "core/scene/gltf/uri.hpp"
#include "core/scene/loader/file_names.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {

BufferView Buffers::view(const Value& index) {
  const Value view = document_.element("bufferViews", index);
  for (const char* meshopt : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (const Value extension = view.extension(meshopt); extension.exists())
      return decompressed(view, extension);
  return plain_view(view);
}

BufferView Buffers::plain_view(const Value& view) {
  return {part(view), static_cast<std::size_t>(view.whole_or("byteStride", 0))};
}

// The bytes of a buffer from byteOffset on.
std::string_view Buffers::part(const Value& place) {
  const Value index = place["buffer"];
  if (!index.exists()) place.refuse("names no buffer");
  const std::string_view bytes = buffer(index);
  const std::uint64_t offset = place.whole_or("byteOffset", 0), length = place.whole_or("byteLength", 0);
  if (offset > bytes.size() || length > bytes.size() - offset)
    place.refuse(fmt::format("{} bytes from byte {} reach beyond the buffer, which has {}", length, offset,
                             bytes.size()));
  return bytes.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

std::string_view Buffers::buffer(const Value& index) {
  const Value buffer = document_.element("buffers", index);
  const std::uint64_t length = buffer.whole_or("byteLength", 0);
  const bool in_file = index.whole() == 0 && !buffer["uri"].exists() && document_.binary_chunk();
  std::string_view bytes;
  if (in_file) {
    bytes = *document_.binary_chunk();
  } else {
    auto known = buffers_.find(index.whole());
    if (known == buffers_.end()) known = buffers_.emplace(index.whole(), read_uri(buffer)).first;
    bytes = known->second;
  }
  if (length > bytes.size() && truncated_.insert(index.whole()).second)
    document_.warn(buffer, "truncated buffer",
                   fmt::format("is truncated: it has {} bytes, and byteLength says {}; what lies beyond is "
                               "left out",
                               bytes.size(), length));
  return bytes.substr(0, static_cast<std::size_t>(length));
}

std::string Buffers::read_uri(const Value& buffer) {
  const std::string uri = buffer.text("uri");
  if (uri.empty()) buffer.refuse("has neither a uri nor a BIN chunk");
  if (is_data_uri(uri)) {
    auto bytes = decode_data_uri(uri);
    if (!bytes) buffer["uri"].refuse("is not a data URI in base64");
    return std::move(*bytes);
  }
  if (has_scheme(uri)) buffer["uri"].refuse("is no file; save the file with its buffers beside it");
  SceneBuilder& builder = document_.builder();
  const auto path = builder.find(decode_percent(uri), builder.scene_path());
  if (!path) buffer["uri"].refuse(fmt::format("there is no file {}", in_quotes(uri)), ErrorCode::kNotFound);
  auto bytes = builder.read(*path);
  if (!bytes) buffer["uri"].refuse(bytes.error().message, bytes.error().code);
  return std::move(*bytes);
}

BufferView Buffers::decompressed(const Value& view, const Value& extension) {
  const MeshoptStream stream = read_meshopt_stream(extension, part(extension));
  constexpr std::uint64_t kMaxDecompressed = std::uint64_t{8} << 30;  // views can share compressed bytes
  auto known = decompressed_views_.find(view.path());
  if (known == decompressed_views_.end()) {
    decompressed_ += std::uint64_t{stream.count} * stream.stride;
    if (decompressed_ > kMaxDecompressed)
      extension.refuse("its views take too much memory", ErrorCode::kResourceExhausted);
    known = decompressed_views_.emplace(view.path(), decode_meshopt(extension, stream)).first;
  }
  return {known->second, stream.stride};
}

}  // namespace tessera::core::gltf
