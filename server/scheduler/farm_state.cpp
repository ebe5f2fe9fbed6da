// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/farm_state.hpp"

namespace tessera::scheduler {

FarmState::FarmState(const Options& given)
    : options(given),
      last_lease_id{static_cast<std::uint64_t>(options.epoch) << kLeaseCounterBits},
      registry(options.lease_duration, options.forget_after),
      audit_waits(options.audit_patience) {}

const Job* FarmState::find(const JobId& id) const {
  const auto found = job_numbers.find(id);
  return found == job_numbers.end() ? nullptr : &jobs.at(found->second);
}

Job* FarmState::find(const JobId& id) {
  const auto found = job_numbers.find(id);
  return found == job_numbers.end() ? nullptr : &at(found->second);
}

Job& FarmState::at(JobNumber number) {
  touched.insert(number);
  return jobs.at(number);
}

}  // namespace tessera::scheduler
