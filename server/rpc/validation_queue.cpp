// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/validation_queue.hpp"

#include <chrono>
#include <utility>

namespace tessera::rpc {

namespace {

constexpr std::chrono::seconds kTryLaterAfter{1};

}  // namespace

core::Result<base::FairShare::Held> ValidationQueue::reserve(const std::string& caller) {
  if (auto place = pool_.reserve(caller)) return *std::move(place);
  const core::Error error = server::over_share(pool_.waiting_of(caller), "scenes", "wait to be validated",
                                               limits_.waiting_scenes, "--max-waiting-scenes");
  return core::fail(server::temporary(error, kTryLaterAfter));
}

void ValidationQueue::post(const std::string& caller, base::FairShare::Held place,
                           const std::string& job_id) {
  pool_.post(caller, std::move(place), [this, job_id] {
    if (!pool_.is_closed()) coordinator_.jobs().validate(job_id);
  });
}

void ValidationQueue::post_unvalidated() {
  for (const jobs::UnvalidatedJob& job : coordinator_.jobs().unvalidated()) {
    const std::string caller = base::caller_key(job.owner);
    auto place = pool_.reserve(caller);
    if (place && coordinator_.jobs().queue_validation(job.id)) post(caller, *std::move(place), job.id);
  }
}

}  // namespace tessera::rpc
