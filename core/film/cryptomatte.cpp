// SPDX-License-Identifier: Apache-2.0
#include "core/film/cryptomatte.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <map>

namespace tessera::core {
namespace {

std::uint32_t scrambled(std::uint32_t block) {
  return std::rotl(block * 0xcc9e2d51u, 15) * 0x1b873593u;
}

// Little-endian bytes, at most 4.
std::uint32_t block_of(std::string_view bytes) {
  std::uint32_t block = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) block = block << 8 | static_cast<unsigned char>(bytes[i]);
  return block;
}

std::string json_string(std::string_view text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') json += '\\';
    if (static_cast<unsigned char>(c) < 0x20)
      json += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      json += c;
  }
  return json + "\"";
}

std::string manifest_of(const std::vector<std::string>& names) {
  std::map<std::string, std::uint32_t> ids;
  for (const std::string& name : names) ids.emplace(name, crypto_id(name));
  std::string json = "{";
  for (const auto& [name, id] : ids) {
    if (json.size() > 1) json += ',';
    json += fmt::format("{}:\"{:08x}\"", json_string(name), id);
  }
  return json + "}";
}

}  // namespace

std::uint32_t murmur3_32(std::string_view bytes) {
  std::uint32_t hash = 0;
  std::size_t at = 0;
  for (; at + 4 <= bytes.size(); at += 4) {
    hash ^= scrambled(block_of(bytes.substr(at, 4)));
    hash = std::rotl(hash, 13) * 5 + 0xe6546b64u;
  }
  hash ^= scrambled(block_of(bytes.substr(at)));
  hash ^= static_cast<std::uint32_t>(bytes.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

std::uint32_t crypto_id(std::string_view name) {
  const std::uint32_t hash = murmur3_32(name), exponent = hash >> 23 & 255;
  return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

std::vector<std::pair<std::string, std::string>> crypto_attributes(LayerSet layers,
                                                                   const CryptoNames& names) {
  struct Matte {
    Layer layer;
    const char* name;
    const std::vector<std::string>& names;
  };
  const std::array<Matte, 3> mattes{{{Layer::kCryptoObject, "CryptoObject", names.objects},
                                     {Layer::kCryptoMaterial, "CryptoMaterial", names.materials},
                                     {Layer::kCryptoAsset, "CryptoAsset", names.assets}}};
  std::vector<std::pair<std::string, std::string>> attributes;
  for (const Matte& matte : mattes) {
    if (!layers.has(matte.layer)) continue;
    const std::string key = fmt::format("cryptomatte/{:07x}/", murmur3_32(matte.name) >> 4);
    attributes.emplace_back(key + "name", matte.name);
    attributes.emplace_back(key + "hash", "MurmurHash3_32");
    attributes.emplace_back(key + "conversion", "uint32_to_float32");
    attributes.emplace_back(key + "manifest", manifest_of(matte.names));
  }
  return attributes;
}

}  // namespace tessera::core
