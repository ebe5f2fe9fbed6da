// SPDX-License-Identifier: Apache-2.0
// A place among the open jobs of one submitter, held while a job is being checked and does not exist yet: who
// submits many scenes at once gets no more jobs than who submits them one after the other.
#pragma once

#include <string>
#include <utility>

#include "server/coordinator/coordinator.hpp"

namespace tessera::coordinator {

class Coordinator::QuotaReservation {
 public:
  // Takes one; in a turn.
  QuotaReservation(Coordinator& coordinator, std::string submitter)
      : coordinator_(&coordinator), submitter_(std::move(submitter)) {
    ++coordinator.places_[submitter_];
  }
  QuotaReservation(QuotaReservation&& other) noexcept
      : coordinator_(std::exchange(other.coordinator_, nullptr)), submitter_(std::move(other.submitter_)) {}
  // Gives it back; takes a turn.
  ~QuotaReservation();

 private:
  Coordinator* coordinator_;
  std::string submitter_;
};

}  // namespace tessera::coordinator
