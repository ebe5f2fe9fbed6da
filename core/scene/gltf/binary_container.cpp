// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/binary_container.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

constexpr std::string_view kBinaryMagic = "glTF";
constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i)
    word |= std::uint32_t{static_cast<unsigned char>(bytes[offset + i])} << (8 * i);
  return word;
}

void append_word(std::string& bytes, std::size_t word) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(word >> shift & 0xff));
}

std::size_t padded(std::size_t size) {
  return size + (4 - size % 4) % 4;
}

void append_chunk(std::string& bytes, std::uint32_t type, std::string_view chunk, char filler) {
  append_word(bytes, padded(chunk.size()));
  append_word(bytes, type);
  bytes += chunk;
  bytes.append(padded(chunk.size()) - chunk.size(), filler);
}

}  // namespace

bool is_binary(std::string_view bytes) {
  return bytes.starts_with(kBinaryMagic);
}

Result<BinaryParts> split_binary(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes) return mistake("is truncated in its header");
  if (const std::uint32_t version = word_at(bytes, 4); version != 2)
    return mistake(fmt::format("is a binary glTF file of version {}; only version 2 can be read", version));
  const std::size_t length = word_at(bytes, 8);
  if (length > bytes.size())
    return mistake(
        fmt::format("is truncated: it has {} bytes, and its header says {}", bytes.size(), length));
  std::optional<std::string_view> json, binary;
  for (std::size_t at = kHeaderBytes; at + kChunkHeaderBytes <= length;) {
    const std::size_t size = word_at(bytes, at);
    const std::uint32_t type = word_at(bytes, at + 4);
    at += kChunkHeaderBytes;
    if (size > length - at) return mistake("has a chunk that reaches beyond its end");
    const std::string_view chunk = bytes.substr(at, size);
    if (type == kJsonChunk && !json) json = chunk;
    if (type == kBinaryChunk && !binary) binary = chunk;
    at += padded(size);
  }
  if (!json) return mistake("is a binary glTF file without a JSON chunk");
  // Some writers fill it up with NUL instead of blanks.
  return BinaryParts{json->substr(0, json->find_last_not_of('\0') + 1), binary};
}

std::string join_binary(std::string_view json, std::optional<std::string_view> binary) {
  const std::size_t binary_size = binary ? kChunkHeaderBytes + padded(binary->size()) : 0;
  std::string bytes(kBinaryMagic);
  append_word(bytes, 2);
  append_word(bytes, kHeaderBytes + kChunkHeaderBytes + padded(json.size()) + binary_size);
  append_chunk(bytes, kJsonChunk, json, ' ');
  if (binary) append_chunk(bytes, kBinaryChunk, *binary, '\0');
  return bytes;
}

}  // namespace tessera::core::gltf
