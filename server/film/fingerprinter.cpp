// SPDX-License-Identifier: Apache-2.0
#include "server/film/fingerprinter.hpp"

#include <openssl/sha.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>

namespace tessera::film {
namespace {

__extension__ using Wide = unsigned __int128;

constexpr std::size_t kMaxSums = std::size_t{core::kTilePx} * core::kTilePx * 3;

using Digest = std::array<unsigned char, SHA256_DIGEST_LENGTH>;

// A pseudo-random digest for each number. EVP and SHA256() are not used, since they look up the algorithm or
// allocate memory for every digest, and starting a coordinator takes thousands.
Digest digest_of(const Fingerprinter::Secret& secret, std::size_t number) {
  const std::array<std::uint64_t, 3> key{secret[0], secret[1], number};
  Digest digest{};
  SHA256_CTX context;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
  SHA256_Init(&context);
  SHA256_Update(&context, key.data(), sizeof(key));
  SHA256_Final(digest.data(), &context);
#pragma GCC diagnostic pop
  return digest;
}

}  // namespace

Fingerprinter::Fingerprinter(const Secret& secret) : coefficients_(2 * kMaxSums) {
  static_assert(SHA256_DIGEST_LENGTH == 2 * sizeof(Coefficient));
  for (std::size_t i = 0; i < coefficients_.size(); i += 2) {
    const Digest digest = digest_of(secret, i);
    std::memcpy(&coefficients_[i], digest.data(), digest.size());
  }
  std::memcpy(&check_, digest_of(secret, coefficients_.size()).data(), sizeof(check_));
}

scheduler::Fingerprint Fingerprinter::of(const core::FilmTile& tile) const {
  assert(tile.sums.size() <= kMaxSums);
  Wide total = 0;
  std::uint64_t largest = 0;
  const auto take = [&](const std::vector<std::uint64_t>& sums, const Coefficient* coefficients) {
    for (std::size_t i = 0; i < sums.size(); ++i) {
      total += Wide{sums[i]} * coefficients[i].low + (Wide{sums[i] * coefficients[i].high} << 64);
      largest = std::max(largest, sums[i]);
    }
  };
  take(tile.sums, coefficients_.data());
  take(tile.odd_sums, coefficients_.data() + kMaxSums);
  const bool cut_off = largest == core::kFilmSaturated;
  return {static_cast<std::uint64_t>(total), static_cast<std::uint64_t>(total >> 64),
          cut_off ? std::numeric_limits<float>::infinity() : static_cast<float>(largest)};
}

}  // namespace tessera::film
