// SPDX-License-Identifier: Apache-2.0
// Computes the fingerprints by which results are compared (scheduler/fingerprint.hpp). Thread-safe.
//
// Multilinear hashing (Carter and Wegman 1979): each sum is multiplied by its own coefficient, and the
// products are added modulo 2^128. Without the coefficients, other sums with the same fingerprint can be
// found with a probability of less than 2^-60.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/film/film.hpp"
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
  struct Coefficient {
    std::uint64_t low, high;
  };
  // Coefficients for the sums of all samples, then for those of the odd samples.
  std::vector<Coefficient> coefficients_;
  std::uint64_t check_ = 0;
};

}  // namespace tessera::film
