// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/quota.hpp"

#include <fmt/format.h>

namespace tessera::jobs {

using farm::StateLock;

core::Status may_open_job(const StateLock& lock, const std::string& owner, const server::Limits& limits) {
  const auto found = lock->open_jobs.find(owner);
  const auto open = static_cast<std::uint64_t>(found == lock->open_jobs.end() ? 0 : found->second);
  if (open < limits.open_jobs) return {};
  const std::string whose = owner.empty() ? "there are" : fmt::format("'{}' has", owner);
  return core::fail(server::over_quota(
      fmt::format("{} {} unfinished jobs already", whose, open),
      fmt::format("{} {}", limits.open_jobs, owner.empty() ? "of all together" : "of each owner"),
      "--max-open-jobs"));
}

core::Result<QuotaReservation> QuotaReservation::take(farm::Farm& farm, const std::string& owner,
                                                      const server::Limits& limits) {
  StateLock lock(farm);
  if (auto enough = lock.expect_memory(); !enough) return core::fail(enough.error());
  if (auto may = may_open_job(lock, owner, limits); !may) return core::fail(may.error());
  lock->count_open_job(owner, 1);
  return QuotaReservation(farm, owner);
}

QuotaReservation::~QuotaReservation() {
  if (farm_ != nullptr) StateLock(*farm_)->count_open_job(owner_, -1);
}

}  // namespace tessera::jobs
