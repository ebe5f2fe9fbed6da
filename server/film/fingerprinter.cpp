// SPDX-License-Identifier: Apache-2.0
#include "server/film/fingerprinter.hpp"

#include <openssl/sha.h>
#include <xxhash.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>

namespace tessera::film {
namespace {

constexpr std::size_t kMaxSums = std::size_t{core::kTilePx} * core::kTilePx * 3;
// More than a film has.
constexpr std::size_t kMaxPlanes = 128;
constexpr float kCutOff = std::numeric_limits<float>::infinity();
// What ids of a pixel count as, so that as many as there can be are as many as a sum can hold.
constexpr float kPerId = 0x1p64F / core::kMaxIdsPerPixel;

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

// Fills a list of coefficients of even size from this number on.
template <typename Coefficient>
void fill(std::vector<Coefficient>& coefficients, const Fingerprinter::Secret& secret, std::size_t number) {
  static_assert(SHA256_DIGEST_LENGTH == 2 * sizeof(Coefficient));
  for (std::size_t i = 0; i < coefficients.size(); i += 2) {
    const Digest digest = digest_of(secret, number + i);
    std::memcpy(&coefficients[i], digest.data(), digest.size());
  }
}

}  // namespace

Fingerprinter::Fingerprinter(const Secret& secret)
    : coefficients_(2 * kMaxSums), plane_coefficients_(kMaxPlanes) {
  fill(coefficients_, secret, 0);
  const std::size_t number = coefficients_.size();
  std::memcpy(&check_, digest_of(secret, number).data(), sizeof(check_));
  std::memcpy(&id_seed_, digest_of(secret, number + 1).data(), sizeof(id_seed_));
  fill(plane_coefficients_, secret, number + 2);
  for (Coefficient& each : plane_coefficients_) each.low |= 1;
}

Fingerprinter::Wide Fingerprinter::multiply(Wide word, const Coefficient& coefficient) {
  return word * (Wide{coefficient.high} << 64 | coefficient.low);
}

scheduler::Fingerprint Fingerprinter::of(const core::FilmTile& tile) const {
  assert(tile.sums.size() <= kMaxSums);
  Wide total = 0;
  std::uint64_t largest = 0;
  const auto take = [&](const std::vector<std::uint64_t>& sums, const Coefficient* coefficients) {
    for (std::size_t i = 0; i < sums.size(); ++i) {
      total += multiply(sums[i], coefficients[i]);
      largest = std::max(largest, sums[i]);
    }
  };
  take(tile.sums, coefficients_.data());
  if (tile.range.odd_count() > 0) take(tile.odd_sums, coefficients_.data() + kMaxSums);
  float bound = largest == core::kFilmSaturated ? kCutOff : static_cast<float>(largest);
  add_planes(tile, total, bound);
  return {static_cast<std::uint64_t>(total), static_cast<std::uint64_t>(total >> 64), bound};
}

void Fingerprinter::add_planes(const core::FilmTile& tile, Wide& total, float& largest) const {
  if (tile.planes.empty()) return;
  const core::FilmLayout layout = core::film_layout(tile.layers);
  assert(tile.planes.size() == layout.planes() && tile.planes.size() <= kMaxPlanes);
  for (std::size_t i = 0; i < tile.planes.size(); ++i) {
    const core::ChannelEncoding encoding = layout.plane(i).encoding;
    if (encoding == core::ChannelEncoding::kNearest) continue;
    const Wide hash = encoding == core::ChannelEncoding::kIds
                          ? hash_of_ids(tile.planes[i], largest)
                          : hash_of_words(encoding, tile.planes[i], largest);
    total += multiply(hash, plane_coefficients_[i]);
  }
}

// Words of kSigned are numbers of 128 bits here, so that their sums do not wrap.
Fingerprinter::Wide Fingerprinter::hash_of_words(core::ChannelEncoding encoding, const core::Plane& plane,
                                                 float& largest) const {
  Wide hash = 0;
  const bool is_signed = encoding == core::ChannelEncoding::kSigned;
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const Wide word = is_signed ? static_cast<Wide>(static_cast<std::int64_t>(plane[i])) : Wide{plane[i]};
    hash += multiply(word, coefficients_[i]);
    if (is_signed) continue;
    const bool cut_off = plane[i] == core::kFilmSaturated;
    largest = std::max(largest, cut_off ? kCutOff : static_cast<float>(plane[i]));
  }
  return hash;
}

Fingerprinter::Wide Fingerprinter::hash_of_ids(const core::Plane& plane, float& largest) const {
  Wide hash = 0;
  std::size_t ids = 0;
  for (std::size_t i = 0; i + 1 < plane.size(); i += 2) {
    const XXH128_hash_t key = XXH3_128bits_withSeed(&plane[i], sizeof(plane[i]), id_seed_);
    hash += multiply(plane[i + 1], {key.low64, key.high64});
    const bool is_same_pixel = i > 0 && plane[i] >> 32 == plane[i - 2] >> 32;
    ids = is_same_pixel ? ids + 1 : 1;
    const bool may_lack_some = ids == core::kMaxIdsPerPixel;
    largest = std::max(largest, may_lack_some ? kCutOff : static_cast<float>(ids) * kPerId);
  }
  return hash;
}

}  // namespace tessera::film
