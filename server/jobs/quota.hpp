// SPDX-License-Identifier: Apache-2.0
// The limit on an owner's unfinished jobs. Thread-safe.
#pragma once

#include <string>
#include <utility>

#include "core/base/error.hpp"
#include "server/farm/state_lock.hpp"
#include "server/limits.hpp"

namespace tessera::jobs {

// RESOURCE_EXHAUSTED if the owner may not have another unfinished job.
core::Status may_open_job(const farm::StateLock& lock, const std::string& owner,
                          const server::Limits& limits);

// Reserves one of an owner's unfinished jobs while the job is checked and does not exist yet. Submissions
// in parallel so get no more jobs than submissions one after the other.
class QuotaReservation {
 public:
  // RESOURCE_EXHAUSTED if none is left, or the coordinator has not enough memory.
  static core::Result<QuotaReservation> take(farm::Farm& farm, const std::string& owner,
                                             const server::Limits& limits);
  QuotaReservation(QuotaReservation&& other) noexcept
      : farm_(std::exchange(other.farm_, nullptr)), owner_(std::move(other.owner_)) {}
  // Gives the reservation back; takes the state lock.
  ~QuotaReservation();

 private:
  QuotaReservation(farm::Farm& farm, std::string owner) : farm_(&farm), owner_(std::move(owner)) {}

  farm::Farm* farm_;
  std::string owner_;
};

}  // namespace tessera::jobs
