// SPDX-License-Identifier: Apache-2.0
// Makes the fingerprints by which results are compared (scheduler/fingerprint.hpp). Thread-safe.
//
// Multilinear hashing (Carter and Wegman 1979): each sum is multiplied by a coefficient of its own, and the
// products are added modulo 2^128. Whoever does not know the coefficients finds other sums of the same
// fingerprint with a chance of less than 2^-60.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/film/film.hpp"
#include "server/scheduler/fingerprint.hpp"

namespace tessera::coordinator {

class Fingerprinter {
 public:
  using Secret = std::array<std::uint64_t, 2>;

  // The same secret makes the same fingerprints: it must outlive the coordinator, as they do.
  explicit Fingerprinter(const Secret& secret);

  // A number that tells secrets apart, and nothing of them.
  std::uint64_t check() const { return check_; }
  // The tile must be no larger than one of the grid.
  scheduler::Fingerprint of(const core::FilmTile& tile) const;

 private:
  struct Coefficient {
    std::uint64_t low, high;
  };
  // For the sums of all samples, then for those of the odd ones.
  std::vector<Coefficient> coefficients_;
  std::uint64_t check_ = 0;
};

}  // namespace tessera::coordinator
