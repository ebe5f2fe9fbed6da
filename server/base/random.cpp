// SPDX-License-Identifier: Apache-2.0
#include "server/base/random.hpp"

#include <openssl/rand.h>

#include <array>
#include <bit>
#include <string_view>

namespace tessera::base {

std::uint64_t random_number() {
  std::array<unsigned char, sizeof(std::uint64_t)> bytes{};
  RAND_bytes(bytes.data(), static_cast<int>(bytes.size()));
  return std::bit_cast<std::uint64_t>(bytes);
}

std::string random_id() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::array<unsigned char, 16> bytes{};
  RAND_bytes(bytes.data(), static_cast<int>(bytes.size()));
  std::string id;
  for (const unsigned char byte : bytes) {
    id.push_back(kDigits[byte >> 4]);
    id.push_back(kDigits[byte & 15]);
  }
  return id;
}

}  // namespace tessera::base
