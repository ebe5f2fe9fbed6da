// SPDX-License-Identifier: Apache-2.0
// Reserves one of a submitter's open jobs while the job is checked and does not exist yet. Submissions in
// parallel so get no more jobs than submissions one after the other.
#pragma once

#include <string>
#include <utility>

#include "server/coordinator/coordinator.hpp"

namespace tessera::coordinator {

class Coordinator::QuotaReservation {
 public:
  // The caller holds the state lock.
  QuotaReservation(Coordinator& coordinator, std::string submitter)
      : coordinator_(&coordinator), submitter_(std::move(submitter)) {
    ++coordinator.places_[submitter_];
  }
  QuotaReservation(QuotaReservation&& other) noexcept
      : coordinator_(std::exchange(other.coordinator_, nullptr)), submitter_(std::move(other.submitter_)) {}
  // Gives the reservation back; takes the state lock.
  ~QuotaReservation();

 private:
  Coordinator* coordinator_;
  std::string submitter_;
};

}  // namespace tessera::coordinator
