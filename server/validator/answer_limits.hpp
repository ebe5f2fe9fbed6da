// SPDX-License-Identifier: Apache-2.0
// What the validator may say of a scene: it may have been taken over, and the coordinator keeps what it says.
#pragma once

#include <cstddef>
#include <string_view>

namespace tessera::validator {

inline constexpr std::size_t kMaxResponseBytes = std::size_t{8} << 20;
// Texts for the headers of EXR files, whose other attributes they must not replace.
inline constexpr std::string_view kAttributePrefix = "cryptomatte/";
inline constexpr std::size_t kMaxAttributes = 16, kMaxAttributeBytes = std::size_t{1} << 20;
// A digest of a scene, as text.
inline constexpr std::size_t kMaxDigestBytes = 256;

}  // namespace tessera::validator
