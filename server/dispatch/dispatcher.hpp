// SPDX-License-Identifier: Apache-2.0
// The side of the coordinator that workers call: heartbeats, leases and results; and the passing of time.
//
// Takes and returns the messages of the protocol, but knows nothing of RPC. Starts no threads: its owner
// calls tick() regularly. Thread-safe. Errors are those of the protocol (proto/tessera/v1).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/dispatch/lease_signer.hpp"
#include "server/dispatch/result_counts.hpp"
#include "server/farm/farm.hpp"
#include "server/farm/state_lock.hpp"
#include "server/film/fingerprinter.hpp"
#include "tessera/v1/render_service.pb.h"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::dispatch {

class Dispatcher {
 public:
  Dispatcher(farm::Farm& farm, film::FilmMemory& film_memory, const film::Fingerprinter& fingerprinter,
             const LeaseSigner& signer)
      : farm_(farm), film_memory_(film_memory), fingerprinter_(fingerprinter), signer_(signer) {}

  // Answers at once, when there is a change, or before the worker's heartbeat is due.
  void synchronize(const v1::SynchronizeRequest& request, farm::SynchronizeCaller caller);
  core::Result<v1::SubmitResultResponse> submit_result(const v1::SubmitResultRequest& request,
                                                       const farm::WorkerPrincipal& caller = {});

  // A worker that called lately.
  std::optional<v1::Worker> worker(const std::string& id);
  // The workers that called lately, in the order of their ids.
  std::vector<v1::Worker> workers();
  // Those of one page whose id or name begins with the prefix.
  core::Result<v1::ListWorkersResponse> list_workers(const v1::ListWorkersRequest& request);

  const ResultCounts& result_counts() const { return result_counts_; }

  // Advances time: ends the leases of silent workers and answers calls that have waited long enough. Call it
  // about every 100 ms. Returns whether a checkpoint should be written soon: users learn that a job is
  // done or has failed after the next one, and it frees memory of films. Ends the process if an invariant is
  // broken, since a wrong image would be worse.
  bool tick();
  // Ends the waiting call of a worker if its caller has gone.
  void remove_gone(const std::string& worker);
  // Answers all waiting calls, and all later ones, with UNAVAILABLE.
  void close();

 private:
  struct Delivery;
  struct Counted;

  // Counts a rejected result.
  core::Error rejected(RejectedFor reason, core::Error error) {
    result_counts_.note(reason);
    return error;
  }
  // The part of tick() that is short.
  void advance_time();
  core::Status check_token(const v1::SubmitResultRequest& request, const farm::WorkerPrincipal& caller);
  std::vector<v1::Worker> next_workers(const std::string& after);
  std::optional<core::LayerSet> layers_of_job(const std::string& id);
  core::Result<v1::SubmitResultResponse> drop(const v1::SubmitResultRequest& request,
                                              const farm::WorkerPrincipal& caller);
  core::Error refuse(const core::Error& error);
  core::Error defer(const v1::SubmitResultRequest& request, const farm::WorkerPrincipal& caller);
  core::Result<Counted> count_result(farm::StateLock& lock, const v1::SubmitResultRequest& request,
                                     Delivery& delivery);
  core::Result<Counted> decide(farm::StateLock& lock, farm::JobRecord& record,
                               const scheduler::SubmitResult& event, Delivery& delivery) noexcept;

  farm::Farm& farm_;
  film::FilmMemory& film_memory_;
  const film::Fingerprinter& fingerprinter_;
  const LeaseSigner& signer_;
  ResultCounts result_counts_;
  scheduler::Time next_check_ TESSERA_GUARDED_BY(farm_.mutex()){};
  scheduler::CheckCursor check_cursor_ TESSERA_GUARDED_BY(farm_.mutex());
};

}  // namespace tessera::dispatch
