// SPDX-License-Identifier: Apache-2.0
// Computes the fingerprints by which results are compared (scheduler/fingerprint.hpp). Thread-safe.
//
// Multilinear hashing (Carter and Wegman 1979): each sum is multiplied by its own coefficient, and the
// products are added modulo 2^128. Without the coefficients, other sums with the same fingerprint can be
// found with a probability of less than 2^-60. The hash of each plane of layers is multiplied by a
// coefficient of the plane; in planes of ids, those of the entries are keyed hashes of pixel and id.
//
// Planes of minima (depth and indices) have no part in it: no linear function tells them apart. A pixel that
// has as many ids as it can have counts as a sum that has saturated, since others may have been left out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/film/film.hpp"
#include "core/film/layout.hpp"
#include "core/film/planes.hpp"
#include "server/scheduler/fingerprint.hpp"

namespace tessera::film {

class Fingerprinter {
 public:
  using Secret = std::array<std::uint64_t, 2>;

  // The same secret gives the same fingerprints. Fingerprints are stored, so the secret must be stored, too.
  explicit Fingerprinter(const Secret& secret);

  // A number that tells secrets apart and reveals nothing of them.
  std::uint64_t check() const { return check_; }
  // The tile must not be larger than a tile of the grid.
  scheduler::Fingerprint of(const core::FilmTile& tile) const;

 private:
  __extension__ using Wide = unsigned __int128;
  struct Coefficient {
    std::uint64_t low, high;
  };
  static Wide multiply(Wide word, const Coefficient& coefficient);
  // Each adds to `total`, and `largest` becomes at least as large as the words are.
  void add_planes(const core::FilmTile& tile, Wide& total, float& largest) const;
  Wide hash_of_words(core::ChannelEncoding encoding, const core::Plane& plane, float& largest) const;
  Wide hash_of_ids(const core::Plane& plane, float& largest) const;

  // Coefficients for the sums of all samples, then for those of the odd samples.
  std::vector<Coefficient> coefficients_;
  // Of planes; odd.
  std::vector<Coefficient> plane_coefficients_;
  std::uint64_t id_seed_ = 0;
  std::uint64_t check_ = 0;
};

}  // namespace tessera::film
