// SPDX-License-Identifier: Apache-2.0
// Cryptomatte (Friedman and Jones 2015, "Fully automatic ID mattes with support for motion blur and
// transparency"; specification 1.2.0): ids of names and the metadata of OpenEXR files. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/film/layers.hpp"

namespace tessera::core {

// MurmurHash3_x86_32 (Appleby 2011) with the seed 0.
std::uint32_t murmur3_32(std::string_view bytes);

// The id of a name: its hash, changed so that its bits are those of a normal float. Not 0.
std::uint32_t crypto_id(std::string_view name);

// The names in a scene, of which the manifests consist; each list may repeat names.
struct CryptoNames {
  std::vector<std::string> objects, materials, assets;
};

// The attributes ("cryptomatte/1a2b3c4/name" and so on) of the layers among kCryptoObject, kCryptoMaterial
// and kCryptoAsset, with manifests of the names, sorted.
std::vector<std::pair<std::string, std::string>> crypto_attributes(LayerSet layers, const CryptoNames& names);

}  // namespace tessera::core
